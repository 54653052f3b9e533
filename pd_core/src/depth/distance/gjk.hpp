/// @file
/// The point of P nearest to the origin in doubles, with a certified bracket of the distance.
///
/// Gilbert, Johnson, Keerthi 1988. The upper bound is the length of a convex combination of points of P, the lower
/// bound the height of a supporting plane: <s, v> / |v| for the support s against v. Where rounding stops progress
/// before the bracket is as narrow as asked, exact arithmetic takes over, or double-double (gjk_double_double.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "depth/difference/bracket_width.hpp"
#include "depth/difference/polytope_difference.hpp"

namespace pd::detail {

struct ClosestPoint {
  bool certified = false;  ///< the bracket is as narrow as asked and lower > 0
  double lower = 0;
  double upper = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< unit; certified: the plane of `lower`, every point of P has <x, normal> <= -lower
  int count = 0;
  DifferenceVertex simplex[4];
  double weights[4];
};

/// Reduces the simplex to the face that holds its point nearest to the origin; returns that point. Weights sum to 1.
/// `planar`: the four points lie in one plane, where a tetrahedron would be noise.
Vec3 closest_point_on_simplex(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4], bool planar = false);

/// The same among the faces that hold the last of two to four points: all that can be nearer where the others are such
/// a face, and a point to go on from in any case.
Vec3 closest_point_with_newest(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4]);

/// The direction to look for a support in: the opposite of the nearest point of the simplex, or of a triangle's plane.
///
/// The point errs by u times the reach, so that its direction errs by u reach / distance and the support there by
/// u reach^2 / distance: a body on a wide floor would never be certified. A triangle's own normal knows no distance; as
/// any unit direction gives a valid bound, it is taken wherever it is that direction but for the point's rounding.
/// @param noise  of the point's coordinates, with something to spare: witnesses along the normal keep to it.
inline Vec3 search_direction(const DifferenceVertex (&simplex)[4], int count, const Vec3& point, double length,
                             double noise) {
  const Vec3 toward = -point / length;
  if (count != 3) return toward;
  const Vec3 n = (simplex[1].x - simplex[0].x).cross(simplex[2].x - simplex[0].x);
  const double size = n.norm();
  if (!(size > 0)) return toward;
  const Vec3 unit = n / (n.dot(toward) < 0 ? -size : size);
  return (unit - toward).norm() <= std::min(0x1p-20, noise / length) ? unit : toward;
}

/// What rounding may make of a bracket's ends.
struct DistanceErrors {
  double upper;  ///< of the length of a point of P
  double lower;  ///< of the height of a certified support
};
template <class Difference>
DistanceErrors distance_errors(const Difference& difference) {
  const double rounding = 8 * kUnitRoundoff * difference.reach();
  const double upper = difference.point_error() + rounding;
  return {upper, upper + difference.support_error()};
}

/// @param start     one to four vertices of P to begin with; of four, the last is the nearest to a separating plane.
/// @param relative  stop when upper <= (1 + relative) lower, both less `width.margin` ...
/// @param width     ... or upper - lower is within it, by the largest |coordinate| seen.
template <class Difference>
ClosestPoint closest_point(const Difference& difference, std::span<const DifferenceVertex> start, double relative,
                           const BracketWidth& width, std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  ClosestPoint r;
  for (const DifferenceVertex& v : start) r.simplex[r.count++] = v;
  r.point = r.count < 4 ? closest_point_on_simplex(r.simplex, r.count, r.weights)
                        : closest_point_with_newest(r.simplex, r.count, r.weights);
  const DistanceErrors error = distance_errors(difference);
  double length = r.point.norm();
  double largest = 0;
  for (const DifferenceVertex& v : start) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
  // What is near the origin says little about L; P's centre says more, and P's far side, which takes a support, all.
  bool seen_far_side = false;
  for (;;) {
    r.upper = length + error.upper;
    if (!(length > 4 * error.lower)) return r;
    const Vec3 toward = search_direction(r.simplex, r.count, r.point, length, 6 * error.upper);
    DifferenceVertex s = difference.support(toward, &r.simplex[r.count - 1]);
    ++support_calls;
    largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
    double height = -s.x.dot(toward);
    const auto narrow_for = [&](double size) {
      r.lower = height - error.lower;
      return r.lower > 0 && (r.upper - r.lower <= width.limit(size) || width.is_within(relative, r.lower, r.upper));
    };
    if (!seen_far_side && !narrow_for(largest) && narrow_for(difference.reach())) {
      const Vec3 centre = difference.centre();
      largest = std::max(largest, centre.cwiseAbs().maxCoeff());
      if (!narrow_for(largest)) {
        const DifferenceVertex far = difference.support(centre, nullptr);
        ++support_calls;
        largest = std::max(largest, far.x.cwiseAbs().maxCoeff());
        seen_far_side = true;
      }
    }
    if (narrow_for(largest)) {
      s = difference.certified_support(toward, s, stack);
      height = -s.x.dot(toward);
      if (narrow_for(largest)) {
        r.certified = true;
        r.normal = toward;
        return r;
      }
    }
    for (int i = 0; i < r.count; ++i) {
      if (r.simplex[i].a == s.a && r.simplex[i].b == s.b) return r;  // nothing new: rounding has the last word
    }
    DifferenceVertex simplex[4] = {r.simplex[0], r.simplex[1], r.simplex[2], r.simplex[3]};
    double weights[4];
    int count = r.count;
    simplex[count++] = s;
    const Vec3 point = closest_point_with_newest(simplex, count, weights);
    const double next_length = point.norm();
    // Nearly equal supports: rounding has lost the closest point.
    if (count < 4 && !(next_length < length)) return r;
    std::copy_n(simplex, count, r.simplex);
    std::copy_n(weights, count, r.weights);
    r.count = count;
    r.point = point;
    length = next_length;
    if (count == 4) return r;
  }
}

}  // namespace pd::detail
