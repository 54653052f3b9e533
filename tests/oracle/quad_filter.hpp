/// @file
/// h_P(n) / |n| in quadruple precision, between certified bounds: tells directions apart that doubles cannot, before
/// exact fractions have to. Bodies whose every coordinate is off by an ulp or two have thousands of directions within
/// the error of doubles, and their exact comparison takes numbers of some 10,000 bits.
#pragma once

#include <optional>
#include <vector>

#include "oracle/exact_pair.hpp"

#ifndef __SIZEOF_FLOAT128__
#include <boost/multiprecision/cpp_bin_float.hpp>
#endif

namespace pd::oracle {

/// 113 bits, sums, products and quotients rounded to nearest, exponents down to 2^-16382: the compiler's own type,
/// where it has one.
#ifdef __SIZEOF_FLOAT128__
using Quad = __float128;
#else
using Quad = boost::multiprecision::cpp_bin_float_quad;
#endif

/// value * 2^exponent, truncated to 113 bits: relative error < 2^-112; zero where it is below 2^-300. Requires a result
/// below 2^400.
[[nodiscard]] Quad to_quad(const Integer& value, int exponent);

/// In the units of the filter, see `QuadFilter::unit_exponent`.
struct SquaredHeight {
  bool negative = false;  ///< h_P(n) < 0 for certain; the bounds say nothing then
  Quad lower = 0;         ///< lower <= (h_P(n) / |n|)^2 <= upper, or lower = 0 where the sign of h_P(n) is not known
  Quad upper = 0;
};

class QuadFilter {
 public:
  /// Refers to the pair.
  explicit QuadFilter(const ExactPair& pair);

  /// Bounds of the squared height of P in the direction n != 0, with `unit` the direction of n within 2^-49. Empty
  /// where the pair's coordinates are not of the size that the bounds rest on. Their distance is below 2^-99 (h +
  /// 2^-99) in units of the larger body, h the height.
  [[nodiscard]] std::optional<SquaredHeight> squared_height(const IVec& n, const Vec3& unit);

  /// A height in the filter's units is a height in the pair's integers times 2^-unit_exponent(): the bits of
  /// coordinates.
  [[nodiscard]] int unit_exponent() const { return unit_exponent_; }

 private:
  struct QVec {
    Quad x = 0;
    Quad y = 0;
    Quad z = 0;
  };
  static Quad dot(const QVec& v, const QVec& w) { return v.x * w.x + v.y * w.y + v.z * w.z; }
  [[nodiscard]] QVec scaled(const IVec& v);
  const QVec& point(bool of_b, int i);
  Quad largest_dot(bool of_b, const QVec& n, const Vec3& unit);

  const ExactPair& pair_;
  int unit_exponent_;
  bool in_range_ = true;
  QVec offset_;
  std::vector<QVec> points_[2];
  std::vector<char> known_[2];
  std::vector<int> near_;
};

}  // namespace pd::oracle
