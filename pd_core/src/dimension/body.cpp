#include "pd/dimension/body.hpp"

#include <cmath>

#include "dimension/halfspace_body.hpp"
#include "dimension/validate.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace {

/// Of the sandwich that every body carries: fattening asks for a constant, and each halving costs a pass.
constexpr double kEta = 0.1;

}  // namespace

template <int D>
Expected<Body<D>> Body<D>::from_points(std::vector<Vector<D>> points) {
  const pd::detail::FloatingPointGuard guard;
  const Expected<EnclosingEllipsoid<D>> ellipsoid = enclosing_ellipsoid<D>(points, kEta);
  if (!ellipsoid) return ellipsoid.error();
  if (detail::too_thin<D>(ellipsoid->sandwich)) return detail::flat_error<D>("points");
  auto data = std::make_shared<Storage>();
  data->representation = Representation::points;
  data->points = std::move(points);
  data->sandwich = ellipsoid->sandwich;
  return Body(std::move(data));
}

template <int D>
Expected<Body<D>> Body<D>::from_halfspaces(std::vector<Halfspace<D>> halfspaces) {
  const pd::detail::FloatingPointGuard guard;
  Expected<Sandwich<D>> sandwich = detail::sandwich_of_halfspaces<D>(halfspaces, kEta);
  if (!sandwich) return sandwich.error();
  if (detail::too_thin<D>(*sandwich)) return detail::flat_error<D>("halfspaces");
  auto data = std::make_shared<Storage>();
  data->representation = Representation::halfspaces;
  data->halfspaces = std::move(halfspaces);
  data->sandwich = *sandwich;
  return Body(std::move(data));
}

template <int D>
Expected<Body<D>> Body<D>::transformed(const AffineMap<D>& map) const {
  const pd::detail::FloatingPointGuard guard;
  if (!map.linear.allFinite() || !map.translation.allFinite()) {
    return Error{ErrorCode::non_finite, "an affine map needs finite numbers", "affine"};
  }
  const std::optional<Matrix<D>> inverse = inverse_if_regular<D>(map.linear);
  if (!inverse) {
    return Error{ErrorCode::bad_value, "the matrix of an affine map must be regular", "affine"};
  }
  if (representation() == Representation::points) {
    std::vector<Vector<D>> points;
    points.reserve(data_->points.size());
    for (const Vector<D>& p : data_->points) points.push_back(map.apply(p));
    return from_points(std::move(points));
  }
  std::vector<Halfspace<D>> halfspaces;
  halfspaces.reserve(data_->halfspaces.size());
  for (const Halfspace<D>& h : data_->halfspaces) {
    const Vector<D> normal = inverse->transpose() * h.normal;
    halfspaces.push_back({normal, h.offset + normal.dot(map.translation)});
  }
  return from_halfspaces(std::move(halfspaces));
}

template <int D>
SupportPoint<D> Body<D>::support(const Vector<D>& direction) const {
  if (representation() == Representation::halfspaces) {
    return detail::extreme_point<D>(data_->halfspaces, data_->sandwich, direction);
  }
  SupportPoint<D> best{data_->points[0], direction.dot(data_->points[0]), 0};
  for (std::size_t i = 1; i < data_->points.size(); ++i) {
    const double value = direction.dot(data_->points[i]);
    if (value > best.value) best = {data_->points[i], value, static_cast<std::int64_t>(i)};
  }
  return best;
}

template class Body<2>;
template class Body<3>;
template class Body<4>;
template class Body<5>;

}  // namespace pd::dimension
