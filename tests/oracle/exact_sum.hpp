/// @file
/// The sign of a sum of products of doubles, without an error: the oracle's own expansion arithmetic.
///
/// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997, figure 6: a
/// nonoverlapping expansion grown term by term. Products are split after Veltkamp and Dekker.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace pd::oracle::grid {

/// A sum of at most N terms, kept exactly.
template <std::size_t N>
class ExactSum {
 public:
  /// Requires finite terms whose sum does not overflow.
  void add(double term) {
    double q = term;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double s = q + terms_[i];
      const double virtual_term = s - q;
      const double low = (q - (s - virtual_term)) + (terms_[i] - virtual_term);
      q = s;
      if (low != 0) terms_[kept++] = low;
    }
    if (q != 0) terms_[kept++] = q;
    size_ = kept;
  }

  /// Adds a b: two terms. Requires |a|, |b| <= 2^500 and a product that is 0 or at least 2^-900.
  void add_product(double a, double b) {
    const double high = a * b;
    const auto [a_high, a_low] = split(a);
    const auto [b_high, b_low] = split(b);
    add(((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low);
    add(high);
  }

  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : (terms_[size_ - 1] > 0 ? 1 : -1); }

 private:
  struct Halves {
    double high;
    double low;
  };
  static Halves split(double x) {
    const double c = 0x1.0000002p27 * x;
    const double high = c - (c - x);
    return {high, x - high};
  }

  std::array<double, N> terms_{};
  std::size_t size_ = 0;
};

}  // namespace pd::oracle::grid
