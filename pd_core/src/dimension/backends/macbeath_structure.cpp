#include "dimension/backends/macbeath_structure.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dimension/backends/kernel_structure.hpp"
#include "dimension/backends/macbeath_hierarchy.hpp"

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

/// A descent in R^4 and R^5 looks into hundreds of regions, each as dear as D + 1 points: so few points are scanned,
/// and no region is built for them.
constexpr std::size_t kFewPoints = 256;

template <int D>
class ScannedPoints final : public WidthStructure<D> {
 public:
  explicit ScannedPoints(std::vector<SupportPoint<D>> points) : points_(std::move(points)) {}

  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const override {
    const auto count = static_cast<std::int64_t>(points_.size());
    ++counters.queries;
    counters.nodes += count;
    counters.dot_products += count;
    counters.deepest = std::max(counters.deepest, count);
    const SupportPoint<D>* best = nullptr;
    double most = -std::numeric_limits<double>::infinity();
    for (const SupportPoint<D>& p : points_) {
      const double value = direction.dot(p.point);
      if (best != nullptr && !(value > most)) continue;
      best = &p;
      most = value;
    }
    SupportPoint<D> r = *best;
    r.value = most;
    return r;
  }

  [[nodiscard]] StructureSize size() const override {
    StructureSize r;
    r.points = static_cast<std::int64_t>(points_.size());
    r.nodes = r.points;
    r.depth = 1;
    r.bytes = static_cast<std::int64_t>(points_.size() * sizeof(SupportPoint<D>));
    return r;
  }

 private:
  std::vector<SupportPoint<D>> points_;
};

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
  std::vector<SupportPoint<D>> points = kernel_points(body, kKernelShare * epsilon);
  if (D <= 3 || points.size() > kFewPoints) {
    std::shared_ptr<const WidthStructure<D>> hierarchy =
        build_macbeath_hierarchy<D>(points, body.sandwich().fattening(), (1 - kKernelShare) * epsilon);
    if (hierarchy != nullptr) return hierarchy;
  }
  return std::shared_ptr<const WidthStructure<D>>(std::make_shared<ScannedPoints<D>>(std::move(points)));
}

#define PD_INSTANTIATE(D) \
  template Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure<D>(const Body<D>&, double);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
