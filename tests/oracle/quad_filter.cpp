#include "oracle/quad_filter.hpp"

#include <algorithm>
#include <cmath>

namespace pd::oracle {

namespace {

/// What the proof below asks of every coordinate of a point and of the offset, in the filter's units.
constexpr double kLargest = 4;

/// Error of a support as computed, with u = 2^-113.
/// - n is brought to a largest component in [1, 2), so that 1 <= |n| < 2 sqrt 3 < 3.5. Truncated to 113 bits each
///   component errs by less than 2 u of itself, or by 2^-300 where it is flushed: |dn| <= 2.1 u |n| < 7.4 u.
/// - w is a point or the offset, |w| <= 4 sqrt 3 < 7; likewise |dw| <= 2.1 u |w| < 14.8 u.
/// - A dot product errs by 3.1 u |w| |n| < 76 u for its products and sums, |dw| |n| < 52 u for what w errs and
///   |w| |dn| < 52 u for what n errs: less than 181 u, second orders included. The largest of several errs by no more.
/// - h is a sum of three of them, 543 u, each below 24.5, whose sums, below 49 and 73.5, are rounded: 123 u more.
/// Less than 666 u. The test's sample reaches 8 u.
constexpr double kSupportError = 0x1.5p-104;  // 672 u

/// Relative error of the bounds but for that: |n|^2 as computed errs by 3.1 u for its roundings and twice 2.1 u for
/// what n errs; h -+ the error by u, its square by twice that and u, the quotient and the last product by u each. Less
/// than 13 u.
constexpr double kRatioError = 0x1p-108;  // 32 u

}  // namespace

Quad to_quad(const Integer& value, int exponent) {
  if (value.is_zero()) return 0;
  const Integer magnitude = boost::multiprecision::abs(value);
  const int top = static_cast<int>(boost::multiprecision::msb(magnitude));
  if (top + exponent < -300) return 0;
  const int drop = std::max(top - 112, 0);
  const Integer kept = magnitude >> drop;
  // 49 bits, 32 and 32: every step is exact.
  const auto high = static_cast<double>(static_cast<std::uint64_t>(kept >> 64));
  const auto low = static_cast<std::uint64_t>(kept & Integer(~std::uint64_t{0}));
  const Quad whole =
      (Quad(high) * 0x1p32 + static_cast<double>(low >> 32)) * 0x1p32 + static_cast<double>(low & 0xffffffff);
  const Quad result = whole * std::ldexp(1.0, exponent + drop);
  return value.sign() < 0 ? Quad(-result) : result;
}

// An exact length is integer * 2^exponent / weight. In units of 2^scale every coordinate is below 2 (a body's are at
// most 1 before it is turned, the offset's at most 1); with the weight brought to [1, 2) instead of 1, below 4.
QuadFilter::QuadFilter(const ExactPair& pair)
    : pair_(pair),
      unit_exponent_(pair.scale() - pair.exponent() + pair.weight().exponent +
                     static_cast<int>(boost::multiprecision::msb(pair.weight().mantissa))),
      offset_(scaled(pair.offset())) {
  points_[0].resize(pair.a().exact.size());
  points_[1].resize(pair.b().exact.size());
  for (int s = 0; s < 2; ++s) known_[s].assign(points_[s].size(), 0);
}

QuadFilter::QVec QuadFilter::scaled(const IVec& v) {
  for (const Integer* c : {&v.x, &v.y, &v.z}) {
    // |c| 2^-unit_exponent <= kLargest, told by the highest bit.
    if (!c->is_zero() &&
        static_cast<int>(boost::multiprecision::msb(boost::multiprecision::abs(*c))) - unit_exponent_ >=
            std::ilogb(kLargest)) {
      in_range_ = false;
      return {};
    }
  }
  return {to_quad(v.x, -unit_exponent_), to_quad(v.y, -unit_exponent_), to_quad(v.z, -unit_exponent_)};
}

const QuadFilter::QVec& QuadFilter::point(bool of_b, int i) {
  const std::size_t side = of_b ? 1 : 0;
  const auto k = static_cast<std::size_t>(i);
  if (!known_[side][k]) {
    points_[side][k] = scaled(of_b ? pair_.point_b(i) : pair_.point_a(i));
    known_[side][k] = 1;
  }
  return points_[side][k];
}

/// Over B, or over -A.
Quad QuadFilter::largest_dot(bool of_b, const QVec& n, const Vec3& unit) {
  pair_.near_support(of_b, of_b ? unit : Vec3(-unit), 0, near_);
  Quad best = 0;
  bool any = false;
  for (const int i : near_) {
    const Quad value = dot(point(of_b, i), n);
    const Quad signed_value = of_b ? value : Quad(-value);
    if (!any || signed_value > best) best = signed_value;
    any = true;
  }
  return best;
}

std::optional<SquaredHeight> QuadFilter::squared_height(const IVec& n, const Vec3& unit) {
  int top = 0;
  for (const Integer* c : {&n.x, &n.y, &n.z}) {
    if (!c->is_zero())
      top = std::max(top, static_cast<int>(boost::multiprecision::msb(boost::multiprecision::abs(*c))));
  }
  const QVec q{to_quad(n.x, -top), to_quad(n.y, -top), to_quad(n.z, -top)};
  const Quad h = dot(offset_, q) + largest_dot(true, q, unit) + largest_dot(false, q, unit);
  if (!in_range_) return std::nullopt;
  SquaredHeight result;
  const Quad high = h + kSupportError;
  const Quad low = h - kSupportError;
  result.negative = high < 0;
  const Quad n2 = dot(q, q);
  if (low > 0) result.lower = low * low / n2 * (Quad(1) - kRatioError);
  result.upper = (low < -high ? Quad(low * low) : Quad(high * high)) / n2 * (Quad(1) + kRatioError);
  return result;
}

}  // namespace pd::oracle
