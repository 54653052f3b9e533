/// @file
/// Exact predicates on the vectors that two posed polytopes define: points of P = B + (-A), edges of A, edges of B, and
/// differences of points of P.
///
/// Every such vector is R_B (b_to - b_from) - R_A (a_to - a_from), or for points of P with t_B - t_A added. Its stages:
/// 1. doubles with an error bound, 2. double-double with an error bound, 3. dyadic numbers on the stored input (a
/// quaternion's rotation is homogeneous: all vectors of a pair are multiplied by the same positive |q_A|^2 |q_B|^2).
/// Where no step of a vector rounds, in the bodies' own frame if that is one and the same, doubles serve as stage 3.
///
/// Inside, lengths are scaled by a power of two so that the largest coordinate of P is about 1: no stage over- or
/// underflows, and every decision obeys the law of powers of two. `scale_exponent` turns results back.
#pragma once

#include <cstdint>
#include <optional>

#include "numeric/dyadic.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/common_frame.hpp"
#include "shape/posed_rotation.hpp"
#include "shape/zero_pattern.hpp"

namespace pd::detail {

/// R_B (b_to - b_from) - R_A (a_to - a_from); -1 means "not there" (the origin of the local frame); `translated` adds
/// t_B - t_A.
struct PairVector {
  std::int32_t a_to = -1;
  std::int32_t a_from = -1;
  std::int32_t b_to = -1;
  std::int32_t b_from = -1;
  bool translated = false;

  /// The point v_b - v_a of P.
  static PairVector point(int a, int b) { return {a, -1, b, -1, true}; }
  /// From the point (a_from, b_from) of P to (a_to, b_to).
  static PairVector difference(int a_from, int b_from, int a_to, int b_to) {
    return {a_to, a_from, b_to, b_from, false};
  }
  /// R_A (v_to - v_from).
  static PairVector edge_a(int from, int to) { return {from, to, -1, -1, false}; }
  /// R_B (v_to - v_from).
  static PairVector edge_b(int from, int to) { return {-1, -1, to, from, false}; }
};

class PosedPair {
 public:
  /// Refers to the polytopes: they must outlive it. Points of P are taken relative to `origin` (exactly).
  PosedPair(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
            const Vec3& origin = Vec3::Zero());

  [[nodiscard]] const ConvexPolytope& a() const { return *a_; }
  [[nodiscard]] const ConvexPolytope& b() const { return *b_; }
  [[nodiscard]] const Pose& pose_a() const { return *pose_a_; }
  [[nodiscard]] const Pose& pose_b() const { return *pose_b_; }

  /// Lengths inside = lengths outside * 2^-scale_exponent.
  [[nodiscard]] int scale_exponent() const { return scale_exponent_; }
  /// 2^-scale_exponent and 2^scale_exponent.
  [[nodiscard]] double inwards() const { return scale_; }
  [[nodiscard]] double outwards() const { return outwards_; }

  /// R row by row, rounded; a matrix as it stands.
  [[nodiscard]] const double (&rotation_a() const)[9] { return body_a_.rotation; }
  [[nodiscard]] const double (&rotation_b() const)[9] { return body_b_.rotation; }

  /// The vector in doubles (scaled). |error| per coordinate <= vector_error().
  [[nodiscard]] Vec3 approximate(const PairVector& v) const;
  [[nodiscard]] double vector_error() const { return vector_error_; }
  /// The same for this vector: of one body alone, its size counts and not the pair's.
  [[nodiscard]] double vector_error(const PairVector& v) const { return error_of(v).rounded; }
  [[nodiscard]] double vector_error_dd(const PairVector& v) const { return error_of(v).fine; }

