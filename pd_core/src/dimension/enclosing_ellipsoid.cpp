#include "pd/dimension/enclosing_ellipsoid.hpp"

#include <array>
#include <cmath>

#include "dimension/validate.hpp"
#include "dimension/weighted_ellipsoid.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd::dimension {

namespace {

/// The farthest point from the centre in each orthant of the ellipsoid's own frame: several violators a pass, well
/// apart, so that few passes are needed.
struct Farthest {
  std::array<double, 1 << kMaxDimension> squared{};
  std::array<std::size_t, 1 << kMaxDimension> index{};
};

Farthest farthest(const detail::Points& points, const detail::AnySandwich& sandwich) {
  Farthest r;
  const detail::AnyMatrix linear = sandwich.fattening().linear;
  const detail::AnyVector centre = sandwich.centre;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const detail::AnyVector y = detail::in_frame(linear, centre, points.data(i));
    const double squared = y.squaredNorm();
    unsigned orthant = 0;
    for (int k = 0; k < points.dimension(); ++k) orthant |= static_cast<unsigned>(y[k] > 0) << k;
    if (squared > r.squared[orthant]) {
      r.squared[orthant] = squared;
      r.index[orthant] = i;
    }
  }
  return r;
}

}  // namespace

Expected<EnclosingEllipsoid<kAnyDimension>> detail::enclosing_ellipsoid_of(const Points& points, double eta) {
  const pd::detail::FloatingPointGuard guard;
  // The certificate keeps 1e-9 for rounding, which a smaller eta could not be told from.
  if (!(eta >= detail::kLeastEpsilon && eta <= 1)) {
    return Error{ErrorCode::bad_value, "eta must lie in [1e-7, 1]", "eta"};
  }
  if (const auto error = detail::check_points(points)) return *error;

  EnclosingEllipsoid<kAnyDimension> result;
  detail::CoreSet core_set;
  core_set.add(points);
  result.passes = 1;
  if (!core_set.full_dimensional()) return detail::flat_error("points", points.dimension());
  std::vector<AnyVector> core = core_set.points();
  for (;;) {
    if (!detail::core_ellipsoid(core, eta / 2, result.sandwich, result.steps)) {
      return detail::flat_error("points", points.dimension());
    }
    const Farthest far = farthest(points, result.sandwich);
    ++result.passes;
    const double d = points.dimension();
    const double limit = d * (1 + eta);
    double most = 0;
    for (const double squared : far.squared) most = std::max(most, squared);
    // The certificate of the core's weights, with the extent of all points on the outer side.
    result.sandwich.ratio = std::sqrt(most) * (1 + 1e-9);
    if (result.sandwich.ratio <= limit) break;
    for (std::size_t k = 0; k < far.squared.size(); ++k) {
      if (far.squared[k] > d * d * (1 + eta / 2)) core.push_back(points[far.index[k]]);
    }
  }
  result.core_size = static_cast<std::int64_t>(core.size());
  return result;
}

template <int D>
Expected<EnclosingEllipsoid<D>> enclosing_ellipsoid(std::span<const Vector<D>> points, double eta) {
  const auto r = detail::enclosing_ellipsoid_of(points, eta);
  if (!r) return r.error();
  return EnclosingEllipsoid<D>{detail::fixed<D>(r->sandwich), r->passes, r->core_size, r->steps};
}

template Expected<EnclosingEllipsoid<2>> enclosing_ellipsoid<2>(std::span<const Vector<2>>, double);
template Expected<EnclosingEllipsoid<3>> enclosing_ellipsoid<3>(std::span<const Vector<3>>, double);
template Expected<EnclosingEllipsoid<4>> enclosing_ellipsoid<4>(std::span<const Vector<4>>, double);
template Expected<EnclosingEllipsoid<5>> enclosing_ellipsoid<5>(std::span<const Vector<5>>, double);

}  // namespace pd::dimension
