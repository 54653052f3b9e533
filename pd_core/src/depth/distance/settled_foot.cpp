#include "depth/distance/settled_foot.hpp"

#include <algorithm>

#include "depth/distance/gjk.hpp"
#include "depth/distance/gjk_double_double.hpp"

namespace pd::detail {

namespace {

/// Steps in double-double where doubles see no progress: up to 0.7 microseconds each.
constexpr int kFineSteps = 64;

Vec3 point_of_a(const SmoothDifference& difference, const ClosestPoint& nearest) {
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (int i = 0; i < nearest.count; ++i) {
    const double weight = std::max(0.0, nearest.weights[i]);
    sum += weight * difference.points(nearest.simplex[i]).a;
    total += weight;
  }
  return sum / total;
}

/// A direction and P's height along it, rounded up.
struct Plane {
  Vec3 normal;
  double height;
};

Plane supporting_plane(const SmoothDifference& difference, const Vec3& direction, std::int64_t& support_calls) {
  const Vec3 unit = direction.normalized();
  ++support_calls;
  return {unit, difference.support(unit, nullptr).x.dot(unit) + support_plane_error(difference)};
}

}  // namespace

Foot settled_foot(const SmoothDifference& difference, const Foot& from, double allowed, int rounds,
                  std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  Foot best = from;
  Plane plane{from.normal, from.height};
  Vec3 last_turn = Vec3::Zero();
  for (int round = 0; round < rounds; ++round) {
    const SmoothDifference there = difference.moved(plane.height * plane.normal);
    const DifferenceVertex first = there.support(plane.normal, nullptr);
    const BracketWidth width{0, 0.25 * allowed, 0};
    ClosestPoint nearest = closest_point(there, {&first, 1}, 0, width, stack, ++support_calls);
    Vec3 normal = nearest.normal;
    if (!nearest.certified && nearest.upper > allowed) {
      const ClosestPointWithNormal fine =
          closest_point_double_double(there, first, 0, width, kFineSteps, stack, support_calls);
      normal = fine.normal;
      if (fine.nearest.upper < nearest.upper) nearest = fine.nearest;
    }
    if (nearest.upper < best.missed) best = {plane.normal, plane.height, point_of_a(there, nearest), nearest.upper};
    if (nearest.upper <= allowed) break;
    const Plane next = supporting_plane(difference, normal, support_calls);
    if (!(next.height < plane.height)) break;
    // Turns shrink by one ratio in the end: the sum of all that would follow is tried at once.
    const Vec3 turn = next.normal - plane.normal;
    const double ratio = last_turn.squaredNorm() > 0 ? turn.dot(last_turn) / last_turn.squaredNorm() : 0;
    plane = next;
    last_turn = turn;
    if (!(ratio > 0 && ratio < 0.99)) continue;
    const Plane leap = supporting_plane(difference, next.normal + ratio / (1 - ratio) * turn, support_calls);
    if (!(leap.height < plane.height)) continue;
    plane = leap;
    last_turn = Vec3::Zero();
  }
  return best;
}

}  // namespace pd::detail