  /// In double-double (scaled). |error| per coordinate <= vector_error_dd().
  [[nodiscard]] Vec3DD approximate_dd(const PairVector& v) const {
    FourDoubleDoubles out;
    approximate_dd(v, out);
    return vector_of(out);
  }
  /// The same as lanes, the last of them 0.
  void approximate_dd(const PairVector& v, FourDoubleDoubles& out) const;
  /// What that adds up, for kernels that go on with the sum.
  [[nodiscard]] TurnedSum turned(const PairVector& v) const;
  [[nodiscard]] double vector_error_dd() const { return vector_error_dd_; }
  /// R_A^T x in double-double, each coordinate within 2^-100 of the sum of |x|.
  [[nodiscard]] Vec3DD in_frame_of_a(const Vec3DD& x) const;
  /// R_B^T x likewise.
  [[nodiscard]] Vec3DD in_frame_of_b(const Vec3DD& x) const;

  /// Both rotations, and the offset, are stored as doubles: coordinates may be exact in double-double.
  [[nodiscard]] bool doubles_rotate() const { return doubles_rotate_; }
  /// A coordinate itself, where both bodies have it as their own, or where `doubles_rotate`, and double-double holds
  /// it.
  /// @return whether that is so.
  [[nodiscard]] bool exact_coordinate(const PairVector& v, int k, DoubleDouble& out) const;
  /// A coordinate of a body's turned vertices that is one of their own or its opposite: along the axis of a turn, say.
  struct OwnCoordinate {
    const double* x = nullptr;  ///< of the body's vertices; null: there is none
    double sign = 1;
    int axis = -1;  ///< of the body
  };
  /// Whether both bodies have coordinate k as their own, and any or all three.
  [[nodiscard]] bool has_own_coordinate(int k) const { return own_a_[k].x != nullptr && own_b_[k].x != nullptr; }
  [[nodiscard]] bool has_an_own_coordinate() const {
    return has_own_coordinate(0) || has_own_coordinate(1) || has_own_coordinate(2);
  }
  [[nodiscard]] const OwnCoordinate& own_coordinate_a(int k) const { return own_a_[k]; }
  [[nodiscard]] const OwnCoordinate& own_coordinate_b(int k) const { return own_b_[k]; }
  /// t_B - t_A - origin (scaled), rounded; as it is where `doubles_rotate`.
  [[nodiscard]] const Vec3& offset() const { return offset_; }
  /// Whether the bodies' origins are one point, which is the origin, exactly.
  [[nodiscard]] bool at_one_place() const {
    return origin_.isZero(0) && pose_a_->translation() == pose_b_->translation();
  }
  /// Whether R_B = R_A Q for a Q that exchanges and reverses axes, exactly.
  [[nodiscard]] bool in_one_frame() const { return exchange_.has_value(); }
  /// Whether R_A = R_B, exactly.
  [[nodiscard]] bool same_rotation() const { return exchange_ && exchange_->is_identity(); }

  /// The exact vector times homogeneous_factor() > 0, unscaled.
  [[nodiscard]] Dyadic3 exact(const PairVector& v) const;
  /// |q_A|^2 |q_B|^2, with 1 in the place of a pose given as a matrix.
  [[nodiscard]] const Dyadic& homogeneous_factor() const;

  /// Sign of det(u, v, w) = <u, v x w>, exact.
  [[nodiscard]] int sign_determinant(const PairVector& u, const PairVector& v, const PairVector& w) const;
  /// The same where it is told without `exact`; none: stage 3 must, for callers that have exact vectors at hand.
  [[nodiscard]] std::optional<int> sign_determinant_rounded(const PairVector& u, const PairVector& v,
                                                            const PairVector& w) const;
  /// Whether det(u, v, w) = 0 by the zeros among the stored numbers alone (`zero_pattern.hpp`).
  [[nodiscard]] bool vanishes_term_by_term(const PairVector& u, const PairVector& v, const PairVector& w) const {
    return detail::vanishes_term_by_term(zero_coordinates(u), zero_coordinates(v), zero_coordinates(w));
  }
  /// Sign of <u, v>, exact.
  [[nodiscard]] int sign_dot(const PairVector& u, const PairVector& v) const;
  /// True when u x v = 0 exactly.
  [[nodiscard]] bool parallel(const PairVector& u, const PairVector& v) const;

