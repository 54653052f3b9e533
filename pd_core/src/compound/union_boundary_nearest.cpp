#include <algorithm>
#include <cmath>
#include <utility>

#include "compound/cover_cells.hpp"
#include "compound/nearest_first.hpp"
#include "compound/union_boundary.hpp"
#include "numeric/quotient.hpp"
#include "numeric/root_sum.hpp"

namespace pd::detail {

namespace {

SquaredRatio squared_length(const PlaneSet::ExactPoint& point) {
  return {dot(point.numerator, point.numerator), point.denominator * point.denominator};
}

Vec3 rounded(const PlaneSet::ExactPoint& point) {
  const auto coordinate = [&](const Dyadic& x) { return quotient(x, point.denominator); };
  return {coordinate(point.numerator.x), coordinate(point.numerator.y), coordinate(point.numerator.z)};
}

}  // namespace

/// Cubes come in the order of their distance. Of each, the parts of facets in it wait in the order of their distance.
/// The first is clipped; where a P_k holds its nearest point, that P_k is subtracted and what is left waits again; else
/// its nearest point is a boundary point, the nearest so far.
class UnionBoundary::NearestSearch {
 public:
  NearestSearch(UnionBoundary& boundary, double known_lower)
      : boundary_(boundary), known_lower_(known_lower), scale_(boundary.differences_.extent()) {}

  /// Each subtraction takes one P_k off a polygon's list for good, so that this ends.
  std::optional<Nearest> run(double reach, UnionMemory* memory) {
    // A boundary point lies within `reach`: nothing farther is looked at.
    best_key_ = reach * (1 + 0x1p-40);
    CoverCells cells(boundary_.differences_, reach, known_lower_, memory);
    while (const auto cell = cells.next(best_key_)) {
      enter(*cell);
      while (!queue_.empty()) {
        const double key = queue_.least_key();
        if (key >= best_key_) break;
        Cell top = queue_.pop();
        if (top.where.polygon.corners.empty()) {
          make(std::move(top), *cell);
          continue;
        }
        ++boundary_.counts_.polygons;
        if (!boundary_.contained_in_recent(top.where.polygon)) visit(key, std::move(top));
      }
    }
    boundary_.counts_.cells += cells.num_cells();
    if (boundary_.differences_.limit_exceeded() || !best_) return std::nullopt;
    best_->lower = std::max(known_lower_, best_->lower);
    return std::move(best_);
  }

 private:
  /// Lets the facets' parts in the closed cube wait, unmade. A boundary point of the union lies in the part of a facet
  /// of one of the cubes that hold it, and any P_k that covers it meets that cube.
  void enter(const CoverCell& cell) {
    queue_.clear();
    walls_.clear();
    among_.clear();
    for (const std::int32_t k : *cell.pieces) {
      if (!boundary_.differences_.roughly(static_cast<std::size_t>(k)).flat) among_.push_back(k);
    }
    const std::vector<std::int32_t> owners = among_;
    for (const std::int32_t which : owners) {
      const auto k = static_cast<std::size_t>(which);
      const PartDifference& piece = boundary_.differences_.pieces()[k];
      for (std::size_t f = 0; f < piece.planes.size(); ++f) {
        // Most P_k of a cube end elsewhere: their facets, in doubles, do not cross it.
        if (!crosses(piece.planes[f], cell) || !near(*piece.built, f, cell)) continue;
        // Of most that do, near the answer, nothing there is nearer than the best point so far.
        const double key = distance_within(piece.planes[f], cell, scale_);
        if (key >= best_key_ || !clip_roughly(k, f, cell) || covered_roughly(k)) continue;
        queue_.push(std::max(known_lower_, key), {{k, f, {}, Vec3::Zero()}, {}});
      }
    }
  }

  /// Makes the part of a facet that lies in the cube, exactly.
  void make(Cell cell, const CoverCell& cube) {
    PartDifferences& differences = boundary_.differences_;
    if (walls_.empty()) {
      for (int axis = 0; axis < 3; ++axis) {
        walls_.push_back(differences.across_axis(axis, 1, cube.centre[axis] + cube.half));
        walls_.push_back(differences.across_axis(axis, -1, cube.centre[axis] - cube.half));
      }
    }
    auto part = part_inside(boundary_.planes_, differences.polygon(cell.where.piece, cell.where.facet), walls_);
    if (!part) return;
    cell.where.polygon = *std::move(part);
    cell.clipped = boundary_.own(cell.where.piece);
    add(std::move(cell));
  }

