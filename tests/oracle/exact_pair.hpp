/// @file
/// Two bodies where they stand, in exact integers: every posed point is R p + t on the stored numbers, all of them
/// multiplied by one positive weight (a quaternion's rotation is homogeneous(q) / |q|^2) and one power of two.
#pragma once

#include <vector>

#include "oracle/body.hpp"
#include "pd/shape/pose.hpp"

namespace pd::oracle {

/// Points of A are relative to A's posed reference, points of B to B's; `offset` is B's reference less A's. P = B +
/// (-A) = {offset + b - a}. Exact length = integer length * 2^exponent / weight.
class ExactPair {
 public:
  /// Refers to the bodies. A is first moved by `move_a`, exactly.
  ExactPair(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, const Vec3& move_a = Vec3::Zero());

  [[nodiscard]] const Body& a() const { return *sides_[0].body; }
  [[nodiscard]] const Body& b() const { return *sides_[1].body; }

  /// Exact posed points (computed on demand, kept).
  [[nodiscard]] const IVec& point_a(int i) const { return point(sides_[0], i); }
  [[nodiscard]] const IVec& point_b(int i) const { return point(sides_[1], i); }
  [[nodiscard]] const IVec& offset() const { return offset_; }
  [[nodiscard]] int exponent() const { return exponent_; }
  [[nodiscard]] const Scaled& weight() const { return weight_; }
  /// A vector in world units (a witness, a translation) in the integers of this pair is v * scale * 2^-exponent *
  /// weight; this gives numerators at a finer power of two: v * weight = result * 2^exponent_out.
  [[nodiscard]] ExactLength length(const Integer& numerator_squared, const Integer& denominator) const;

  /// The same in doubles, in true units times 2^-scale(): every coordinate errs by at most 2^-48 of the magnitude of
  /// its body.
  struct Rounded {
    std::vector<double> x, y, z;  ///< [vertices of the body], padded to a multiple of 8 with copies of the first
    std::vector<Vec3> edge_units;
    std::vector<Vec3> facet_normals;  ///< outward, unit
    double magnitude = 0;
  };
  [[nodiscard]] const Rounded& rounded_a() const { return sides_[0].rounded; }
  [[nodiscard]] const Rounded& rounded_b() const { return sides_[1].rounded; }
  [[nodiscard]] const Vec3& rounded_offset() const { return rounded_offset_; }
  [[nodiscard]] int scale() const { return scale_; }
  /// Sum of the magnitudes of A, B and the offset.
  [[nodiscard]] double magnitude() const { return magnitude_; }

  /// The whole of P lies in a plane (decided exactly).
  [[nodiscard]] bool flat_difference() const;

  /// Value of h_P(n) = max <p, n> over P in doubles; error <= 2^-44 * magnitude() for |n| = 1, plus what n itself errs.
  [[nodiscard]] double support(const Vec3& n) const;
  /// Exact h_P(n), with `unit` the direction of n within 2^-49.
  [[nodiscard]] Integer exact_support(const IVec& n, const Vec3& unit) const;
  /// Points that may be extreme in the direction `unit` (within the error, and `slack` more).
  void near_support(bool of_b, const Vec3& unit, double slack, std::vector<int>& result) const;

 private:
  struct Side {
    const Body* body = nullptr;
    Integer map[3][3];
    mutable std::vector<IVec> points;
    mutable std::vector<char> known;
    Rounded rounded;
  };
  const IVec& point(const Side& side, int i) const;
  /// The side's body in doubles, turned by `rotation`, in units of 2^scale().
  void round_side(Side& side, const Mat3& rotation);

  Side sides_[2];
  IVec offset_;
  int exponent_ = 0;
  Scaled weight_;
  Vec3 rounded_offset_;
  int scale_ = 0;
  double magnitude_ = 0;
};

}  // namespace pd::oracle
