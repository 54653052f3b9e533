#include "solid/cut_parts.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "solid/cell_contents.hpp"
#include "solid/hull_reach.hpp"
#include "solid/part_corners.hpp"
#include "solid/solid_cells.hpp"

namespace pd::detail {

namespace {

/// Pieces for one bound while cells are cut, while parts are merged, and while they are measured.
constexpr std::int64_t kStepsToCut = 20'000;
constexpr std::int64_t kStepsToMerge = 10'000;
constexpr std::int64_t kStepsToMeasure = 20'000;
/// Bounds of the finished parts are within this share of the truth, unless that takes too long.
constexpr double kMeasured = 0.1;

/// Space, cut until each cell has a part or holds nothing of the solid.
class Cutting {
 public:
  Cutting(const MeshSolid& solid, const DecompositionSettings& settings)
      : solid_(solid), settings_(settings), cells_(solid) {}
  virtual ~Cutting() = default;
  Cutting(const Cutting&) = delete;
  Cutting& operator=(const Cutting&) = delete;

 protected:
  void cut() {
    // The cells that were made first are cut first, so that work that ends early leaves cells of like size.
    std::deque<SolidCell> open;
    open.push_back(cells_.whole());
    faces_ = open.back().faces;
    while (!open.empty()) {
      tell(open.size());
      SolidCell here = std::move(open.front());
      open.pop_front();
      const bool must_take = steps() >= settings_.max_steps ||
                             static_cast<std::int64_t>(parts_.size() + open.size()) + 1 >= settings_.max_parts;
      const std::optional<Side> plane = take_or_cut(here, must_take);
      if (!plane) continue;
      SolidCells::Halves halves = cells_.split(std::move(here), *plane);
      if (halves.beyond) open.push_back(*std::move(halves.beyond));
      if (halves.inside) open.push_back(*std::move(halves.inside));
    }
  }

  /// Makes a part of what a cell holds, or tells where to cut the cell.
  /// @param must_take  no cell is cut any more
  virtual std::optional<Side> take_or_cut(const SolidCell& here, bool must_take) = 0;

  /// True if no face enters the interior of the polytope, and its middle lies in the solid, exactly.
  [[nodiscard]] bool lies_in_solid(const ConvexPolytope& hull) {
    ++steps_;
    TriangleBox box{hull.vertex(0), hull.vertex(0)};
    for (int v = 0; v < hull.num_vertices(); ++v) {
      box.low = box.low.cwiseMin(hull.vertex(v));
      box.high = box.high.cwiseMax(hull.vertex(v));
    }
    std::vector<Side> walls;
    for (int f = 0; f < hull.num_facets(); ++f) {
      const auto loop = hull.facet_vertices(f);
      const auto corner = [&](std::size_t k) { return to_dyadic(hull.vertex(loop[k])); };
      const Dyadic3 normal = cross(corner(1) - corner(0), corner(2) - corner(0));
      walls.push_back(cells_.planes().add(normal, dot(normal, corner(0))));
    }
    for (std::size_t t = 0; t < faces_.size(); ++t) {
      const auto& ids = solid_.triangles()[t].vertices;
      if (!box_of(solid_.vertices(), ids).meets(box)) continue;
      ++steps_;
      const PlanePolygon& face = faces_[t];
      const bool on_wall =
          std::any_of(walls.begin(), walls.end(), [&](Side wall) { return wall.plane() == face.plane.plane(); });
      if (!on_wall && part_inside(cells_.planes(), face, walls)) return false;
    }
    return cells_.holds(hull.centre() / scale());
  }

  [[nodiscard]] double scale() const { return std::ldexp(1.0, cells_.exponent()); }
  [[nodiscard]] std::int64_t steps() const { return steps_ + cells_.polygons(); }
  void tell(std::size_t open) const {
    if (!settings_.watch) return;
    settings_.watch({static_cast<std::int64_t>(parts_.size()), static_cast<std::int64_t>(open), steps()});
  }

  const MeshSolid& solid_;
  const DecompositionSettings& settings_;
  SolidCells cells_;
  std::vector<PlanePolygon> faces_;  ///< of the solid, in the order of its triangles
  std::vector<SolidPart> parts_;
  std::int64_t steps_ = 0;
};

class OuterParts : public Cutting {
 public:
  OuterParts(const MeshSolid& solid, const DecompositionSettings& settings) : Cutting(solid, settings), reach_(solid) {}

