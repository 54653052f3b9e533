#include "dimension/macbeath_structure.hpp"

#include <string>
#include <utility>
#include <vector>

#include "dimension/kernel_structure.hpp"
#include "dimension/macbeath_hierarchy.hpp"

namespace pd::dimension::detail {

template <int D>
Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure(const Body<D>& body, double epsilon) {
  // The kernel falls short of h by its share of epsilon, about the sandwich's centre; the hierarchy by the rest of the
  // kernel's h. In R^4 and R^5 regions are much dearer than points of the kernel.
  constexpr double kKernelShare = D < 4 ? 0.5 : 0.125;
  if (kKernelShare * epsilon < kLeastEpsilon) {
    return Error{ErrorCode::bad_value,
                 std::string("the macbeath backend needs epsilon >= ") + (D < 4 ? "2e-7" : "8e-7"), "epsilon"};
  }
  const auto kernel = KernelStructure<D>::build(body, kKernelShare * epsilon);
  std::vector<SupportPoint<D>> points;
  for (const auto* list : {&kernel->nodes(), &kernel->loose()}) {
    for (const auto& node : *list) points.push_back({node.point, 0, node.index});
  }
  auto hierarchy = build_macbeath_hierarchy<D>(points, body.sandwich().fattening(), (1 - kKernelShare) * epsilon);
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
