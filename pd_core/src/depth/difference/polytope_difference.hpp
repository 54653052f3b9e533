/// @file
/// P = B + (-A) for two posed polytopes, as the hot path sees it: supports in doubles with stated error bounds.
///
/// Everything stays in the frame of the caller, with t_B - t_A taken first, so that errors scale with P and not with
/// the distance of the pair from the world's origin.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>

#include "numeric/instruction_sets.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/support/direction_table.hpp"
#include "shape/support/polytope_support.hpp"
#include "shape/support/posed_vertices.hpp"

namespace pd::detail {

/// A vertex of P with the ids of its two vertices.
struct DifferenceVertex {
  Vec3 x;          ///< b - a
  std::int32_t a;  ///< vertex of A, -1 for smooth bodies
  std::int32_t b;
};
static_assert(sizeof(DifferenceVertex) == 4 * sizeof(double));  // InnerSurface reads coordinates with this stride

/// The vertices of both bodies at their poses, where they are few enough to be scanned.
struct PosedVerticesPair {
  PosedVertices a;
  PosedVertices b;
};

class PolytopeDifference {
 public:
  /// Of supports it can `confirm` only, until `prepare_supports` is called.
  PolytopeDifference(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b)
      : a_(a),
        b_(b),
        rotation_a_(pose_a.rotation()),
        rotation_b_(pose_b.rotation()),
        offset_(pose_b.translation() - pose_a.translation()),
        reach_(a.radius() + b.radius() + offset_.norm()),
        normal_scale_(power_of_two_below(1 / (reach_ * reach_))),
        climbs_(a.num_vertices() > kScanLimit || b.num_vertices() > kScanLimit) {}

  /// Transforms the vertices, where supports scan them; done once. `posed` is a buffer; it must live as long as the
  /// difference and serve no other.
  void prepare_supports(PosedVerticesPair& posed) {
    if (climbs_ || posed_a_.count > 0) return;
    posed_a_ = posed.a.transform(a_, rotation_a_, -1);
    posed_b_ = posed.b.transform(b_, rotation_b_, 1);
  }

  /// A point of P that maximises <x, direction>, found from a vertex already at hand (`near`, or nullptr).
  [[nodiscard]] PD_INLINE DifferenceVertex support(const Vec3& direction, const DifferenceVertex* near) const {
    if (!climbs_) {
      const VertexPair farthest = farthest_vertices(posed_a_, posed_b_, direction.x(), direction.y(), direction.z());
      return vertex(farthest.a, farthest.b);
    }
    const Vec3 on_a = -(rotation_a_.transpose() * direction);
    const Vec3 on_b = rotation_b_.transpose() * direction;
    const int ia = support_vertex(a_, on_a, near ? near->a : -1);
    const int ib = support_vertex(b_, on_b, near ? near->b : -1);
    return vertex(ia, ib);
  }

  /// The same without transformed vertices: for a query of a few supports.
  [[nodiscard]] DifferenceVertex support_in_bodies(const Vec3& direction) const {
    return posed_vertex(support_vertex(a_, -(rotation_a_.transpose() * direction), -1),
                        support_vertex(b_, rotation_b_.transpose() * direction, -1));
  }

  /// The same up to single precision where it is found in a table: for an expansion, which checks what it inserts.
  /// @param normal  of a face of P, the product of two edges.
  [[nodiscard]] PD_INLINE DifferenceVertex search_support(const Vec3& normal) const {
    return climbs_ ? search_support_along(normal_scale_ * normal) : support(normal, nullptr);
  }
  /// @param direction  of a length that single precision can square.
  [[nodiscard]] PD_INLINE DifferenceVertex search_support_along(const Vec3& direction) const {
    if (!climbs_) return support(direction, nullptr);
    return vertex(search(a_, -(rotation_a_.transpose() * direction)), search(b_, rotation_b_.transpose() * direction));
  }

  /// Along four unit directions at once.
  void search_supports(const Vec3 (&directions)[4], DifferenceVertex (&supports)[4]) const {
    if (climbs_) {
      for (int k = 0; k < 4; ++k) supports[k] = search_support_along(directions[k]);
      return;
    }
    double by_coordinate[12];
    for (int k = 0; k < 12; ++k) by_coordinate[k] = directions[k % 4][k / 4];
    VertexPair pairs[4];
    farthest_in_four_directions(posed_a_, posed_b_, by_coordinate, pairs);
    for (int k = 0; k < 4; ++k) supports[k] = vertex(pairs[k].a, pairs[k].b);
  }

  [[nodiscard]] PD_INLINE DifferenceVertex vertex(int ia, int ib) const {
    if (!climbs_) {
      return {{(posed_b_.x[ib] + posed_a_.x[ia]) + offset_.x(), (posed_b_.y[ib] + posed_a_.y[ia]) + offset_.y(),
               (posed_b_.z[ib] + posed_a_.z[ia]) + offset_.z()},
              ia,
              ib};
    }
    return posed_vertex(ia, ib);
  }
  /// The same whether `prepare_supports` was called or not.
  [[nodiscard]] DifferenceVertex posed_vertex(int ia, int ib) const {
    return {(rotation_b_ * b_.vertex(ib) - rotation_a_ * a_.vertex(ia)) + offset_, ia, ib};
  }

