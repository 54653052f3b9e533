#include "depth/distance/closest_of_few.hpp"

#include <algorithm>

#include "depth/distance/nearest_of_few.hpp"

namespace pd::detail {

ClosestOfFew closest_of_few(const PolytopeDifference& difference, std::span<const DifferenceVertex> start,
                            const Vec3& direction, const FewSettings& settings, std::int64_t& support_calls) {
  const DistanceErrors error = distance_errors(difference);
  VertexPair first[4];
  for (std::size_t i = 0; i < start.size(); ++i) first[i] = {start[i].a, start[i].b};
  const Vec3& t = difference.offset();
  const double limit = settings.width.limit(difference.coordinate_of_ends());
  const bool any_distance = settings.beyond == std::numeric_limits<double>::infinity();
  const NearestOfFew found =
      nearest_of_few({difference.posed_a(), difference.posed_b(), {t.x(), t.y(), t.z()}}, first,
                     static_cast<int>(start.size()), {direction.x(), direction.y(), direction.z()},
                     {.gap = limit - (error.upper + error.lower),
                      .beyond = settings.beyond + error.lower,
                      .within = any_distance ? 0 : settings.beyond,
                      .apart = error.lower,
                      .shown_after = settings.shown_after,
                      .deepest = settings.deepest});
  support_calls += found.supports;
  ClosestOfFew out;
  ClosestPoint& r = out.nearest;
  r.normal = {found.direction[0], found.direction[1], found.direction[2]};
  r.lower = found.height - error.lower;
  if (found.status == NearestOfFew::Status::beyond) {
    out.beyond = true;
    out.next_to_plane = difference.vertex(found.support.a, found.support.b);
    return out;
  }
  if (found.status == NearestOfFew::Status::undecided) return out;
  r.count = found.count;
  for (int i = 0; i < found.count; ++i) {
    const double* const x = found.points[i];
    r.simplex[i] = {{x[0], x[1], x[2]}, found.simplex[i].a, found.simplex[i].b};
    r.weights[i] = found.weights[i];
    r.point += found.weights[i] * r.simplex[i].x;
  }
  const double length = r.point.norm();
  r.upper = length + error.upper;
  // Witnesses along the normal: the search turns across its last edge or triangle, whatever rounding did to the
  // weights.
  const bool along = (r.point + length * r.normal).squaredNorm() <= 36 * error.upper * error.upper;
  r.certified = along && r.lower > 0 &&
                (r.upper - r.lower <= limit || settings.width.is_within(settings.relative, r.lower, r.upper));
  return out;
}

}  // namespace pd::detail
