#include "pd/depth/level_queries.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "depth/rays/hierarchy_descent.hpp"
#include "depth/rays/outer_crossing.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/root_sum.hpp"
#include "shape/refused_vector.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::Dyadic3;

struct Rounded {
  double lower, upper;
};

/// |numerator / denominator| |d|.
Rounded length_of(const Dyadic& numerator, const Dyadic& denominator, const Dyadic3& d) {
  if (numerator.sign() == 0) return {0, 0};
  const detail::RootSum size(Dyadic(0.0), 1, numerator * numerator * dot(d, d), denominator * denominator);
  const double lower = size.round_down();
  return {lower, size.round_up(lower)};
}

/// t |d| where the origin's line along d meets the plane of the corners; of either sign.
Rounded time_of(const detail::PosedPair& pair, const Dyadic3& d, const std::array<detail::VertexPair, 3>& c) {
  const auto to = [&](std::size_t i) {
    return pair.exact(detail::PairVector::difference(c[0].a, c[0].b, c[i].a, c[i].b));
  };
  const Dyadic3 normal = cross(to(1), to(2));
  const Dyadic offset = dot(pair.exact(detail::PairVector::point(c[0].a, c[0].b)), normal);
  const Dyadic slope = dot(d, normal) * pair.homogeneous_factor();
  const Rounded size = length_of(offset, slope, d);
  return offset.sign() > 0 ? size : Rounded{-size.upper, -size.lower};
}

const char* const kLevels = "levels run from 0 to one below their number";

}  // namespace

Expected<LevelCrossing> crossing_of_level(const PolyhedralHierarchy& hierarchy, int level, const ConvexPolytope& small,
                                          const Vec3& direction) {
  const detail::FloatingPointGuard guard;
  if (hierarchy.kind() != HierarchyKind::inner) {
    return Error{ErrorCode::unsupported, "levels of an inner hierarchy are asked for", "hierarchy"};
  }
  if (level < 0 || level >= static_cast<int>(hierarchy.levels().size())) {
    return Error{ErrorCode::out_of_range, kLevels, "level"};
  }
  if (small.num_vertices() > PolyhedralHierarchy::kMaxDegree + 1) {
    return Error{ErrorCode::limit_exceeded, "the small body has at most 9 vertices", "small"};
  }
  if (const auto error = detail::refuse_direction(direction)) return *error;
  const Pose still;
  const detail::PosedPair pair(small, still, hierarchy.polytope(), still);
  LevelCrossing out;
  std::array<Rounded, 2> times{};
  for (const std::size_t way : {std::size_t{0}, std::size_t{1}}) {
    const detail::DirectionSigns ray(pair, way == 0 ? direction : Vec3(-direction));
    const auto found = descend_hierarchies(ray, {}, {&hierarchy, level});
    out.steps += found.steps;
    if (!found.crosses) return out;
    times[way] = time_of(pair, ray.exact(), *found.corners);
  }
  out.meets = true;
  out.leave_lower = times[0].lower;
  out.leave_upper = times[0].upper;
  out.enter_lower = -times[1].upper;
  out.enter_upper = -times[1].lower;
  return out;
}

Expected<LevelCrossing> crossing_of_level(const TwinHierarchy& twin, int level, const Vec3& point,
                                          const Vec3& direction) {
  const detail::FloatingPointGuard guard;
  if (level < 0 || level >= twin.num_levels()) return Error{ErrorCode::out_of_range, kLevels, "level"};
  if (!point.allFinite()) return Error{ErrorCode::non_finite, "a point needs three finite numbers", "point"};
  if (const auto error = detail::refuse_direction(direction)) return *error;
  LevelCrossing out;
  std::array<Rounded, 2> times{};
  const Dyadic3 d = detail::to_dyadic(direction);
  for (const std::size_t way : {std::size_t{0}, std::size_t{1}}) {
    const auto found = detail::cross_outer_hierarchy(twin.outer(level), point, way == 0 ? direction : Vec3(-direction));
    out.steps += found.steps;
    out.certificate += found.certificate;
    out.repairs += found.repairs;
    if (!found.entry) return out;
    const auto& [offset, slope] = *found.entry;
    const Rounded size = length_of(offset, slope, d);
    const bool positive = offset.sign() * slope.sign() > 0;
    times[way] = positive ? size : Rounded{-size.upper, -size.lower};
  }
  out.meets = true;
  out.enter_lower = times[0].lower;
  out.enter_upper = times[0].upper;
  out.leave_lower = -times[1].upper;
  out.leave_upper = -times[1].lower;
  return out;
}

}  // namespace pd
