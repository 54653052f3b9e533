#include "numeric/root_sum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace pd::detail {

namespace {

DoubleDouble scaled(const DoubleDouble& x, int exponent) {
  return {std::ldexp(x.hi, exponent), std::ldexp(x.lo, exponent)};
}

int top_bit(const Dyadic& x) { return x.exponent() + static_cast<int>(msb(boost::multiprecision::abs(x.mantissa()))); }

constexpr double kLargest = std::numeric_limits<double>::max();

/// Strides double up to here: twice as many are still a number of steps.
constexpr std::int64_t kLongestStride = std::int64_t{1} << 61;

/// How many doubles lie from x to y, 0 <= x <= y.
std::int64_t steps_between(double x, double y) {
  return std::bit_cast<std::int64_t>(y) - std::bit_cast<std::int64_t>(x);
}

/// The k-th double after x >= 0 (before it for negative k), not below 0.
double step(double x, std::int64_t k) {
  const std::int64_t bits = std::bit_cast<std::int64_t>(x) + k;
  return std::bit_cast<double>(std::max<std::int64_t>(bits, 0));
}

}  // namespace

RootSum::RootSum(Dyadic base, int sign, Dyadic numerator, Dyadic denominator)
    : base_(std::move(base)), sign_(sign), numerator_(std::move(numerator)), denominator_(std::move(denominator)) {}

int RootSum::compare(const Dyadic& x) const {
  const Dyadic rest = base_ - x;  // value - x = rest + sign * root
  const int root = numerator_.sign() == 0 ? 0 : sign_;
  if (rest.sign() == 0) return root;
  if (root == 0 || root == rest.sign()) return rest.sign();
  const int larger = (rest * rest * denominator_ - numerator_).sign();  // |rest| against the root
  return larger == 0 ? 0 : (larger > 0 ? rest.sign() : root);
}

DoubleDouble RootSum::approximate() const {
  if (numerator_.sign() == 0) return to_double_double(base_);
  // Even shifts, so that the root's shift is whole.
  const int up = top_bit(numerator_) & ~1;
  const int down = top_bit(denominator_) & ~1;
  DoubleDouble root = sqrt(to_double_double(numerator_.scaled(-up)) / to_double_double(denominator_.scaled(-down)));
  root = scaled(sign_ > 0 ? root : -root, (up - down) / 2);
  if (base_.sign() == 0) return root;
  const DoubleDouble base = to_double_double(base_);
  if (base_.sign() == sign_) return base + root;
  // The two cancel: base + r = (base^2 - r^2) / (base - r), where nothing is lost, as the numerator is exact.
  const Dyadic difference = base_ * base_ * denominator_ - numerator_;
  if (difference.sign() == 0) return {0, 0};
  const int shift = top_bit(difference);
  const int size = std::ilogb(base.hi);
  const DoubleDouble quotient = to_double_double(difference.scaled(-shift)) /
                                (to_double_double(denominator_.scaled(-down)) * scaled(base - root, -size));
  return scaled(quotient, shift - down - size);
}

double RootSum::round_down() const {
  // Where parts of the approximation leave the range of doubles it says nothing.
  double low = to_double(approximate());
  low = low > 0 ? std::min(low, kLargest) : 0;
  std::int64_t stride = 1;
  // The approximation is within an ulp, but for subnormal numbers: gallop there.
  if (compare(Dyadic(low)) < 0) {
    double high = low;
    while (low > 0 && compare(Dyadic(low)) < 0) {
      high = low;
      low = step(low, -stride);
      stride = 2 * std::min(stride, kLongestStride);
    }
    while (step(low, 1) < high) {
      const double middle = step(low, (std::bit_cast<std::int64_t>(high) - std::bit_cast<std::int64_t>(low)) / 2);
      (compare(Dyadic(middle)) < 0 ? high : low) = middle;
    }
    return low;
  }
  if (low == kLargest) return low;
  double high = step(low, 1);
  while (compare(Dyadic(high)) >= 0) {
    low = high;
    if (low == kLargest) return low;
    high = step(high, std::min(stride, steps_between(high, kLargest)));
    stride = 2 * std::min(stride, kLongestStride);
  }
  while (step(low, 1) < high) {
    const double middle = step(low, (std::bit_cast<std::int64_t>(high) - std::bit_cast<std::int64_t>(low)) / 2);
    (compare(Dyadic(middle)) < 0 ? high : low) = middle;
  }
  return low;
}

double RootSum::round_up(double down) const { return compare(Dyadic(down)) == 0 ? down : step(down, 1); }

DoubleDouble to_double_double(const Dyadic& value) {
  const double high = value.to_double();
  if (!std::isfinite(high)) return {high, 0};
  const double low = (value - Dyadic(high)).to_double();
  return quick_two_sum(high, low);
}

Vec3DD unit_double_double(const Dyadic3& v) {
  int largest = std::numeric_limits<int>::min();
  for (const Dyadic* c : {&v.x, &v.y, &v.z}) {
    if (c->sign() != 0) largest = std::max(largest, top_bit(*c));
  }
  const Vec3DD scaled{to_double_double(v.x.scaled(-largest)), to_double_double(v.y.scaled(-largest)),
                      to_double_double(v.z.scaled(-largest))};
  const DoubleDouble length = sqrt(dot(scaled, scaled));
  return {scaled.x / length, scaled.y / length, scaled.z / length};
}

double length_rounded_up(const Vec3& v) {
  const Dyadic3 exact = to_dyadic(v);
  const RootSum length(Dyadic(0.0), 1, dot(exact, exact), Dyadic(1.0));
  return length.round_up(length.round_down());
}

}  // namespace pd::detail