  CutParts run() {
    cut();
    parts_ = merged(std::move(parts_), {.gap = settings_.error,
                                        .error_of = [&](const ConvexPolytope& hull) { return error_of(hull); },
                                        .goes_on = [&] { return steps() < settings_.max_steps; },
                                        .spend = [&](std::int64_t steps) { steps_ += steps; }});
    for (SolidPart& part : parts_) {
      if (part.measured || part.error == 0) continue;
      tell(0);
      part.error = std::min(part.error, reach(part.polytope, {0, kMeasured, kStepsToMeasure}).upper);
    }
    return {std::move(parts_), steps()};
  }

 private:
  ReachBracket reach(const ConvexPolytope& polytope, const ReachGoal& goal) {
    const ReachBracket found = reach_.beyond(polytope, goal);
    steps_ += found.steps;
    return found;
  }
  std::optional<double> error_of(const ConvexPolytope& hull) {
    tell(0);
    const double upper = reach(hull, {settings_.error, 0, kStepsToMerge}).upper;
    if (upper > settings_.error) return std::nullopt;
    // A bound this small may be all that pieces can tell of a hull that lies in the solid.
    if (upper <= kConvex * scale() && lies_in_solid(hull)) return 0.0;
    return upper;
  }

  std::optional<Side> take_or_cut(const SolidCell& here, bool must_take) override {
    if (here.faces.empty()) {
      if (!cells_.is_solid(here).value_or(true)) return std::nullopt;
      PartCorners::Outer outer = PartCorners(cells_.planes(), here.cell, scale()).outer();
      parts_.push_back({std::move(outer.polytope), outer.reach, true});
      return std::nullopt;
    }
    const CellContents contents(cells_, here);
    std::vector<Vec3> points = contents.points();
    for (Vec3& x : points) x *= scale();
    const auto hull = ConvexPolytope::from_points(points);
    const bool convex = contents.largest_rise() <= kConvex && is_convex(here);
    ReachBracket found;
    std::optional<PartCorners::Outer> outer;
    if (!convex) {
      // A flat hull has no bound: that of its corners within their rounding has.
      if (!hull || hull->affine_dimension() < 3) outer = outer_of(contents);
      found = reach(outer ? outer->polytope : *hull, {settings_.error * (1 - 0x1p-30), 0, kStepsToCut});
      if (found.upper > settings_.error && !must_take) {
        if (const auto plane = contents.best_cut(cells_.planes(), found.worst / scale(), steps_)) return plane;
      }
    }
    if (!outer) outer = outer_of(contents);
    parts_.push_back({std::move(outer->polytope), found.upper + outer->reach, convex});
    return std::nullopt;
  }

  [[nodiscard]] PartCorners::Outer outer_of(const CellContents& contents) {
    PartCorners corners(cells_.planes(), scale());
    contents.add_to(corners);
    return corners.outer();
  }

  /// No corner of a piece lies above the plane of another, exactly.
  [[nodiscard]] bool is_convex(const SolidCell& here) const {
    // Many pieces take the square of their number; a bound of the distance takes less.
    constexpr std::size_t kMostPieces = 300;
    if (here.faces.size() > kMostPieces) return false;
    return std::all_of(here.faces.begin(), here.faces.end(), [&](const PlanePolygon& face) {
      return std::all_of(here.faces.begin(), here.faces.end(), [&](const PlanePolygon& other) {
        if (other.plane.plane() == face.plane.plane()) return other.plane == face.plane;
        PlanePolygon below;
        return detail::cut(cells_.planes(), other, face.plane, below, nullptr) == Cut::inside;
      });
    });
  }

  /// A rise of this much, in lengths of the planes, may be rounding.
  static constexpr double kConvex = 0x1p-28;

  HullReach reach_;
};

class InnerParts : public Cutting {
 public:
  InnerParts(const MeshSolid& solid, const DecompositionSettings& settings)
      : Cutting(solid, settings), point_(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()})) {}

