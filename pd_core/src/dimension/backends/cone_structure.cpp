#include "dimension/backends/cone_structure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "dimension/backends/kernel_structure.hpp"
#include "dimension/halfspace_body.hpp"

namespace pd::dimension::detail {

namespace {

/// Room for what rounding leaves of the invariants of `RadialHull`, in a frame where the body is about a unit ball.
constexpr double kRoom = 1e-9;

/// The kernel's epsilon for lists of about a hundred points: facets by measurement on spheres, about
/// {3, 9, 34, 150} epsilon^(-(D - 1) / 2).
double coarse_epsilon(std::size_t n, int dimension) {
  constexpr std::array<double, 6> kFacets = {0, 0, 3, 9, 34, 150};
  const double wanted = static_cast<double>(n) / 100;
  return std::clamp(std::pow(kFacets[dimension] / wanted, 2.0 / (dimension - 1)), 1e-5, 0.3);
}

class ConeStructure : public WidthStructure {
 public:
  explicit ConeStructure(const AnyBody& body);

  [[nodiscard]] AnySupport support(const AnyVector& direction, QueryCounters& counters) const override;
  [[nodiscard]] StructureSize size() const override;

 private:
  struct Cone {
    std::array<std::int32_t, kMaxDimension> vertex;     ///< nodes of the graph
    std::array<std::int32_t, kMaxDimension> neighbour;  ///< cones
    std::int32_t first;                                 ///< of its points
    double gauge;
  };
  void make_cones(const RadialHull& hull, const KernelBuilder& builder);
  void fill_cones(const Points& points, const RadialHull& hull, const AnyMap& to_unit);
  void scan(const Cone& cone, const Cone& next, const AnyVector& direction, AnySupport& best,
            QueryCounters& counters) const;