  /// Whether the box of a facet meets the cube; false is certain.
  [[nodiscard]] bool near(const MinkowskiDifference& built, std::size_t f, const CoverCell& cell) const {
    const MinkowskiDifference::Facet& facet = built.facets[f];
    const double scale = boundary_.differences_.scale();
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
    for (std::int32_t i = facet.first; i < facet.first + facet.count; ++i) {
      const std::int32_t corner = built.corners[static_cast<std::size_t>(i)];
      const Vec3 x = built.vertices[static_cast<std::size_t>(corner)].position * scale;
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const double reach = cell.half + 0x1p-46 * scale_;
    return (low - cell.centre).maxCoeff() <= reach && (cell.centre - high).maxCoeff() <= reach;
  }

  [[nodiscard]] bool crosses(const RoughPlane& plane, const CoverCell& cell) const {
    const double height = plane.normal.dot(cell.centre) - plane.offset;
    return !(std::abs(height) > cell.half * plane.normal.lpNorm<1>() + plane.slack + 0x1p-48 * scale_);
  }

  /// Fills `part_` with the corners of the part of a facet in the cube, in doubles. The cube is taken a little larger
  /// than it is, by more than the doubles may be wrong, so that no point is lost. Returns false if the part is empty.
  bool clip_roughly(std::size_t k, std::size_t f, const CoverCell& cell) {
    const double half = cell.half + 0x1p-43 * scale_;
    boundary_.rough_corners(k, f, part_);
    for (int wall = 0; wall < 6 && !part_.empty(); ++wall) {
      const int axis = wall / 2;
      const double sign = wall % 2 == 0 ? 1 : -1;
      const auto height = [&](const Vec3& x) { return sign * (x[axis] - cell.centre[axis]) - half; };
      clipped_.clear();
      for (std::size_t i = 0; i < part_.size(); ++i) {
        const Vec3 &from = part_[i], &to = part_[(i + 1) % part_.size()];
        const double here = height(from), there = height(to);
        if (here <= 0) clipped_.push_back(from);
        if ((here <= 0) != (there <= 0)) clipped_.push_back(from + (to - from) * (here / (here - there)));
      }
      std::swap(part_, clipped_);
    }
    return !part_.empty();
  }

  /// True if another P_k holds the part of a facet in `part_` in its interior, for certain.
  bool covered_roughly(std::size_t own) {
    const double rounding = 0x1p-42 * scale_;
    const auto found = std::find_if(among_.begin(), among_.end(), [&](std::int32_t k) {
      return static_cast<std::size_t>(k) != own && boundary_.surely_holds(static_cast<std::size_t>(k), part_, rounding);
    });
    if (found == among_.end()) return false;
    // What covers one facet covers its neighbours.
    std::rotate(among_.begin(), found, found + 1);
    return true;
  }

  /// A polygon that may hold a nearer point than the best so far waits.
  void add(Cell cell) {
    PlanePolygon& polygon = cell.where.polygon;
    double farthest = 0;
    for (const Vec3& x : polygon.corners) farthest = std::max(farthest, x.squaredNorm());
    if (std::sqrt(farthest) < known_lower_ - 4 * polygon.error - 0x1p-48 * scale_) return;
    cell.where.x = nearest_point(boundary_.planes_, polygon);
    const double distance = cell.where.x.norm();
    const double key = std::max(known_lower_, distance - 4 * polygon.error - 0x1p-50 * scale_);
    if (key >= best_key_ || boundary_.contained_in_recent(polygon)) return;
    queue_.push(key, std::move(cell));
  }

  /// @param key  no point of the polygon is nearer
  void visit(double key, Cell cell) {
    // Ties are decided exactly, so that the lower bound is the depth itself.
    std::optional<ExactNearestPoint> exact;
    if (best_) {
      exact = exact_nearest_point(boundary_.planes_, cell.where.polygon);
      if (compare(squared_length(exact->point), best_squared_) >= 0) return;
    }
    const double tolerance = 8 * cell.where.polygon.error + 0x1p-44 * scale_;
    const std::ptrdiff_t k = boundary_.covering(cell.where.x, cell.clipped, tolerance, among_);
    if (k >= 0) {
      subtract(key, std::move(cell), static_cast<std::size_t>(k));
      return;
    }
    if (!exact) exact = exact_nearest_point(boundary_.planes_, cell.where.polygon);
    const Vec3 x = rounded(exact->point);
    if ((x - cell.where.x).cwiseAbs().maxCoeff() > tolerance / 4) {
      // A flat crossing misled the doubles: asked again at the right point.
      cell.where.x = x;
      queue_.push(std::max(key, x.norm() * (1 - 0x1p-48)), std::move(cell));
      return;
    }
    accept(std::move(cell), *exact, x);
  }

  /// Puts back what P_k leaves of the polygon.
  void subtract(double key, Cell cell, std::size_t k) {
    boundary_.mark_recent(k);
    mark(cell.clipped, k);
    if (!boundary_.subtract(cell.where.polygon, cell.where.piece, k, false)) {
      queue_.push(key, std::move(cell));
      return;
    }
    std::vector<PlanePolygon> rest = std::move(boundary_.rest_);
    for (PlanePolygon& part : rest) {
      add({{cell.where.piece, cell.where.facet, std::move(part), Vec3::Zero()}, cell.clipped});
    }
  }

  /// An uncovered point, nearer than the best so far.
  void accept(Cell cell, const ExactNearestPoint& exact, const Vec3& x) {
    best_squared_ = squared_length(exact.point);
    Nearest found;
    found.where = std::move(cell.where);
    found.where.x = x;
    found.projection = exact.projection;
    found.lower = RootSum(Dyadic(0.0), 1, best_squared_.numerator, best_squared_.denominator).round_down();
    best_key_ = found.lower;
    best_ = std::move(found);
  }

  UnionBoundary& boundary_;
  const double known_lower_;
  const double scale_;
  NearestFirst<Cell> queue_;         ///< no point of an item's polygon is nearer than its key
  std::vector<std::int32_t> among_;  ///< the P_k that meet the cube
  std::vector<Side> walls_;          ///< of the cube, once a facet is cut
  std::vector<Vec3> part_, clipped_;
  std::optional<Nearest> best_;
  SquaredRatio best_squared_;
  double best_key_ = HUGE_VAL;  ///< distance of the best point, at most this
};

std::optional<UnionBoundary::Nearest> UnionBoundary::nearest(double known_lower, double reach, UnionMemory* memory) {
  return NearestSearch(*this, known_lower).run(reach, memory);
}

}  // namespace pd::detail