  CutParts run() {
    cut();
    if (parts_.empty()) return {};
    double largest = 0;
    for (const SolidPart& part : parts_) largest = std::max(largest, part.error);
    for (const std::vector<Vec3>& points : without_part_) largest = std::max(largest, nearest_part(points));
    parts_ = merged(std::move(parts_), {.gap = 0x1p-40 * scale(),
                                        .error_of = [&](const ConvexPolytope& hull) { return error_of(hull); },
                                        .goes_on = [&] { return steps() < settings_.max_steps; },
                                        .spend = [&](std::int64_t steps) { steps_ += steps; }});
    // A merged part holds the parts that it replaces, so that no point of the solid is farther from it than from them.
    for (SolidPart& part : parts_) part.error = largest;
    return {std::move(parts_), steps()};
  }

 private:
  std::optional<Side> take_or_cut(const SolidCell& here, bool must_take) override {
    if (here.faces.empty() && !cells_.is_solid(here).value_or(true)) return std::nullopt;
    const CellContents contents(cells_, here);
    std::vector<Vec3> points = contents.points();
    for (Vec3& x : points) x *= scale();
    std::optional<ConvexCell> below = here.cell;
    if (here.faces.empty() && !cells_.is_solid(here)) below.reset();
    std::vector<Side> done;
    for (const PlanePolygon& face : here.faces) {
      if (!below) break;
      if (std::find(done.begin(), done.end(), face.plane) != done.end()) continue;
      done.push_back(face.plane);
      steps_ += static_cast<std::int64_t>(below->facets().size());
      below = below->inside(cells_.planes(), face.plane);
    }
    Vec3 worst = points.front();
    std::optional<SolidPart> part;
    if (below) part = part_of(*below, points, worst);
    if (!must_take && !(part && part->error <= settings_.error)) {
      if (const auto plane = contents.best_cut(cells_.planes(), worst / scale(), steps_)) return plane;
    }
    if (part) {
      parts_.push_back(*std::move(part));
    } else {
      without_part_.push_back(std::move(points));
    }
    return std::nullopt;
  }

  /// The part that a convex cell is, with its distance from the points.
  std::optional<SolidPart> part_of(const ConvexCell& cell, const std::vector<Vec3>& points, Vec3& worst) {
    const PartCorners corners(cells_.planes(), cell, scale());
    std::optional<ConvexPolytope> polytope;
    if (corners.exact()) polytope = corners.polytope();
    if (!polytope) polytope = corners.inner(cell);
    if (!polytope) return std::nullopt;
    const double error = distance(*polytope, points, worst);
    return SolidPart{*std::move(polytope), error, true};
  }

  /// At least the largest distance of the points' hull from a polytope. A distance from a convex body is a convex
  /// function, so that a vertex of the hull has the largest.
  double distance(const ConvexPolytope& polytope, const std::vector<Vec3>& points, Vec3& worst) {
    const auto hull = ConvexPolytope::from_points(points);
    if (!hull) return HUGE_VAL;
    const ConvexShape body(polytope);
    double most = 0;
    for (int v = 0; v < hull->num_vertices(); ++v) {
      const Pose at = *Pose::from_matrix(Mat3::Identity(), hull->vertex(v));
      const PenetrationDepth found = penetration_depth({&body, Pose()}, {&point_, at}, scratch_, {});
      ++steps_;
      if (found.contact != ContactClass::separated || found.distance_upper <= most) continue;
      most = found.distance_upper;
      worst = hull->vertex(v);
    }
    // The points are rounded.
    return most > 0 ? most + 0x1p-46 * scale() : 0;
  }

  /// At least the distance of a cell's contents from the part that is nearest.
  double nearest_part(const std::vector<Vec3>& points) {
    double least = HUGE_VAL;
    Vec3 worst;
    for (const SolidPart& part : parts_) least = std::min(least, distance(part.polytope, points, worst));
    return least;
  }

  std::optional<double> error_of(const ConvexPolytope& hull) {
    tell(0);
    if (!lies_in_solid(hull)) return std::nullopt;
    return 0.0;
  }

  ConvexShape point_;
  Scratch scratch_;
  std::vector<std::vector<Vec3>> without_part_;  ///< contents of cells that hold no part
};

}  // namespace

CutParts outer_parts(const MeshSolid& solid, const DecompositionSettings& settings) {
  return OuterParts(solid, settings).run();
}

CutParts inner_parts(const MeshSolid& solid, const DecompositionSettings& settings) {
  return InnerParts(solid, settings).run();
}

}  // namespace pd::detail
