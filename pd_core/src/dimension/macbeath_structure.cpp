#include "dimension/macbeath_structure.hpp"

#include <string>
#include <utility>
#include <vector>

#include "dimension/kernel_structure.hpp"
#include "dimension/macbeath_hierarchy.hpp"

namespace pd::dimension::detail {

namespace {

template <int D>
std::vector<SupportPoint<D>> kernel_points(const Body<D>& body, double epsilon) {
  std::vector<SupportPoint<D>> points;
  if (body.representation() == Representation::points) {
    // Without the graph of its hull, which in R^5 takes as much memory as the hull.
    KernelBuilder<D> builder(body.sandwich().fattening(), epsilon);
    builder.add(body.points(), 0);
    for (const auto& p : builder.chosen()) points.push_back({p.point, 0, p.index});
    return points;
  }
  const auto kernel = KernelStructure<D>::build(body, epsilon);
  for (const auto& node : kernel->nodes()) points.push_back({node.point, 0, node.index});
  return points;
}

}  // namespace

template <int D>
Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure(const Body<D>& body, double epsilon) {
  // The kernel falls short of h by its share of epsilon, about the sandwich's centre; the hierarchy by the rest of the
  // kernel's h. In R^4 and R^5 regions are much dearer than points of the kernel.
  constexpr double kKernelShare = D < 4 ? 0.5 : 0.125;
  if (kKernelShare * epsilon < kLeastEpsilon) {
    return Error{ErrorCode::bad_value,
                 std::string("the macbeath backend needs epsilon >= ") + (D < 4 ? "2e-7" : "8e-7"), "epsilon"};
  }
  auto hierarchy = build_macbeath_hierarchy<D>(kernel_points(body, kKernelShare * epsilon), body.sandwich().fattening(),
                                               (1 - kKernelShare) * epsilon);
  if (!hierarchy) return hierarchy.error();
  return std::shared_ptr<const WidthStructure<D>>(std::move(hierarchy).value());
}

#define PD_INSTANTIATE(D) \
  template Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure<D>(const Body<D>&, double);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