  /// Which of the three stages decided how often, since construction.
  struct StageCounts {
    std::int64_t filtered = 0;
    std::int64_t double_double = 0;
    std::int64_t exact = 0;
  };
  [[nodiscard]] const StageCounts& stages() const { return stages_; }
  /// What `exact` was asked for, since construction: the squares of the lengths of its vectors in words of 64 bits, as
  /// products of them cost. 4 to 16 a vector of ordinary coordinates, some 1,000 where they span 600 decades.
  [[nodiscard]] std::int64_t exact_work() const { return exact_work_; }

 private:
  /// |error| of each coordinate of a vector in doubles and in double-double.
  struct VectorError {
    double rounded = 0;
    double fine = 0;
  };
  struct Body {
    double rotation[9];  ///< R row by row, rounded from the exact rational when a quaternion
    ColumnsDD columns;   ///< of R, in double-double
    VectorError error;   ///< of vectors of this body alone
  };
  [[nodiscard]] VectorError error_of(const PairVector& v) const {
    if (!v.translated && v.b_to < 0 && v.b_from < 0) return body_a_.error;
    if (!v.translated && v.a_to < 0 && v.a_from < 0) return body_b_.error;
    return {vector_error_, vector_error_dd_};
  }
  /// Exact numbers, which most pairs never ask for.
  struct ExactPlacing {
    Dyadic rotation_a[9];  ///< numerators over the common denominator of the pair
    Dyadic rotation_b[9];
    Dyadic homogeneous_factor;
    Dyadic3 offset;
  };
  const ExactPlacing& exact_placing() const;
  /// R^-1 times the vectors, for one rotation R of all of them (the identity in the common frame), where no step
  /// rounds.
  template <int N>
  [[nodiscard]] bool unrounded(const PairVector* const (&vectors)[N], Vec3 (&out)[N]) const;
  /// @param turn_a, turn_b  row by row; null for none.
  [[nodiscard]] bool unrounded(const PairVector& v, const double* turn_a, const double* turn_b, Vec3& out) const;
  /// What B's vectors are turned by in A's frame; null for none.
  [[nodiscard]] const double* turn_into_frame_of_a() const {
    return exchange_ && !exchange_->is_identity() ? exchange_matrix_ : nullptr;
  }
  /// Bit k: coordinate k is zero, read off the stored numbers; in the common frame, where there is one.
  [[nodiscard]] std::uint32_t zero_coordinates(const PairVector& v) const;
  /// The sign of the determinant of three vectors of one body each, as differences of stored coordinates: in the frame
  /// of a rotation that all share, or where both rotations do no more than exchange and reverse axes.
  [[nodiscard]] std::optional<int> sign_by_differences(const PairVector* const (&vectors)[3]) const;
  /// The same in dyadic numbers, of vectors of either body or both, where one rotation turns them all: without it they
  /// are short.
  [[nodiscard]] std::optional<int> sign_in_one_frame(const PairVector* const (&vectors)[3]) const;

  const ConvexPolytope* a_;
  const ConvexPolytope* b_;
  const Pose* pose_a_;
  const Pose* pose_b_;
  int scale_exponent_ = 0;
  double scale_ = 1;  ///< 2^-scale_exponent_
  double outwards_ = 1;
  double vector_error_ = 0;
  double vector_error_dd_ = 0;
  Body body_a_;
  Body body_b_;
  Vec3 origin_;
  Vec3 offset_;  ///< (t_B - t_A - origin) scaled, rounded
  FourDoubleDoubles offset_dd_;
  bool doubles_rotate_ = false;  ///< both rotations, and the offset, are stored as doubles, exactly
  OwnCoordinate own_a_[3];
  OwnCoordinate own_b_[3];
  bool all_own_coordinates_ = false;      ///< of both bodies, and `doubles_rotate_`
  std::optional<AxisExchange> exchange_;  ///< R_B = R_A Q, exactly: A's frame is that of both
  double exchange_matrix_[9];             ///< Q, where it is no identity
  std::uint32_t zeros_a_ = 0;  ///< entries of the rotations that are zero (`zero_entries`), in the frame of both
  std::uint32_t zeros_b_ = 0;
  mutable std::optional<ExactPlacing> exact_;
  mutable StageCounts stages_;
  mutable std::int64_t exact_work_ = 0;
};

}  // namespace pd::detail
