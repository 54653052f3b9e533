#include "depth/expansion/expanding_hull.hpp"

#include <algorithm>

namespace pd::detail {

ExpansionResult folded_expansion(const SmoothDifference& difference, ExactSurface& surface, const Vec3& start,
                                 const ExpansionGoal& goal, std::int64_t& support_calls) {
  const double lower_error = face_error(difference);
  const double upper_error = support_plane_error(difference);
  ExpansionResult result;
  double largest = 0;
  surface.clear();
  // Adds a support. False when its plane shows the bodies apart.
  const auto probe = [&](const Vec3& unit) {
    const DifferenceVertex s = difference.support(unit, nullptr);
    ++support_calls;
    surface.vertices.push_back(s);
    largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
    const double height = s.x.dot(unit);
    if (height + upper_error < result.upper) {
      result.upper = height + upper_error;
      result.normal = unit;
    }
    if (height >= -upper_error - goal.touching * largest) return true;
    result.status = ExpansionStatus::separated;
    return false;
  };
  Vec3 directions[4];
  surrounding_directions(start, difference.spread(), directions);
  for (const Vec3& d : directions) {
    if (!probe(d)) return result;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (!probe(Vec3::Unit(axis)) || !probe(-Vec3::Unit(axis))) return result;
  }
  if (!surface.start()) return result;
  for (;;) {
    const int f = surface.nearest();
    const ExactSurface::Face& face = surface.face(f);
    const double distance = face.distance;
    result.face = f;
    result.lower = distance - lower_error;
    const Vec3 unit = face.unit_normal;
    if (!probe(unit)) return result;
    if (result.upper <= goal.touching * largest && result.lower >= -goal.touching * largest) {
      result.status = ExpansionStatus::touching;
      return result;
    }
    if (result.lower > 0 && (result.upper - result.lower <= goal.absolute * largest ||
                             result.upper <= (1 + goal.relative) * result.lower)) {
      result.status = ExpansionStatus::certified;
      return result;
    }
    const double height = surface.vertices.back().x.dot(unit);
    if (height - distance <= 4 * lower_error || !surface.insert(f)) return result;
  }
}

}  // namespace pd::detail
