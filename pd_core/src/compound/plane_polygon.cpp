#include "compound/plane_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pd::detail {

namespace {

/// The sides from `first` to `last` along the loop, closed by `closing`.
void take(const PlanePolygon& whole, std::size_t first, std::size_t last, Side closing, PlanePolygon& part) {
  const std::size_t n = whole.sides.size();
  part.plane = whole.plane;
  part.sides.clear();
  for (std::size_t i = first;; i = (i + 1) % n) {
    part.sides.push_back(whole.sides[i]);
    if (i == last) break;
  }
  part.sides.push_back(closing);
}

}  // namespace

void PlanePolygon::update(const PlaneSet& planes) {
  const std::size_t n = sides.size();
  corners.resize(n);
  error = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const PlaneSet::Point p = planes.meet(plane, sides[i], sides[(i + 1) % n]);
    corners[i] = p.x;
    error = std::max(error, p.error);
  }
}

Cut cut(const PlaneSet& planes, const PlanePolygon& polygon, Side side, PlanePolygon& inner, PlanePolygon* outer) {
  if (side.plane() == polygon.plane.plane()) return Cut::inside;
  const std::size_t n = polygon.sides.size();
  // A filter that decides most polygons: every corner far on one side.
  const Vec3 normal = planes.normal(side) * planes.inverse_length(side);
  const double offset = planes.offset(side) * planes.inverse_length(side);
  double low = HUGE_VAL, high = -HUGE_VAL, reach = 0;
  for (const Vec3& x : polygon.corners) {
    const double height = normal.dot(x) - offset;
    low = std::min(low, height);
    high = std::max(high, height);
    reach = std::max(reach, x.cwiseAbs().maxCoeff());
  }
  const double slack = 2 * polygon.error + 0x1p-48 * (reach + std::abs(offset)) + 0x1p-900;
  if (low > slack) return Cut::outside;
  if (high < -slack) return Cut::inside;

  std::vector<int> signs(n);
  bool any_inside = false, any_outside = false;
  for (std::size_t i = 0; i < n; ++i) {
    const double height = normal.dot(polygon.corners[i]) - offset;
    signs[i] = height > slack ? 1
               : height < -slack
                   ? -1
                   : planes.sign_at_meet(polygon.plane, polygon.sides[i], polygon.sides[(i + 1) % n], side);
    any_inside = any_inside || signs[i] < 0;
    any_outside = any_outside || signs[i] > 0;
  }
  if (!any_inside) return Cut::outside;
  if (!any_outside) return Cut::inside;
  // Edge i runs from corner i - 1 to corner i. By convexity each open side of the line holds one run of corners; its
  // part keeps the edges from the one that enters the run to the one that leaves it.
  for (const int sign : {-1, 1}) {
    if (sign > 0 && outer == nullptr) break;
    std::size_t enters = 0, leaves = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool from = signs[(i + n - 1) % n] == sign, to = signs[i] == sign;
      if (!from && to) enters = i;
      if (from && !to) leaves = i;
    }
    take(polygon, enters, leaves, sign < 0 ? side : side.opposite(), sign < 0 ? inner : *outer);
  }
  inner.update(planes);
  if (outer != nullptr) outer->update(planes);
  return Cut::split;
}

std::optional<PlanePolygon> part_inside(const PlaneSet& planes, PlanePolygon polygon, std::span<const Side> walls) {
  for (const Side wall : walls) {
    PlanePolygon inner;
    switch (cut(planes, polygon, wall, inner, nullptr)) {
      case Cut::outside:
        return std::nullopt;
      case Cut::inside:
        break;
      case Cut::split:
        polygon = std::move(inner);
        break;
    }
  }
  return polygon;
}

bool contains_point(const PlaneSet& planes, const PlanePolygon& polygon, const Vec3& x) {
  return planes.sign_at_point(polygon.plane, x) == 0 &&
         std::all_of(polygon.sides.begin(), polygon.sides.end(),
                     [&](Side s) { return planes.sign_at_point(s, x) <= 0; });
}

