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

std::vector<AnySupport> kernel_points(const AnyBody& body, double epsilon) {
  std::vector<AnySupport> points;
  if (body.representation == Representation::points) {
    // Without the graph of its hull, which in R^5 takes as much memory as the hull.
    KernelBuilder builder(body.sandwich.fattening(), epsilon);
    builder.add(body.points, 0);
    for (const auto& p : builder.chosen()) points.push_back({p.point, 0, p.index});
    return points;
  }
  const auto kernel = KernelStructure::build(body, epsilon);
  for (const auto& node : kernel->nodes()) points.push_back({node.point, 0, node.index});
  return points;
}

/// A descent in R^4 and R^5 looks into hundreds of regions, each as dear as D + 1 points: so few points are scanned,
/// and no region is built for them.
constexpr std::size_t kFewPoints = 256;

class ScannedPoints final : public WidthStructure {
 public:
  explicit ScannedPoints(std::vector<AnySupport> points) : points_(std::move(points)) {}

  [[nodiscard]] AnySupport support(const AnyVector& direction, QueryCounters& counters) const override {
    const auto count = static_cast<std::int64_t>(points_.size());
    ++counters.queries;
    counters.nodes += count;
    counters.dot_products += count;
    counters.deepest = std::max(counters.deepest, count);
    const AnySupport* best = nullptr;
    double most = -std::numeric_limits<double>::infinity();
    for (const AnySupport& p : points_) {
      const double value = dot(direction.data(), p.point.data(), direction.size());
      if (best != nullptr && !(value > most)) continue;
      best = &p;
      most = value;
    }
    AnySupport r = *best;
    r.value = most;
    return r;
  }

  [[nodiscard]] StructureSize size() const override {
    StructureSize r;
    r.points = static_cast<std::int64_t>(points_.size());
    r.nodes = r.points;
    r.depth = 1;
    r.bytes = static_cast<std::int64_t>(points_.size() * sizeof(AnySupport));
    return r;
  }

 private:
  std::vector<AnySupport> points_;
};

}  // namespace

Expected<std::shared_ptr<const WidthStructure>> macbeath_structure(const AnyBody& body, double epsilon) {
  // The kernel falls short of h by its share of epsilon, about the sandwich's centre; the hierarchy by the rest of the
  // kernel's h. In R^4 and R^5 regions are much dearer than points of the kernel.
  const int d = body.dimension();
  const double kernel_share = d < 4 ? 0.5 : 0.125;
  if (kernel_share * epsilon < kLeastEpsilon) {
    return Error{ErrorCode::bad_value,
                 std::string("the macbeath backend needs epsilon >= ") + (d < 4 ? "2e-7" : "8e-7"), "epsilon"};
  }
  std::vector<AnySupport> points = kernel_points(body, kernel_share * epsilon);
  if (d <= 3 || points.size() > kFewPoints) {
    std::shared_ptr<const WidthStructure> hierarchy =
        build_macbeath_hierarchy(points, body.sandwich.fattening(), (1 - kernel_share) * epsilon);
    if (hierarchy != nullptr) return hierarchy;
  }
  return std::shared_ptr<const WidthStructure>(std::make_shared<ScannedPoints>(std::move(points)));
}

}  // namespace pd::dimension::detail
