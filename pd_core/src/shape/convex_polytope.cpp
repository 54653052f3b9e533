#include "pd/shape/convex_polytope.hpp"

#include <array>
#include <cmath>

#include "numeric/number_text.hpp"
#include "pd/shape/pose.hpp"
#include "shape/hull/hull_builder.hpp"

namespace pd {

Expected<ConvexPolytope> ConvexPolytope::from_points(std::span<const Vec3> points) {
  if (auto refused = detail::refuse_points(points)) return *std::move(refused);
  return detail::build_hull(points);
}

Expected<ConvexPolytope> ConvexPolytope::box(const Vec3& half_extents) {
  for (int i = 0; i < 3; ++i) {
    const double h = half_extents[i];
    const std::string where = detail::indexed("half_extents", i);
    if (!std::isfinite(h)) return Error{ErrorCode::non_finite, "a half extent must be finite", where};
    if (!(h > 0)) return Error{ErrorCode::bad_value, detail::number_text(h) + " must be > 0", where};
    if (h > kMaxCoordinate) {
      return Error{ErrorCode::out_of_range,
                   detail::number_text(h) + " is beyond the largest coordinate " + detail::number_text(kMaxCoordinate),
                   where};
    }
  }
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    const auto side = [&](unsigned axis) { return ((i >> axis) & 1U) != 0 ? half_extents[axis] : -half_extents[axis]; };
    corners[i] = {side(0), side(1), side(2)};
  }
  return detail::build_hull(corners);
}

}  // namespace pd
