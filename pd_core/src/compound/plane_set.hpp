/// @file
/// Planes {x : <n, x> = d} known exactly, and the exact side on which points defined by them lie.
///
/// A plane is kept as four integers without a common divisor, first nonzero coefficient positive, so that two planes
/// are one exactly when they have one number; aligned bodies have small coefficients however they were posed. A
/// `Side` is a plane with the direction in which it looks outwards. Every sign is decided in doubles with a bound
/// first, then in double-double; so is every point.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// A plane with an orientation; its halfspace is {x : <n, x> <= d} for the oriented n and d.
class Side {
 public:
  Side() = default;
  Side(std::int32_t plane, bool flipped) : code_(flipped ? ~plane : plane) {}
  [[nodiscard]] std::int32_t plane() const { return code_ < 0 ? ~code_ : code_; }
  [[nodiscard]] bool flipped() const { return code_ < 0; }
  [[nodiscard]] int orientation() const { return code_ < 0 ? -1 : 1; }
  [[nodiscard]] Side opposite() const { return Side(plane(), !flipped()); }
  friend bool operator==(const Side&, const Side&) = default;

 private:
  std::int32_t code_ = 0;
};

/// A point t d on the ray from the origin along d: t = numerator / denominator > 0 or 0.
struct RayParameter {
  Dyadic numerator;
  Dyadic denominator;
  /// Sign of t - other.
  [[nodiscard]] int compare(const RayParameter& other) const {
    return (numerator * other.denominator - other.numerator * denominator).sign();
  }
};

class PlaneSet {
 public:
  using Integer = Dyadic::Integer;

  /// Lengths inside = lengths outside * 2^-scale_exponent; choose it so that the largest coordinate is near 1.
  explicit PlaneSet(int scale_exponent) : scale_exponent_(scale_exponent) {}

  /// The plane <normal, x> = offset (outside lengths), looking along `normal`. Requires normal != 0.
  Side add(const Dyadic3& normal, const Dyadic& offset);

  /// Outward normal in doubles (not unit), each coordinate within two ulp.
  [[nodiscard]] Vec3 normal(Side s) const { return s.orientation() * planes_[index(s)].normal; }
  /// d for that normal, within two ulp.
  [[nodiscard]] double offset(Side s) const { return s.orientation() * planes_[index(s)].offset; }
  /// 1 / |normal|.
  [[nodiscard]] double inverse_length(Side s) const { return planes_[index(s)].inverse_length; }
  /// Signed distance of x from the plane (inside lengths), error about 8u (|x| + 1).
  [[nodiscard]] double height(Side s, const Vec3& x) const {
    return (normal(s).dot(x) - offset(s)) * inverse_length(s);
  }
  /// d / |n| exactly: the square of the origin's distance is offset^2 / normal_squared.
  [[nodiscard]] Dyadic exact_offset(Side s) const;
  [[nodiscard]] Dyadic3 exact_normal(Side s) const;

  /// Side of the point where planes f, q, r meet: the sign of <n_h, x> - d_h. Requires det(n_f, n_q, n_r) > 0.
  [[nodiscard]] int sign_at_meet(Side f, Side q, Side r, Side h) const;
  /// Sign of <n_h, x> - d_h for a point given in doubles (inside lengths).
  [[nodiscard]] int sign_at_point(Side h, const Vec3& x) const;
  /// Sign of <n_h, t d> - d_h; d in doubles.
  [[nodiscard]] int sign_on_ray(Side h, const Dyadic3& direction, const RayParameter& t) const;

  /// The point where three planes meet, in doubles (inside lengths), and a bound of each coordinate's error.
  struct Point {
    Vec3 x;
    double error;
  };
  [[nodiscard]] Point meet(Side f, Side q, Side r) const;

  /// The same exactly: numerator / denominator, denominator > 0 where det(n_f, n_q, n_r) is.
  struct ExactPoint {
    Dyadic3 numerator;
    Dyadic denominator;
  };
  [[nodiscard]] ExactPoint exact_meet(Side f, Side q, Side r) const;

  /// How many signs doubles left open.
  [[nodiscard]] std::int64_t exact_signs() const { return exact_signs_; }

 private:
  struct Plane {
    std::array<Integer, 4> exact;  ///< n and d without a common divisor
    Vec3 normal;
    double offset;
    double inverse_length;
    Vec3DD finer_normal;  ///< each coefficient within kUdd
    DoubleDouble finer_offset;
  };
  static std::size_t index(Side s) { return static_cast<std::size_t>(s.plane()); }

  int scale_exponent_;
  std::vector<Plane> planes_;
  std::map<std::array<Integer, 4>, std::int32_t> numbers_;
  mutable std::int64_t exact_signs_ = 0;
};

}  // namespace pd::detail
