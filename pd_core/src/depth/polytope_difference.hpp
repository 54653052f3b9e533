/// @file
/// P = B + (-A) for two posed polytopes, as the hot path sees it: supports in doubles with stated error bounds.
///
/// Everything stays in the frame of the caller, with t_B - t_A taken first, so that errors scale with P and not with
/// the distance of the pair from the world's origin.
#pragma once

#include <algorithm>
#include <cmath>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/polytope_support.hpp"

namespace pd::detail {

/// A vertex of P with the ids of its two vertices.
struct DifferenceVertex {
  Vec3 x;          ///< b - a
  std::int32_t a;  ///< vertex of A, -1 for smooth bodies
  std::int32_t b;
};

class PolytopeDifference {
 public:
  /// Supports are vertices with ids of their own (not points of curved surfaces).
  static constexpr bool kAnalytic = false;

  PolytopeDifference(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b)
      : a_(a),
        b_(b),
        rotation_a_(pose_a.rotation()),
        rotation_b_(pose_b.rotation()),
        offset_(pose_b.translation() - pose_a.translation()),
        reach_(a.radius() + b.radius() + offset_.norm()) {}

  /// A point of P that maximises <x, direction>, found from a vertex already at hand (`near`, or nullptr).
  [[nodiscard]] DifferenceVertex support(const Vec3& direction, const DifferenceVertex* near) const {
    const Vec3 on_a = -(rotation_a_.transpose() * direction);
    const Vec3 on_b = rotation_b_.transpose() * direction;
    const int ia = support_vertex(a_, on_a, near ? near->a : -1);
    const int ib = support_vertex(b_, on_b, near ? near->b : -1);
    return vertex(ia, ib);
  }

  /// Whether `support` makes use of a vertex at hand.
  [[nodiscard]] bool climbs() const { return a_.num_vertices() > kScanLimit || b_.num_vertices() > kScanLimit; }

  [[nodiscard]] DifferenceVertex vertex(int ia, int ib) const {
    return {(rotation_b_ * b_.vertex(ib) - rotation_a_ * a_.vertex(ia)) + offset_, ia, ib};
  }

  /// Replaces `s` by a maximiser within `support_error()` of the true one: hill climbing compares neighbours in doubles
  /// and may stop on a nearly flat spot, so before a bound rests on it, the vertices joined to it by edges whose sign
  /// is in doubt are searched too (every edge that leaves that set descends for certain, so by convexity it holds the
  /// maximum).
  [[nodiscard]] DifferenceVertex certified_support(const Vec3& direction, const DifferenceVertex& s,
                                                   std::vector<std::int32_t>& stack) const {
    const Vec3 on_a = -(rotation_a_.transpose() * direction);
    const Vec3 on_b = rotation_b_.transpose() * direction;
    return vertex(certified_support_vertex(a_, on_a, s.a, stack), certified_support_vertex(b_, on_b, s.b, stack));
  }

  /// A point inside P, rounded.
  [[nodiscard]] Vec3 centre() const { return rotation_b_ * b_.centre() - rotation_a_ * a_.centre() + offset_; }
  /// At least |x| for every point of P.
  [[nodiscard]] double reach() const { return reach_; }
  /// |computed vertex - exact vertex| (Euclidean). Per coordinate: three products, two sums and the rounding of R for
  /// each body (4u of its radius), then two sums and the offset (2u of the reach): 6u reach; times sqrt(3).
  [[nodiscard]] double point_error() const { return 10.5 * kHalfUlp * reach_; }
  /// h_P(n) / |n| exceeds <s, n> / |n| of a certified support s by at most this: twice the error of comparing two
  /// vertices in a body's frame, where the rotated direction errs by 4u |n| and the product by 3u |n| |v|.
  [[nodiscard]] double support_error() const { return 14 * kHalfUlp * reach_; }

  [[nodiscard]] int budget() const {
    return 64 + 4 * static_cast<int>(std::sqrt(static_cast<double>(a_.num_vertices() + b_.num_vertices())));
  }

  static constexpr double kHalfUlp = 0x1p-53;

 private:
  const ConvexPolytope& a_;
  const ConvexPolytope& b_;
  Mat3 rotation_a_;
  Mat3 rotation_b_;
  Vec3 offset_;
  double reach_;
};

}  // namespace pd::detail
