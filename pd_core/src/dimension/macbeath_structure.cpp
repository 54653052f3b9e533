#include "dimension/macbeath_structure.hpp"

#include <utility>
#include <vector>

#include "dimension/kernel_structure.hpp"
#include "dimension/macbeath_hierarchy.hpp"

namespace pd::dimension::detail {

template <int D>
Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure(const Body<D>& body, double epsilon) {
  if (epsilon / 2 < kLeastEpsilon) {
    return Error{ErrorCode::bad_value, "the macbeath backend needs epsilon >= 2e-7", "epsilon"};
  }
  // The kernel falls short of h by epsilon / 2 of it, about the sandwich's centre; the hierarchy by as much of the
  // kernel's h.
  const auto kernel = KernelStructure<D>::build(body, epsilon / 2);
  std::vector<SupportPoint<D>> points;
  for (const auto* list : {&kernel->nodes(), &kernel->loose()}) {
    for (const auto& node : *list) points.push_back({node.point, 0, node.index});
  }
  auto hierarchy = build_macbeath_hierarchy<D>(points, body.sandwich().fattening(), epsilon / 2);
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