namespace {

/// The nearest point, and what it lies on: the inside (-1, -1), edge (i, -1) or corner (i, i).
struct NearestFeature {
  Vec3 x;
  std::ptrdiff_t edge = -1;
  std::ptrdiff_t corner = -1;
};

/// Whether a point of the plane lies in the polygon, by the corners: sides may cross the plane at angles too flat for
/// doubles. Wrong only within a few `error` of the rim.
bool seems_inside(const PlanePolygon& polygon, const Vec3& normal, const Vec3& x) {
  const std::size_t n = polygon.corners.size();
  Vec3 low = polygon.corners[0], high = low;
  for (const Vec3& c : polygon.corners) {
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  if ((low - x).maxCoeff() > 4 * polygon.error || (x - high).maxCoeff() > 4 * polygon.error) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &from = polygon.corners[(i + n - 1) % n], &to = polygon.corners[i];
    if ((to - from).cross(x - from).dot(normal) < 0) return false;
  }
  return true;
}

NearestFeature nearest_feature(const PlaneSet& planes, const PlanePolygon& polygon) {
  const Vec3 normal = planes.normal(polygon.plane) * planes.inverse_length(polygon.plane);
  const Vec3 projection = normal * (planes.offset(polygon.plane) * planes.inverse_length(polygon.plane));
  const std::size_t n = polygon.corners.size();
  if (seems_inside(polygon, normal, projection)) return {projection};
  NearestFeature best{polygon.corners[0], 0, 0};
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &from = polygon.corners[(i + n - 1) % n], &to = polygon.corners[i];
    const Vec3 edge = to - from;
    const double length = edge.squaredNorm();
    const double t = length > 0 ? std::clamp(-from.dot(edge) / length, 0.0, 1.0) : 0;
    const Vec3 x = t == 1 ? to : Vec3(from + t * edge);
    const double squared = x.squaredNorm();
    if (squared >= least) continue;
    least = squared;
    const auto at = static_cast<std::ptrdiff_t>(i);
    best = {x, at, t == 0 ? static_cast<std::ptrdiff_t>((i + n - 1) % n) : t == 1 ? at : -1};
  }
  return best;
}

/// The point of the line where two planes meet that is nearest to the origin: a third plane through the origin, across
/// the line.
PlaneSet::ExactPoint nearest_of_line(const PlaneSet& planes, Side f, Side q) {
  const Dyadic3 nf = planes.exact_normal(f), nq = planes.exact_normal(q);
  const Dyadic3 along = cross(nf, nq);
  return {cross(nq, along) * planes.exact_offset(f) + cross(along, nf) * planes.exact_offset(q), dot(along, along)};
}

}  // namespace

Vec3 nearest_point(const PlaneSet& planes, const PlanePolygon& polygon) { return nearest_feature(planes, polygon).x; }

ExactNearestPoint exact_nearest_point(const PlaneSet& planes, const PlanePolygon& polygon) {
  const std::size_t n = polygon.sides.size();
  std::vector<PlaneSet::ExactPoint> corners(n);
  for (std::size_t i = 0; i < n; ++i) {
    corners[i] = planes.exact_meet(polygon.plane, polygon.sides[i], polygon.sides[(i + 1) % n]);
  }
  ExactNearestPoint result;
  // x is nearest exactly when it lies in the polygon and <x, c> >= <x, x> for every corner c.
  const auto proved = [&](const PlaneSet::ExactPoint& x) {
    const Dyadic squared = dot(x.numerator, x.numerator);
    for (std::size_t i = 0; i < n; ++i) {
      if ((dot(x.numerator, corners[i].numerator) * x.denominator - squared * corners[i].denominator).sign() < 0) {
        return false;
      }
      const Side s = polygon.sides[i];
      if ((dot(planes.exact_normal(s), x.numerator) - planes.exact_offset(s) * x.denominator).sign() > 0) return false;
    }
    return true;
  };
  const auto accept = [&](PlaneSet::ExactPoint x, bool projection) {
    if (!proved(x)) return false;
    result = {std::move(x), projection};
    return true;
  };
  const auto projection = [&] {
    const Dyadic3 normal = planes.exact_normal(polygon.plane);
    return PlaneSet::ExactPoint{normal * planes.exact_offset(polygon.plane), dot(normal, normal)};
  };
  const auto of_edge = [&](std::size_t i) { return nearest_of_line(planes, polygon.plane, polygon.sides[i]); };
  // The guess of doubles first; one of them all is right.
  const NearestFeature guess = nearest_feature(planes, polygon);
  if (guess.corner >= 0 && accept(corners[static_cast<std::size_t>(guess.corner)], false)) return result;
  if (guess.corner < 0 && guess.edge >= 0 && accept(of_edge(static_cast<std::size_t>(guess.edge)), false)) {
    return result;
  }
  if (accept(projection(), true)) return result;
  for (std::size_t i = 0; i < n; ++i) {
    if (accept(of_edge(i), false)) return result;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (accept(corners[i], false)) return result;
  }
  return result;
}

}  // namespace pd::detail
