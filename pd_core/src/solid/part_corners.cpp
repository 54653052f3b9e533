#include "solid/part_corners.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numeric/quotient.hpp"

namespace pd::detail {

PartCorners::PartCorners(PlaneSet& planes, const ConvexCell& cell, double scale) : PartCorners(planes, scale) {
  for (const PlanePolygon& facet : cell.facets()) add(facet);
}

void PartCorners::add(const PlanePolygon& polygon) {
  const std::size_t n = polygon.sides.size();
  for (std::size_t i = 0; i < n; ++i) add(PlaneMeet{polygon.plane, polygon.sides[i], polygon.sides[(i + 1) % n]});
}

void PartCorners::add(const PlaneMeet& meet) {
  const PlaneSet::ExactPoint exact = planes_.exact_meet(meet[0], meet[1], meet[2]);
  const Vec3 x(quotient(exact.numerator.x, exact.denominator), quotient(exact.numerator.y, exact.denominator),
               quotient(exact.numerator.z, exact.denominator));
  points_.push_back(x);
  const bool is_double =
      std::all_of(meet.begin(), meet.end(), [&](Side side) { return planes_.sign_at_point(side, x) == 0; });
  meets_.push_back(meet);
  is_double_.push_back(static_cast<char>(is_double));
  exact_ = exact_ && is_double;
}

std::optional<ConvexPolytope> PartCorners::inner(const ConvexCell& cell) const {
  for (const double share : {0x1p-46, 0x1p-40, 0x1p-32, 0x1p-24, 0x1p-16, 0x1p-8}) {
    const std::vector<Vec3> points = moved(-share);
    const bool inside = std::all_of(points.begin(), points.end(), [&](const Vec3& x) {
      return std::all_of(cell.facets().begin(), cell.facets().end(),
                         [&](const PlanePolygon& facet) { return planes_.sign_at_point(facet.plane, x) <= 0; });
    });
    if (inside) return hull(points);
  }
  return std::nullopt;
}

PartCorners::Outer PartCorners::outer() const {
  double size = 0;
  const Vec3 middle = centre();
  for (const Vec3& x : points_) size = std::max(size, (x - middle).norm());
  for (const double share : {0.0, 0x1p-46, 0x1p-40, 0x1p-32, 0x1p-24}) {
    std::optional<ConvexPolytope> out = hull(moved(share));
    // Twice the share: moved points are rounded, too.
    if (out && holds(*out, share > 0)) return {*std::move(out), exact_ ? 0 : scale_ * (2 * share * size + 0x1p-48)};
  }
  // Boxes around the corners, wider than their rounding.
  std::vector<Vec3> points;
  double most = 0;
  for (const Vec3& x : points_) {
    const double reach = 0x1p-50 * std::max(x.cwiseAbs().maxCoeff(), 0x1p-900);
    most = std::max(most, reach);
    for (int k = 0; k < 8; ++k) {
      points.push_back(x + reach * Vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
    }
  }
  return {*hull(points), scale_ * 4 * most};
}

Vec3 PartCorners::centre() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : points_) sum += x / static_cast<double>(points_.size());
  return sum;
}

std::vector<Vec3> PartCorners::moved(double share) const {
  const Vec3 middle = centre();
  std::vector<Vec3> points;
  points.reserve(points_.size());
  for (const Vec3& x : points_) points.push_back(x + share * (x - middle));
  return points;
}

std::optional<ConvexPolytope> PartCorners::hull(std::vector<Vec3> points) const {
  for (Vec3& x : points) x *= scale_;
  Expected<ConvexPolytope> made = ConvexPolytope::from_points(points);
  if (!made || made->affine_dimension() < 3) return std::nullopt;
  return *std::move(made);
}

bool PartCorners::holds(const ConvexPolytope& polytope, bool doubles_too) const {
  if (exact_ && !doubles_too) return true;
  // A point that lies this deep below a facet's plane in doubles lies below it exactly.
  constexpr double kDeep = 0x1p-44;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const auto loop = polytope.facet_vertices(f);
    const auto corner = [&](std::size_t k) { return to_dyadic(polytope.vertex(loop[k])); };
    const Dyadic3 normal = cross(corner(1) - corner(0), corner(2) - corner(0));
    const Side plane = planes_.add(normal, dot(normal, corner(0)));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_double_[i] != 0 && !doubles_too) continue;
      if (planes_.height(plane, points_[i]) < -kDeep) continue;
      const PlaneMeet& meet = meets_[i];
      if (planes_.sign_at_meet(meet[0], meet[1], meet[2], plane) > 0) return false;
    }
  }
  return true;
}

}  // namespace pd::detail
