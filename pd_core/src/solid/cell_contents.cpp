#include "solid/cell_contents.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "shape/support/polytope_support.hpp"
#include "solid/part_merging.hpp"

namespace pd::detail {

namespace {

/// Faces whose planes are tried.
constexpr std::size_t kMostFacePlanes = 12;
/// Polygons by which a plane is judged: more of them are sampled.
constexpr std::size_t kMostJudged = 400;
/// A corner this near to a plane lies on both sides.
constexpr double kOnPlane = 0x1p-40;

double area_of(const PlanePolygon& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < polygon.corners.size(); ++k) {
    sum += (polygon.corners[k] - polygon.corners[0]).cross(polygon.corners[k + 1] - polygon.corners[0]);
  }
  return 0.5 * sum.norm();
}

double hull_volume(const std::vector<Vec3>& points) {
  if (points.size() < 4) return 0;
  const auto hull = ConvexPolytope::from_points(points);
  return hull && hull->affine_dimension() == 3 ? volume_of(*hull) : 0;
}

/// The largest height of the hull above a plane, up to rounding.
double rise_of(const ConvexPolytope& hull, const PlaneSet& planes, Side plane) {
  return planes.height(plane, hull.vertex(support_vertex(hull, planes.normal(plane), -1)));
}

}  // namespace

CellContents::CellContents(const SolidCells& cells, const SolidCell& here) : cells_(cells), here_(here) {
  for (const PlanePolygon& polygon : here.faces) polygons_.push_back(&polygon);
  for (const PlanePolygon& polygon : here.on_walls) {
    const bool shows_back = std::any_of(here.cell.facets().begin(), here.cell.facets().end(),
                                        [&](const PlanePolygon& wall) { return wall.plane == polygon.plane; });
    if (shows_back) polygons_.push_back(&polygon);
  }
  for (const PlanePolygon* polygon : polygons_) {
    points_.insert(points_.end(), polygon->corners.begin(), polygon->corners.end());
  }
  for (const PlanePolygon& facet : here.cell.facets()) {
    const std::size_t n = facet.sides.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (!cells.may_be_solid_at(here, facet.corners[i])) continue;
      own_corners_.push_back({facet.plane, facet.sides[i], facet.sides[(i + 1) % n]});
      own_points_.push_back(facet.corners[i]);
    }
  }
  points_.insert(points_.end(), own_points_.begin(), own_points_.end());
}

void CellContents::add_to(PartCorners& corners) const {
  for (const PlanePolygon* polygon : polygons_) corners.add(*polygon);
  for (const PlaneMeet& meet : own_corners_) corners.add(meet);
}

double CellContents::largest_rise() const {
  const auto hull = ConvexPolytope::from_points(points_);
  if (!hull) return HUGE_VAL;
  double most = 0;
  for (const PlanePolygon& face : here_.faces) most = std::max(most, rise_of(*hull, cells_.planes(), face.plane));
  return most;
}

/// Points of the contents on the two sides of a plane.
struct CellContents::Sides {
  std::vector<Vec3> below, above;
  std::size_t parted = 0;  ///< number of pieces of faces that the plane cuts
};

CellContents::Sides CellContents::sides_of(const PlaneSet& planes, Side plane) const {
  Sides sides;
  std::vector<double> heights;
  const auto add = [&](const PlanePolygon& polygon) {
    const auto put = [&](std::vector<Vec3>& list) {
      list.insert(list.end(), polygon.corners.begin(), polygon.corners.end());
    };
    // A face in the plane bounds what lies below the face.
    if (polygon.plane.plane() == plane.plane()) return put(polygon.plane == plane ? sides.below : sides.above);
    heights.clear();
    for (const Vec3& x : polygon.corners) heights.push_back(planes.height(plane, x));
    const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
    if (*highest <= kOnPlane) return put(sides.below);
    if (*lowest >= -kOnPlane) return put(sides.above);
    ++sides.parted;
    for (std::size_t k = 0; k < heights.size(); ++k) {
      if (heights[k] <= kOnPlane) sides.below.push_back(polygon.corners[k]);
      if (heights[k] >= -kOnPlane) sides.above.push_back(polygon.corners[k]);
      const std::size_t next = (k + 1) % heights.size();
      if ((heights[k] < -kOnPlane && heights[next] > kOnPlane) ||
          (heights[k] > kOnPlane && heights[next] < -kOnPlane)) {
        const Vec3 meet = polygon.corners[k] +
                          heights[k] / (heights[k] - heights[next]) * (polygon.corners[next] - polygon.corners[k]);
        sides.below.push_back(meet);
        sides.above.push_back(meet);
      }
    }
  };
  const std::size_t step = 1 + polygons_.size() / kMostJudged;
  for (std::size_t i = 0; i < polygons_.size(); i += step) add(*polygons_[i]);
  for (const Vec3& x : own_points_) {
    const double height = planes.height(plane, x);
    if (height <= kOnPlane) sides.below.push_back(x);
    if (height >= -kOnPlane) sides.above.push_back(x);
  }
  // An edge of the cell that runs in the solid goes on to the plane.
  for (const PlanePolygon& facet : here_.cell.facets()) {
    for (std::size_t k = 0; k < facet.corners.size(); ++k) {
      const Vec3 &p = facet.corners[k], &q = facet.corners[(k + 1) % facet.corners.size()];
      const double a = planes.height(plane, p), b = planes.height(plane, q);
      if (!((a < 0 && b > 0) || (a > 0 && b < 0))) continue;
      const Vec3 meet = p + a / (a - b) * (q - p);
      if (!cells_.holds(meet)) continue;
      sides.below.push_back(meet);
      sides.above.push_back(meet);
    }
  }
  return sides;
}

