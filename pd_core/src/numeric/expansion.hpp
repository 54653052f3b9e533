/// @file
/// Expansion arithmetic: exact sums of doubles, in order of increasing magnitude, nonoverlapping, without zeros.
///
/// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997: fast expansion
/// sum (figure 8) and scale expansion (figure 13), both with zero elimination. Exact as long as nothing over- or
/// underflows; the caller sees to the range (`predicates.cpp`).
#pragma once

#include <cmath>
#include <cstddef>

#include "numeric/double_double.hpp"

namespace pd::detail {

/// A number as at most N doubles; size 0 is zero.
template <int N>
struct Expansion {
  int size = 0;
  double term[static_cast<std::size_t>(N)];

  void push(double value) {
    if (value != 0) term[size++] = value;
  }
  [[nodiscard]] int sign() const { return size == 0 ? 0 : (term[size - 1] > 0 ? 1 : -1); }
};

/// a - b, exact.
inline Expansion<2> difference(double a, double b) {
  const DoubleDouble d = two_sum(a, -b);
  Expansion<2> e;
  e.push(d.lo);
  e.push(d.hi);
  return e;
}

/// e + sign_f * f, exact; sign_f is 1 or -1.
template <int N, int M>
Expansion<N + M> sum(const Expansion<N>& e, const Expansion<M>& f, double sign_f = 1) {
  Expansion<N + M> h;
  int i = 0;
  int j = 0;
  const auto next = [&]() {
    if (j >= f.size || (i < e.size && std::abs(e.term[i]) < std::abs(f.term[j]))) return e.term[i++];
    return sign_f * f.term[j++];
  };
  const int total = e.size + f.size;
  if (total == 0) return h;
  double q = next();
  for (int k = 1; k < total; ++k) {
    const DoubleDouble s = two_sum(q, next());
    h.push(s.lo);
    q = s.hi;
  }
  h.push(q);
  return h;
}

/// b * e, exact.
template <int N>
Expansion<2 * N> scaled(const Expansion<N>& e, double b) {
  Expansion<2 * N> h;
  if (e.size == 0) return h;
  DoubleDouble product = two_product(e.term[0], b);
  double q = product.hi;
  h.push(product.lo);
  for (int i = 1; i < e.size; ++i) {
    product = two_product(e.term[i], b);
    const DoubleDouble low = two_sum(q, product.lo);
    h.push(low.lo);
    const DoubleDouble high = quick_two_sum(product.hi, low.hi);
    h.push(high.lo);
    q = high.hi;
  }
  h.push(q);
  return h;
}

/// e * f, exact.
template <int N>
Expansion<4 * N> product(const Expansion<N>& e, const Expansion<2>& f) {
  if (f.size == 0) return {};
  const Expansion<2 * N> low = scaled(e, f.term[0]);
  return sum(low, f.size == 2 ? scaled(e, f.term[1]) : Expansion<2 * N>{});
}

/// a * d - b * c, exact.
inline Expansion<16> determinant2(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c,
                                  const Expansion<2>& d) {
  return sum(product(a, d), product(b, c), -1);
}

/// Three coordinates, each a difference of two doubles.
struct DifferenceVector {
  Expansion<2> x, y, z;
};
/// Sign of <a, b x c>, exact.
inline int sign_of_determinant(const DifferenceVector& a, const DifferenceVector& b, const DifferenceVector& c) {
  const auto along_x = product(determinant2(b.y, b.z, c.y, c.z), a.x);
  const auto along_y = product(determinant2(b.z, b.x, c.z, c.x), a.y);
  const auto along_z = product(determinant2(b.x, b.y, c.x, c.y), a.z);
  return sum(sum(along_x, along_y), along_z).sign();
}

/// Whether products of three differences of such coordinates are exact: every bit of theirs lies in 2^-1056 .. 2^1000,
/// and Veltkamp's split does not overflow.
inline bool fits_expansions(double coordinate) {
  const double magnitude = std::abs(coordinate);
  return coordinate == 0 || (magnitude >= 0x1p-300 && magnitude <= 0x1p320);
}

}  // namespace pd::detail
