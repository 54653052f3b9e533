#include "pd/dimension/body.hpp"

#include <cmath>

#include "dimension/halfspace_body.hpp"
#include "dimension/validate.hpp"
#include "dimension/weighted_ellipsoid.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace {

/// Of the sandwich that every body carries: fattening asks for a constant, and each halving costs a pass.
constexpr double kEta = 0.1;

using detail::AnyBody;
using detail::AnyHalfspace;
using detail::AnyMap;
using detail::AnyMatrix;
using detail::AnySandwich;
using detail::AnySupport;
using detail::AnyVector;
using detail::Halfspaces;
using detail::Points;

Expected<AnySandwich> sandwich_of(const Points& points) {
  const pd::detail::FloatingPointGuard guard;
  const auto ellipsoid = detail::enclosing_ellipsoid_of(points, kEta);
  if (!ellipsoid) return ellipsoid.error();
  if (detail::too_thin(ellipsoid->sandwich)) return detail::flat_error("points", points.dimension());
  return ellipsoid->sandwich;
}

Expected<AnySandwich> sandwich_of(const Halfspaces& halfspaces) {
  const pd::detail::FloatingPointGuard guard;
  Expected<AnySandwich> sandwich = detail::sandwich_of_halfspaces(halfspaces, kEta);
  if (sandwich && detail::too_thin(*sandwich)) return detail::flat_error("halfspaces", halfspaces.dimension());
  return sandwich;
}

/// The inverse of the map's matrix, or why it maps no body.
Expected<AnyMatrix> checked_inverse(const AnyMap& map) {
  if (!map.linear.allFinite() || !map.translation.allFinite()) {
    return Error{ErrorCode::non_finite, "an affine map needs finite numbers", "affine"};
  }
  const std::optional<AnyMatrix> inverse = inverse_if_regular<kAnyDimension>(map.linear);
  if (!inverse) return Error{ErrorCode::bad_value, "the matrix of an affine map must be regular", "affine"};
  return *inverse;
}

std::vector<AnyVector> images(const AnyMap& map, const Points& points) {
  std::vector<AnyVector> r;
  r.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) r.push_back(map.apply(points[i]));
  return r;
}

std::vector<AnyHalfspace> images(const AnyMap& map, const AnyMatrix& inverse, const Halfspaces& halfspaces) {
  std::vector<AnyHalfspace> r;
  r.reserve(halfspaces.size());
  for (std::size_t i = 0; i < halfspaces.size(); ++i) {
    const AnyVector normal = inverse.transpose() * halfspaces.normals[i];
    r.push_back({normal, halfspaces.offset(i) + normal.dot(map.translation)});
  }
  return r;
}

}  // namespace

Expected<detail::AnyBody> detail::AnyBody::of(std::vector<AnyVector> points) {
  const Expected<AnySandwich> sandwich = sandwich_of(points);
  if (!sandwich) return sandwich.error();
  const auto kept = std::make_shared<const std::vector<AnyVector>>(std::move(points));
  return AnyBody{Representation::points, *kept, std::span<const AnyHalfspace>(), *sandwich, kept};
}

Expected<detail::AnyBody> detail::AnyBody::of(std::vector<AnyHalfspace> halfspaces) {
  const Expected<AnySandwich> sandwich = sandwich_of(std::span<const AnyHalfspace>(halfspaces));
  if (!sandwich) return sandwich.error();
  const auto kept = std::make_shared<const std::vector<AnyHalfspace>>(std::move(halfspaces));
  return AnyBody{Representation::halfspaces, std::span<const AnyVector>(), std::span<const AnyHalfspace>(*kept),
                 *sandwich, kept};
}

detail::AnySupport detail::AnyBody::support(const AnyVector& direction) const {
  if (representation == Representation::halfspaces) return detail::extreme_point(halfspaces, sandwich, direction);
  const int d = dimension();
  std::size_t best = 0;
  double most = detail::dot(direction.data(), points.data(0), d);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double value = detail::dot(direction.data(), points.data(i), d);
    if (!(value > most)) continue;
    most = value;
    best = i;
  }
  return {points[best], most, static_cast<std::int64_t>(best)};
}

template <int D>
Expected<Body<D>> Body<D>::from_points(std::vector<Vector<D>> points) {
  const Expected<AnySandwich> sandwich = sandwich_of(Points(points));
  if (!sandwich) return sandwich.error();
  return Body(std::make_shared<const Storage>(
      Storage{Representation::points, std::move(points), {}, detail::fixed<D>(*sandwich)}));
}

template <int D>
Expected<Body<D>> Body<D>::from_halfspaces(std::vector<Halfspace<D>> halfspaces) {
  const Expected<AnySandwich> sandwich = sandwich_of(Halfspaces(std::span<const Halfspace<D>>(halfspaces)));
  if (!sandwich) return sandwich.error();
  return Body(std::make_shared<const Storage>(
      Storage{Representation::halfspaces, {}, std::move(halfspaces), detail::fixed<D>(*sandwich)}));
}

template <int D>
Expected<Body<D>> Body<D>::transformed(const AffineMap<D>& map) const {
  const pd::detail::FloatingPointGuard guard;
  const AnyMap any = detail::any<D>(map);
  const Expected<AnyMatrix> inverse = checked_inverse(any);
  if (!inverse) return inverse.error();
  if (representation() == Representation::points) return from_points(detail::fixed<D>(images(any, points())));
  return from_halfspaces(detail::fixed<D>(images(any, *inverse, halfspaces())));
}

template <int D>
SupportPoint<D> Body<D>::support(const Vector<D>& direction) const {
  return detail::fixed<D>(detail::any<D>(*this).support(detail::any<D>(direction)));
}

template class Body<2>;
template class Body<3>;
template class Body<4>;
template class Body<5>;

}  // namespace pd::dimension