  AnyMap from_unit_;
  std::shared_ptr<const KernelStructure> graph_;
  std::vector<Cone> cones_;            ///< and one more, for the end of the last list
  std::vector<std::int32_t> cone_of_;  ///< facet of the hull -> cone
  std::vector<std::int32_t> cone_at_;  ///< graph node -> one of its cones
  std::vector<AnyVector> points_;
  std::vector<std::int64_t> indices_;
  double largest_gauge_ = 1;
};

ConeStructure::ConeStructure(const AnyBody& body) {
  KernelBuilder builder(body.sandwich.fattening(), coarse_epsilon(body.points.size(), body.dimension()));
  builder.add(body.points, 0);
  from_unit_ = builder.to_unit().inverse();
  graph_ = KernelStructure::of_kernel(builder);
  make_cones(builder.hull(), builder);
  fill_cones(body.points, builder.hull(), builder.to_unit());
}

void ConeStructure::make_cones(const RadialHull& hull, const KernelBuilder& builder) {
  // Nodes know their points' indices; vertices of the hull know their kernel points.
  std::vector<std::pair<std::int64_t, std::int32_t>> by_index;
  for (std::size_t i = 0; i < graph_->nodes().size(); ++i) {
    by_index.push_back({graph_->nodes()[i].index, static_cast<std::int32_t>(i)});
  }
  std::sort(by_index.begin(), by_index.end());
  const auto node_of = [&](std::int32_t v) {
    const std::int64_t index = builder.kernel()[builder.kernel_of_vertex(v)].index;
    return std::lower_bound(by_index.begin(), by_index.end(), std::pair{index, std::int32_t{0}})->second;
  };
  cone_of_.assign(hull.facets().size(), -1);
  cone_at_.assign(graph_->nodes().size(), 0);
  std::int32_t count = 0;
  for (std::size_t f = 0; f < hull.facets().size(); ++f) {
    if (hull.facets()[f].successor < 0) cone_of_[f] = count++;
  }
  const int d = hull.dimension();
  for (const RadialHull::Facet& facet : hull.facets()) {
    if (facet.successor >= 0) continue;
    Cone cone{};
    for (int k = 0; k < d; ++k) {
      cone.vertex[k] = node_of(facet.vertex[k]);
      cone.neighbour[k] = cone_of_[facet.neighbour[k]];
      cone_at_[cone.vertex[k]] = static_cast<std::int32_t>(cones_.size());
    }
    cones_.push_back(cone);
  }
  cones_.push_back({});
}

void ConeStructure::fill_cones(const Points& points, const RadialHull& hull, const AnyMap& to_unit) {
  const double near = hull.inner_radius() * (1 - kRoom);
  std::vector<std::int32_t> cone_of_point(points.size(), -1);
  DirectionCells cells(hull.dimension(), 4 * static_cast<double>(cones_.size()));
  std::vector<std::int32_t> hints(static_cast<std::size_t>(cells.size()), 0);
  const AnyVector centre = from_unit_.translation;
  std::int64_t visited = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const AnyVector unit = in_frame(to_unit.linear, centre, points.data(i));
    if (unit.squaredNorm() <= near * near) continue;
    std::int32_t& hint = hints[static_cast<std::size_t>(cells.cell(unit))];
    hint = hull.locate(unit, hint, visited);
    const double gauge = hull.gauge(hint, unit);
    if (gauge <= 1 - kRoom) continue;
    Cone& cone = cones_[cone_of_[hint]];
    cone.gauge = std::max(cone.gauge, gauge + kRoom);
    ++cone.first;  // a count, at first
    cone_of_point[i] = cone_of_[hint];
  }
  std::int32_t total = 0;
  for (Cone& cone : cones_) {
    const std::int32_t count = cone.first;
    cone.first = total;
    total += count;
    largest_gauge_ = std::max(largest_gauge_, cone.gauge);
  }
  points_.resize(total);
  indices_.resize(total);
  std::vector<std::int32_t> filled(cones_.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t c = cone_of_point[i];
    if (c < 0) continue;
    const std::int32_t to = cones_[c].first + filled[c]++;
    points_[to] = points[i];
    indices_[to] = static_cast<std::int64_t>(i);
  }
}

void ConeStructure::scan(const Cone& cone, const Cone& next, const AnyVector& direction, AnySupport& best,
                         QueryCounters& counters) const {
  counters.dot_products += next.first - cone.first;
  with_dimension(direction.size(), [&](auto d) {
    for (std::int32_t i = cone.first; i < next.first; ++i) {
      const double value = dot(direction.data(), points_[i].data(), d);
      if (value > best.value || (value == best.value && indices_[i] < best.index)) {
        best = {points_[i], value, indices_[i]};
      }
    }
  });
}

AnySupport ConeStructure::support(const AnyVector& direction, QueryCounters& counters) const {
  ++counters.queries;
  const auto d = direction.size();
  const AnyVector unit = from_unit_.pull_back(direction);
  const std::int32_t top_node = graph_->extreme_node(unit, counters);
  const auto& node = graph_->nodes()[top_node];
  AnySupport best{node.point, dot(direction.data(), node.point.data(), d), node.index};
  // Heights are compared in the frame, where the apex is the origin; a height above it of the best point, from below.
  const double apex = dot(direction.data(), from_unit_.translation.data(), d);
  const double size = direction.norm() * from_unit_.translation.norm() + unit.norm();
  const auto bar = [&] { return best.value - apex - kRoom * 1e-3 * size; };
  std::vector<std::uint64_t> seen(cones_.size() / 64 + 1, 0);
  std::vector<std::int32_t> open;
  const auto visit = [&](std::int32_t c) {
    std::uint64_t& word = seen[static_cast<std::size_t>(c) / 64];
    const std::uint64_t bit = std::uint64_t{1} << (c % 64);
    if ((word & bit) != 0) return;
    word |= bit;
    open.push_back(c);
  };
  visit(cone_at_[top_node]);
  std::int64_t visited = 0;
  for (std::size_t next = 0; next < open.size(); ++next) {
    const Cone& cone = cones_[open[next]];
    const double top = with_dimension(d, [&](auto n) {
      double most = -std::numeric_limits<double>::infinity();
      for (int k = 0; k < n; ++k) {
        most = std::max(most, dot(unit.data(), graph_->nodes()[cone.vertex[k]].unit.data(), n));
      }
      return most;
    });
    counters.dot_products += d;
    ++visited;
    // Vertices above the bar over the largest gauge are connected in the hull's graph, so their cones are.
    if (top * largest_gauge_ < bar()) continue;
    if (top * cone.gauge >= bar()) scan(cone, (&cone)[1], direction, best, counters);
    for (int k = 0; k < d; ++k) visit(cone.neighbour[k]);
  }
  counters.nodes += visited;
  counters.deepest = std::max(counters.deepest, visited);
  return best;
}

StructureSize ConeStructure::size() const {
  StructureSize r;
  r.points = static_cast<std::int64_t>(points_.size());
  r.nodes = static_cast<std::int64_t>(cones_.size()) - 1;
  r.max_out_degree = from_unit_.translation.size();
  r.links = r.nodes * r.max_out_degree;
  r.depth = 1;
  r.bytes =
      graph_->size().bytes + static_cast<std::int64_t>(points_.size() * (sizeof(AnyVector) + sizeof(std::int64_t)) +
                                                       cones_.size() * sizeof(Cone));
  return r;
}

/// A linear program a query, in the frame of the body's sandwich.
class ProgramStructure : public WidthStructure {
 public:
  explicit ProgramStructure(const AnyBody& body) : body_(body) {}
  [[nodiscard]] AnySupport support(const AnyVector& direction, QueryCounters& counters) const override {
    ++counters.queries;
    counters.dot_products += body_.size();
    return body_.support(direction);
  }
  [[nodiscard]] StructureSize size() const override {
    StructureSize r;
    r.points = r.nodes = body_.size();
    return r;
  }

 private:
  AnyBody body_;
};

}  // namespace

std::shared_ptr<const WidthStructure> exact_structure(const AnyBody& body) {
  if (body.representation == Representation::halfspaces) return std::make_shared<ProgramStructure>(body);
  return std::make_shared<ConeStructure>(body);
}

}  // namespace pd::dimension::detail
