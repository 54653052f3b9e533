/// @file
/// The nearest points of two segments or points in closed form, and how far apart that proves two bodies to be: the
/// segments themselves, or a segment and a box that has the other one as an edge.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "depth/difference/bracket_width.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/feature.hpp"

namespace pd::detail {

/// A point of P errs by 11u of the reach (`PolytopeDifference::point_error`), its length or height along a unit vector
/// by 6u more.
inline constexpr double kPointError = 20 * kUnitRoundoff;
/// The height of a box along a unit vector errs by 8u of its radius in its three products, 8u in their sum and 4u in
/// its centre and half extents; the rest is as above.
inline constexpr double kBoxPointError = 40 * kUnitRoundoff;
/// Squares of squares of lengths within it are ordinary numbers.
inline constexpr double kLeastReach = 0x1p-100, kLargestReach = 0x1p100;

/// A segment or point at its pose, relative to its body's translation.
struct PosedSegment {
  Vec3 start;
  Vec3 along = Vec3::Zero();
  std::int32_t first;   ///< vertex
  std::int32_t second;  ///< the same one: a point

  PosedSegment(const ConvexPolytope& body, const Mat3& rotation)
      : PosedSegment(body, rotation, 0, body.num_vertices() - 1) {}
  PosedSegment(const ConvexPolytope& body, const Mat3& rotation, std::int32_t from, std::int32_t to)
      : start(rotation * body.vertex(from)), first(from), second(to) {
    if (!is_point()) along = rotation * body.vertex(to) - start;
  }
  [[nodiscard]] bool is_point() const { return first == second; }
  [[nodiscard]] Vec3 at(double share) const { return start + share * along; }
  [[nodiscard]] Feature feature(double share) const {
    if (share <= 0) return {Feature::Kind::vertex, first, -1};
    if (share >= 1) return {Feature::Kind::vertex, second, -1};
    return {Feature::Kind::edge, first, second};
  }
};

inline double share_of(double along, double squared) {
  return squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
}

/// How far along A and along B their nearest points lie, from 0 to 1 (Ericson, Real-Time Collision Detection, 5.1.9).
struct NearestShares {
  double a = 0;
  double b = 0;
};
inline NearestShares nearest_shares(const PosedSegment& a, const PosedSegment& b, const Vec3& between) {
  const double of_a = a.along.squaredNorm(), of_b = b.along.squaredNorm();
  const double toward_a = a.along.dot(between), toward_b = -b.along.dot(between);
  if (a.is_point()) return {0, share_of(toward_b, of_b)};
  if (b.is_point()) return {share_of(toward_a, of_a), 0};
  const double both = a.along.dot(b.along);
  // |e x f|^2, without the cancellation of |e|^2 |f|^2 - <e, f>^2.
  const double squared_sine = a.along.cross(b.along).squaredNorm();
  NearestShares share;
  share.a = share_of(toward_a * of_b + toward_b * both, squared_sine);
  share.b = share_of(both * share.a + toward_b, of_b);
  share.a = share_of(both * share.b + toward_a, of_a);
  return share;
}

/// The whole of the box that B's segment is a part of.
struct PosedBox {
  Vec3 centre;  ///< relative to its translation
  Mat3 halves;  ///< columns from the centre to the middles of three faces

  /// Of its points, how far they lie along `unit` from `start`: the least.
  [[nodiscard]] double least(const Vec3& unit, const Vec3& start) const {
    return (centre - start).dot(unit) - (halves.transpose() * unit).cwiseAbs().sum();
  }
  /// The largest |coordinate| of its points less those of a segment, whose middle lies at `start` - `between`.
  [[nodiscard]] double farthest(const Vec3& start, const Vec3& between, const Vec3& along) const {
    const Vec3 middles = between + (centre - start);
    return (middles.cwiseAbs() + halves.cwiseAbs().rowwise().sum() + 0.5 * along.cwiseAbs()).maxCoeff();
  }
};

/// The distance of two segments, or of a segment and a box that has the other one as its edge.
class NearestOfSegments {
 public:
  /// @param offset  from A's translation to B's. @param reach  >= |b - a| for all points of both bodies.
  NearestOfSegments(const PosedSegment& a, const PosedSegment& b, const Vec3& offset, double reach)
      : a_(a), b_(b), reach_(reach), between_(b_.start - a_.start + offset), share_(nearest_shares(a_, b_, between_)) {}
  /// B's segment is an edge, or a corner, of this box.
  void set_box(const PosedBox& box) { box_ = &box; }

  /// False where the bracket of the cores' distance is wider than asked, or may hold 0.
  bool bracket_distance(const BracketWidth& width) {
    if (!(reach_ > kLeastReach && reach_ < kLargestReach)) return false;
    const Vec3 nearest = between_ + (share_.b * b_.along - share_.a * a_.along);
    const double length = nearest.norm();
    const double error = (box_ == nullptr ? kPointError : kBoxPointError) * reach_;
    if (!(length > 4 * error)) return false;
    upper = length + kPointError * reach_;
    bound_below(nearest / length, error);
    const Vec3 other = between_ + b_.along - a_.along, one = between_ + b_.along, two = between_ - a_.along;
    double largest = std::max({between_.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff(), one.cwiseAbs().maxCoeff(),
                               two.cwiseAbs().maxCoeff()});
    if (box_ != nullptr) largest = std::max(largest, box_->farthest(b_.start, between_ - 0.5 * a_.along, a_.along));
    const double limit = width.limit(largest);
    const auto narrow = [&] { return lower > 0 && upper - lower <= limit; };
    if (narrow()) return true;
    // Close to each other: the point's own direction errs by u reach / distance, one across the segments does not.
    const Vec3 across = a_.along.cross(b_.along);
    if (across.squaredNorm() > 0) bound_below(facing(across, nearest), error);
    if (!narrow() && is_inner(share_.a)) bound_below(facing(across_one(nearest, a_.along), nearest), error);
    if (!narrow() && is_inner(share_.b)) bound_below(facing(across_one(nearest, b_.along), nearest), error);
    return narrow();
  }

  double lower = -std::numeric_limits<double>::infinity();
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< P lies below -lower along it

  [[nodiscard]] Vec3 point_a() const { return a_.at(share_.a); }
  [[nodiscard]] Vec3 point_b() const { return b_.at(share_.b); }
  [[nodiscard]] Feature feature_a() const { return a_.is_point() ? a_.feature(0) : a_.feature(share_.a); }
  [[nodiscard]] Feature feature_b() const { return b_.is_point() ? b_.feature(0) : b_.feature(share_.b); }

 private:
  static bool is_inner(double share) { return share > 0 && share < 1; }
  static Vec3 facing(const Vec3& direction, const Vec3& point) {
    return direction / (direction.dot(point) < 0 ? -direction.norm() : direction.norm());
  }
  static Vec3 across_one(const Vec3& point, const Vec3& along) {
    return point - (point.dot(along) / along.squaredNorm()) * along;
  }

  /// By the least height of P's corners along `unit`.
  void bound_below(const Vec3& unit, double error) {
    const double of_b = box_ == nullptr ? std::min(0.0, b_.along.dot(unit)) : box_->least(unit, b_.start);
    const double least = between_.dot(unit) + of_b - std::max(0.0, a_.along.dot(unit));
    if (least - error <= lower) return;
    lower = least - error;
    normal = -unit;
  }

  PosedSegment a_;
  PosedSegment b_;
  double reach_;
  Vec3 between_;  ///< from A's first vertex to B's
  NearestShares share_;
  const PosedBox* box_ = nullptr;
};

}  // namespace pd::detail