std::vector<Side> CellContents::planes_of_faces(const Vec3& worst) const {
  const auto hull = ConvexPolytope::from_points(points_);
  struct Candidate {
    Side plane;
    double weight = 0;
  };
  std::map<std::int32_t, Candidate> known;
  const PlaneSet& planes = cells_.planes();
  double nearest = HUGE_VAL;
  std::optional<Side> near;
  for (const PlanePolygon& face : here_.faces) {
    const auto [place, fresh] = known.try_emplace(face.plane.plane(), Candidate{face.plane, 0});
    if (fresh) {
      if (hull) place->second.weight = std::max(0.0, rise_of(*hull, planes, face.plane));
      // No corner lies above the plane: it cuts nothing off.
      if (place->second.weight <= kOnPlane) place->second.weight = -1;
    }
    if (place->second.weight < 0) continue;
    place->second.weight += area_of(face);
    const double distance = (face.corners[0] - worst).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      near = face.plane;
    }
  }
  std::vector<Candidate> list;
  for (const auto& [number, candidate] : known) {
    if (candidate.weight > 0) list.push_back(candidate);
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const Candidate& a, const Candidate& b) { return a.weight > b.weight; });
  std::vector<Side> sides;
  if (near) sides.push_back(*near);
  for (const Candidate& candidate : list) {
    if (sides.size() < kMostFacePlanes && !(near && candidate.plane == *near)) sides.push_back(candidate.plane);
  }
  return sides;
}

std::vector<Side> CellContents::planes_across_axes(PlaneSet& planes, const Vec3& worst) const {
  Vec3 low = points_.front(), high = points_.front();
  for (const Vec3& x : points_) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  std::vector<Side> sides;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = high[axis] - low[axis];
    std::vector<double> places;
    for (const double share : {0.25, 0.5, 0.75}) places.push_back(low[axis] + share * length);
    if (worst[axis] > low[axis] && worst[axis] < high[axis]) places.push_back(worst[axis]);
    for (const double place : places) {
      // Few digits keep the plane's numbers, and those of all corners on the plane, short.
      const double digit = std::ldexp(1.0, std::ilogb(std::max(length, 0x1p-40)) - 10);
      const double offset = std::round(place / digit) * digit;
      if (!(offset > low[axis] && offset < high[axis])) continue;
      const Vec3 unit = Vec3::Unit(axis);
      sides.push_back(planes.add(to_dyadic(unit), Dyadic(std::ldexp(offset, cells_.exponent()))));
    }
  }
  return sides;
}

std::optional<Side> CellContents::best_cut(PlaneSet& planes, const Vec3& worst, std::int64_t& steps) const {
  std::vector<Side> sides = planes_of_faces(worst);
  for (const Side side : planes_across_axes(planes, worst)) sides.push_back(side);
  std::optional<Side> best;
  double least = HUGE_VAL;
  for (const Side side : sides) {
    const Sides parts = sides_of(planes, side);
    steps += static_cast<std::int64_t>(parts.below.size() + parts.above.size());
    const double below = hull_volume(parts.below), above = hull_volume(parts.above);
    if (below <= 0 && above <= 0) continue;
    // Halves of like size make shorter ways to small ones; cuts through many faces make many pieces.
    constexpr double kUneven = 0.05, kParted = 0.02;
    const double share = static_cast<double>(parts.parted) / static_cast<double>(polygons_.size());
    const double cost = (below + above) * (1 + kParted * share) + kUneven * std::abs(below - above);
    if (cost < least) {
      least = cost;
      best = side;
    }
  }
  return best;
}

}  // namespace pd::detail
