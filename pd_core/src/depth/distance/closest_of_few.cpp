#include "depth/distance/closest_of_few.hpp"

#include <limits>

#include "depth/distance/nearest_of_few.hpp"
#include "depth/distance/simplex_lanes.hpp"

namespace pd::detail {

namespace {

/// What a plane by a scan of all posed vertices may lie too far, in units of the reach: vertices err by 4 sqrt(3) u of
/// their body's radius, two compared products by 3u each, the offset by u, the sum of a vertex of P by 2u, its product
/// by 3u and the normal's length by 4u.
constexpr double kScannedPlaneError = 24 * kUnitRoundoff;

bool is_narrow(const PolytopeDifference& difference, const ClosestPoint& r, double relative,
               const BracketWidth& width) {
  return r.upper - r.lower <= width.limit(difference.reach()) || width.is_within(relative, r.lower, r.upper);
}

/// The bracket of what a search has ended with.
ClosestPoint closest_point(const PolytopeDifference& difference, const NearestOfFew& found, const DistanceErrors& error,
                           double relative, const BracketWidth& width) {
  ClosestPoint r;
  r.normal = {found.direction[0], found.direction[1], found.direction[2]};
  r.lower = found.height - error.lower;
  if (found.status != NearestOfFew::Status::nearest) return r;
  r.count = found.count;
  for (int i = 0; i < found.count; ++i) {
    const double* const x = found.points[i];
    r.simplex[i] = {{x[0], x[1], x[2]}, found.simplex[i].a, found.simplex[i].b};
    r.weights[i] = found.weights[i];
    r.point += found.weights[i] * r.simplex[i].x;
  }
  const double length = r.point.norm();
  r.upper = length + error.upper;
  // Witnesses along the normal, which is across the last edge or triangle whatever rounding did to the weights.
  const bool along = (r.point + length * r.normal).squaredNorm() <= 36 * error.upper * error.upper;
  r.certified = along && r.lower > 0 && is_narrow(difference, r, relative, width);
  return r;
}

}  // namespace

FewVertices posed_few(const PolytopeDifference& difference) {
  const Vec3& t = difference.offset();
  return {difference.posed_a(), difference.posed_b(), {t.x(), t.y(), t.z()}};
}

ClosestPoint closest_of_few(const PolytopeDifference& difference, std::span<const DifferenceVertex> start,
                            double relative, const BracketWidth& width, std::int64_t& support_calls) {
  VertexPair first[4];
  for (std::size_t i = 0; i < start.size(); ++i) first[i] = {start[i].a, start[i].b};
  const NearestOfFew found =
      nearest_of_few(posed_few(difference), first, static_cast<int>(start.size()),
                     {kSearchGap * difference.reach(), std::numeric_limits<double>::infinity(), 0});
  support_calls += found.supports;
  return closest_point(difference, found, {distance_errors(difference).upper, kScannedPlaneError * difference.reach()},
                       relative, width);
}

std::optional<PlaneOfFew> plane_of_few(const PolytopeDifference& difference, const DifferenceVertex& first,
                                       double least, std::int64_t& support_calls) {
  const double error = kScannedPlaneError * difference.reach();
  const VertexPair start{first.a, first.b};
  const NearestOfFew found =
      nearest_of_few(posed_few(difference), &start, 1, {kSearchGap * difference.reach(), least + error, least});
  support_calls += found.supports;
  if (found.status != NearestOfFew::Status::beyond) return std::nullopt;
  return PlaneOfFew{{found.direction[0], found.direction[1], found.direction[2]},
                    found.height - error,
                    difference.vertex(found.support.a, found.support.b)};
}

ClosestPoint confirm_closest_point(const PolytopeDifference& difference, std::span<const VertexPair> simplex,
                                   double relative, const BracketWidth& width) {
  DifferenceVertex corners[3];
  const int count = static_cast<int>(simplex.size());
  difference.posed_vertices(simplex.data(), count, corners);
  LanePoint points[3];
  for (int i = 0; i < count; ++i) {
    points[i] = {corners[i].x.x(), corners[i].x.y(), corners[i].x.z(), corners[i].a, corners[i].b};
  }
  NearestOfFew found = nearest_on_simplex(points, count);
  const Vec3 direction(found.direction[0], found.direction[1], found.direction[2]);
  if (difference.climbs()) {
    for (int i = count; i < 3; ++i) corners[i] = corners[count - 1];
    DifferenceVertex s;
    if (!difference.confirm_support(direction, s, corners)) return {};
    found.height = -s.x.dot(direction);
  } else {
    const SupportOfFew s = support_of_few({arrays_of(difference.a()), arrays_of(difference.b()),
                                           difference.rotation_a().data(), difference.rotation_b().data()},
                                          found.direction);
    found.height = -((Vec3(s.on_b) - Vec3(s.on_a)) + difference.offset()).dot(direction);
  }
  return closest_point(difference, found, distance_errors(difference), relative, width);
}

}  // namespace pd::detail