  /// `posed_vertex` of many pairs of ids {a, b}.
  template <class Pair>
  void posed_vertices(const Pair* pairs, int count, DifferenceVertex* out) const {
    static_assert(sizeof(Pair) == 2 * sizeof(std::int32_t));
    PosedBodies bodies{arrays_of(a_), arrays_of(b_), {}, {}, {offset_.x(), offset_.y(), offset_.z()}};
    for (int i = 0; i < 9; ++i) {
      bodies.matrix_a[i] = rotation_a_(i / 3, i % 3);
      bodies.matrix_b[i] = rotation_b_(i / 3, i % 3);
    }
    pose_pairs(bodies, &pairs->a, count, out->x.data());
  }

  /// Whether one of the pairs of these corners is a support as `certified_support` returns it, found without a search:
  /// every edge of a body that leaves the corners' vertices must descend for certain.
  [[nodiscard]] bool confirm_support(const Vec3& direction, DifferenceVertex& s,
                                     const DifferenceVertex (&corners)[3]) const {
    const Vec3 on_a = -(rotation_a_.transpose() * direction);
    const Vec3 on_b = rotation_b_.transpose() * direction;
    const int ia = confirmed_support_vertex(a_, on_a, {corners[0].a, corners[1].a, corners[2].a});
    if (ia < 0) return false;
    const int ib = confirmed_support_vertex(b_, on_b, {corners[0].b, corners[1].b, corners[2].b});
    if (ib < 0) return false;
    s = posed_vertex(ia, ib);
    return true;
  }

  /// Replaces `s` by a maximiser within `support_error()` of the true one: a search may see single
  /// precision only, and a climb may stop on a nearly flat spot, so before a bound rests on it, the vertices joined to
  /// it by edges whose sign is in doubt are searched too (every edge that leaves that set descends for certain, so by
  /// convexity it holds the maximum).
  [[nodiscard]] DifferenceVertex certified_support(const Vec3& direction, const DifferenceVertex& s,
                                                   std::vector<std::int32_t>& stack) const {
    if (!climbs_) return s;  // scans have seen them all
    const Vec3 on_a = -(rotation_a_.transpose() * direction);
    const Vec3 on_b = rotation_b_.transpose() * direction;
    return vertex(certified_support_vertex(a_, on_a, s.a, stack), certified_support_vertex(b_, on_b, s.b, stack));
  }

  /// Whether a body has too many vertices to look at them all.
  [[nodiscard]] bool climbs() const { return climbs_; }
  [[nodiscard]] const ConvexPolytope& a() const { return a_; }
  [[nodiscard]] const ConvexPolytope& b() const { return b_; }
  [[nodiscard]] const Mat3& rotation_a() const { return rotation_a_; }
  [[nodiscard]] const Mat3& rotation_b() const { return rotation_b_; }
  /// t_B - t_A.
  [[nodiscard]] const Vec3& offset() const { return offset_; }
  /// The vertices of -A and of B, turned but not moved; only where neither body `climbs`.
  [[nodiscard]] const VertexArrays& posed_a() const { return posed_a_; }
  [[nodiscard]] const VertexArrays& posed_b() const { return posed_b_; }

  /// A point inside P, rounded.
  [[nodiscard]] Vec3 centre() const { return rotation_b_ * b_.centre() - rotation_a_ * a_.centre() + offset_; }
  /// At least |x| for every point of P.
  [[nodiscard]] double reach() const { return reach_; }
  /// |computed vertex - exact vertex| (Euclidean). Per coordinate: three products, two sums and the rounding of R for
  /// each body (4u of its radius), then two sums and the offset (2u of the reach): 6u reach; times sqrt(3).
  [[nodiscard]] double point_error() const { return kPointError * reach_; }
  /// h_P(n) / |n| exceeds <s, n> / |n| of a certified support s by at most this: twice the error of comparing two
  /// vertices, in a body's frame, where the rotated direction errs by 4u |n| and the product by 3u |n| |v|, or posed,
  /// where a vertex errs by 4u sqrt(3) |v| instead.
  [[nodiscard]] double support_error() const { return kSupportError * reach_; }
  static constexpr double kPointError = 10.5 * kUnitRoundoff;
  static constexpr double kSupportError = 20 * kUnitRoundoff;

 private:
  /// `x` without its mantissa: a factor that rounds nothing.
  [[nodiscard]] static double power_of_two_below(double x) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000);
  }
  [[nodiscard]] static int search(const ConvexPolytope& body, const Vec3& scaled) {
    return body.num_vertices() > kScanLimit ? farthest_in_table(body.storage(), scaled)
                                            : support_vertex(body, scaled, -1);
  }

  const ConvexPolytope& a_;
  const ConvexPolytope& b_;
  Mat3 rotation_a_;
  Mat3 rotation_b_;
  Vec3 offset_;
  double reach_;
  double normal_scale_;  ///< products of two edges become fit for single precision
  bool climbs_;
  VertexArrays posed_a_{};  ///< of -A, where supports are found by scans
  VertexArrays posed_b_{};
};

/// A face's distance errs by that of its points, of a product of three terms, and of a root and a quotient.
template <class Difference>
double face_error(const Difference& difference) {
  return difference.point_error() + 8 * kUnitRoundoff * difference.reach();
}
/// <s, unit> bounds h_P(unit) up to the errors of s, of the support, of the product and of |unit|.
template <class Difference>
double support_plane_error(const Difference& difference) {
  return difference.point_error() + difference.support_error() + 8 * kUnitRoundoff * difference.reach();
}

}  // namespace pd::detail
