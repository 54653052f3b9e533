#include "numeric/dyadic.hpp"

#include <algorithm>
#include <limits>

namespace pd::detail {

namespace {

static_assert(sizeof(boost::multiprecision::limb_type) == sizeof(std::uint64_t));
__extension__ typedef __int128 Wide;
__extension__ typedef unsigned __int128 UnsignedWide;

/// A mantissa of one limb, times a small power of two.
Wide widened(const Dyadic::Integer& x, int shift) {
  const Wide magnitude = static_cast<Wide>(x.backend().limbs()[0]) << shift;
  return x.backend().sign() ? -magnitude : magnitude;
}

}  // namespace

void Dyadic::multiply(const Integer& a, const Integer& b, Integer& product) {
  const auto& x = a.backend();
  const auto& y = b.backend();
  const unsigned n = x.size(), m = y.size();
  auto& out = product.backend();
  out.resize(n + m, n + m);
  const auto *p = x.limbs(), *q = y.limbs();
  auto* const r = out.limbs();
  std::fill_n(r, n + m, 0);
  // Sums of numbers hundreds of powers apart are zeros for the most part: word by word, without these.
  for (unsigned i = 0; i < n; ++i) {
    if (p[i] == 0) continue;
    std::uint64_t carry = 0;
    for (unsigned j = 0; j < m; ++j) {
      if (q[j] == 0 && carry == 0) continue;
      const UnsignedWide t = static_cast<UnsignedWide>(p[i]) * q[j] + r[i + j] + carry;
      r[i + j] = static_cast<std::uint64_t>(t);
      carry = static_cast<std::uint64_t>(t >> 64);
    }
    r[i + m] = carry;
  }
  out.normalize();
  out.sign(x.sign() != y.sign());
}

Dyadic Dyadic::sum(const Dyadic& a, const Dyadic& b, bool subtract) {
  if (b.sign() == 0) return a;
  if (a.sign() == 0) return subtract ? -b : b;
  Dyadic r;
  r.exponent_ = std::min(a.exponent_, b.exponent_);
  const Integer& x = a.mantissa_;
  const Integer& y = b.mantissa_;
  // 64 bits, shifted by less than 62, and a carry: 127 bits at most.
  constexpr int kMostShift = 61;
  if (x.backend().size() == 1 && y.backend().size() == 1 && a.exponent_ - r.exponent_ <= kMostShift &&
      b.exponent_ - r.exponent_ <= kMostShift) {
    const Wide left = widened(x, a.exponent_ - r.exponent_);
    const Wide right = widened(y, b.exponent_ - r.exponent_);
    r.mantissa_ = subtract ? left - right : left + right;
    if (r.mantissa_.is_zero()) r.exponent_ = 0;
    return r;
  }
  if (a.exponent_ == r.exponent_) {
    const Integer shifted = y << static_cast<unsigned>(b.exponent_ - r.exponent_);
    r.mantissa_ = subtract ? Integer(x - shifted) : Integer(x + shifted);
  } else {
    const Integer shifted = x << static_cast<unsigned>(a.exponent_ - r.exponent_);
    r.mantissa_ = subtract ? Integer(shifted - y) : Integer(shifted + y);
  }
  if (r.mantissa_.is_zero()) r.exponent_ = 0;
  return r;
}

namespace {

/// |mantissa| * 2^exponent rounded towards zero; `exact` tells whether nothing was lost.
double truncate(const Dyadic::Integer& magnitude, int exponent, bool& exact) {
  const int bits = static_cast<int>(boost::multiprecision::msb(magnitude)) + 1;
  // A double near the value has its lowest bit at this weight (subnormals included).
  const int lowest = std::max(bits - 53, -1074 - exponent);
  exact = true;
  if (lowest <= 0) return std::ldexp(static_cast<double>(static_cast<std::uint64_t>(magnitude)), exponent);
  exact = static_cast<int>(boost::multiprecision::lsb(magnitude)) >= lowest;
  if (lowest >= bits) return 0.0;
  const Dyadic::Integer top = magnitude >> static_cast<unsigned>(lowest);
  return std::ldexp(static_cast<double>(static_cast<std::uint64_t>(top)), exponent + lowest);
}

}  // namespace

double Dyadic::round_down() const {
  if (sign() == 0) return 0;
  bool exact = true;
  const double magnitude = truncate(boost::multiprecision::abs(mantissa_), exponent_, exact);
  if (sign() > 0) return std::isinf(magnitude) ? std::numeric_limits<double>::max() : magnitude;
  return exact ? -magnitude : std::nextafter(-magnitude, -std::numeric_limits<double>::infinity());
}

double Dyadic::round_up() const { return -(-*this).round_down(); }

double Dyadic::to_double() const {
  if (sign() == 0) return 0;
  bool exact = true;
  const double magnitude = truncate(boost::multiprecision::abs(mantissa_), exponent_, exact);
  return sign() > 0 ? magnitude : -magnitude;
}

}  // namespace pd::detail
