#include "pd/dimension/approximate_body.hpp"

#include "dimension/equal_planes.hpp"
#include "dimension/halfspace_body.hpp"
#include "dimension/kernel_builder.hpp"
#include "dimension/validate.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd::dimension {

namespace {

using detail::AnyBody;
using detail::KernelBuilder;
using AnyApproximation = ApproximateBody<kAnyDimension>;

/// Moves what lies on the wrong side by rounding alone; far below the least epsilon.
constexpr double kBlowUpRoom = 1e-9;

/// A hull whose vertices and planes stand for a body in a frame: inner <= 1, outer >= limit, as multiples of it.
double blow_up(Side side, double limit) { return side == Side::outer ? limit : 1 - kBlowUpRoom; }

/// conv(kernel) is in K is in limit conv(kernel), about the frame's origin.
AnyApproximation from_points(const AnyBody& body, double epsilon, Representation representation, Side side) {
  const detail::AnySandwich& sandwich = body.sandwich;
  KernelBuilder builder(sandwich.fattening(), epsilon);
  builder.add(body.points, 0);
  const double factor = blow_up(side, builder.limit());
  AnyApproximation r;
  r.representation = representation;
  if (representation == Representation::points) {
    for (const auto& p : builder.chosen()) {
      r.points.push_back(side == Side::inner ? p.point : sandwich.centre + factor * (p.point - sandwich.centre));
    }
    return r;
  }
  const auto& hull = builder.hull();
  const detail::AnyMap& to_unit = builder.to_unit();
  const std::vector<std::int32_t> same = detail::merge_equal_planes(hull);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(same.size()); ++f) {
    if (same[f] != f) continue;
    const detail::AnyVector normal = to_unit.pull_back(hull.normal(f));
    const double length = normal.norm();
    r.halfspaces.push_back({normal / length, (factor + normal.dot(sandwich.centre)) / length});
  }
  return r;
}

/// With H the hull of the polar's kernel: K is in H^o is in limit K, about the frame's origin.
AnyApproximation from_halfspaces(const AnyBody& body, double epsilon, Representation representation, Side side) {
  const detail::AnySandwich& sandwich = body.sandwich;
  std::vector<detail::AnyVector> polar = detail::polar_points(body.halfspaces, sandwich);
  for (detail::AnyVector& q : polar) q *= sandwich.ratio;
  KernelBuilder builder(detail::identity_map(body.dimension()), epsilon);
  builder.add(polar, 0);
  AnyApproximation r;
  r.representation = representation;
  if (representation == Representation::halfspaces) {
    for (const auto& p : builder.chosen()) {
      detail::AnyHalfspace h = body.halfspaces[static_cast<std::size_t>(p.index)];
      const double apex = h.normal.dot(sandwich.centre);
      if (side == Side::inner) h.offset = apex + (h.offset - apex) / builder.limit();
      r.halfspaces.push_back(h);
    }
    return r;
  }
  const double factor = side == Side::inner ? 1 / builder.limit() : 1 + kBlowUpRoom;
  const auto& hull = builder.hull();
  const std::vector<std::int32_t> same = detail::merge_equal_planes(hull);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(same.size()); ++f) {
    if (same[f] != f) continue;
    const detail::AnyVector unit = factor * sandwich.ratio * hull.normal(f);
    r.points.push_back(sandwich.centre + sandwich.axes * unit);
  }
  return r;
}

}  // namespace

template <int D>
Expected<ApproximateBody<D>> approximate_body(const Body<D>& body, double epsilon, Representation representation,
                                              Side side) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  if (epsilon < 1e-6) return Error{ErrorCode::bad_value, "an approximation needs epsilon >= 1e-6", "epsilon"};
  // Outer: limit - 1 = epsilon / 2, less a hair for rounding.
  const double half = epsilon / 2 * (1 - 1e-4);
  const double share = side == Side::outer ? half / (1 + half) : epsilon * (1 - 1e-4);
  const AnyBody any = detail::any<D>(body);
  const AnyApproximation r = any.representation == Representation::points
                                 ? from_points(any, share, representation, side)
                                 : from_halfspaces(any, share, representation, side);
  return ApproximateBody<D>{r.representation, detail::fixed<D>(r.points), detail::fixed<D>(r.halfspaces)};
}

template Expected<ApproximateBody<2>> approximate_body<2>(const Body<2>&, double, Representation, Side);
template Expected<ApproximateBody<3>> approximate_body<3>(const Body<3>&, double, Representation, Side);
template Expected<ApproximateBody<4>> approximate_body<4>(const Body<4>&, double, Representation, Side);
template Expected<ApproximateBody<5>> approximate_body<5>(const Body<5>&, double, Representation, Side);

}  // namespace pd::dimension
