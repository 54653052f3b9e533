/// @file
/// Points, directions and matrices in R^D, 2 <= D <= 5.
///
/// Unaligned types: their size and alignment do not depend on the instruction set that a translation unit is compiled
/// for.
///
/// Sums, multiples and products of them are evaluated at once, by the operators below. Eigen's own operators would make
/// a type of each expression, and the compiler takes longer over these types than over all else in this folder. The
/// numbers are the same: products add in the order in which Eigen adds with registers of two doubles.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace pd::dimension {

inline constexpr int kMinDimension = 2;
inline constexpr int kMaxDimension = 5;

template <int D>
using Vector = Eigen::Matrix<double, D, 1, Eigen::DontAlign>;
template <int D>
using Matrix = Eigen::Matrix<double, D, D, Eigen::DontAlign>;

template <int D>
Vector<D> operator+(const Vector<D>& a, const Vector<D>& b) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = a.data()[k] + b.data()[k];
  return r;
}

template <int D>
Vector<D> operator-(const Vector<D>& a, const Vector<D>& b) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = a.data()[k] - b.data()[k];
  return r;
}

template <int D>
Vector<D> operator-(const Vector<D>& a) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = -a.data()[k];
  return r;
}

template <int D, typename Scalar>
requires std::is_arithmetic_v<Scalar> Vector<D>
operator*(const Vector<D>& a, Scalar s) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = a.data()[k] * s;
  return r;
}

template <int D, typename Scalar>
requires std::is_arithmetic_v<Scalar> Vector<D>
operator*(Scalar s, const Vector<D>& a) { return a * s; }

template <int D, typename Scalar>
requires std::is_arithmetic_v<Scalar> Vector<D>
operator/(const Vector<D>& a, Scalar s) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = a.data()[k] / s;
  return r;
}

template <int D>
Vector<D>& operator+=(Vector<D>& a, const Vector<D>& b) {
  for (int k = 0; k < D; ++k) a.data()[k] += b.data()[k];
  return a;
}

template <int D>
Vector<D>& operator-=(Vector<D>& a, const Vector<D>& b) {
  for (int k = 0; k < D; ++k) a.data()[k] -= b.data()[k];
  return a;
}

template <int D, typename Scalar>
requires std::is_arithmetic_v<Scalar> Vector<D>
&operator*=(Vector<D>& a, Scalar s) {
  for (int k = 0; k < D; ++k) a.data()[k] *= s;
  return a;
}

template <int D, typename Scalar>
requires std::is_arithmetic_v<Scalar> Vector<D>
&operator/=(Vector<D>& a, Scalar s) {
  for (int k = 0; k < D; ++k) a.data()[k] /= s;
  return a;
}

namespace detail {

/// Row k of a matrix times a vector. Eigen adds the products one after the other where it has two rows in a register,
/// and as a tree in the last row of an odd number.
template <int D>
double row_times_vector(const Matrix<D>& m, int k, const double* v) {
  const auto product = [&](int j) { return m.data()[k + j * D] * v[j]; };
  if constexpr (D == 3) {
    if (k == 2) return product(0) + (product(1) + product(2));
  }
  if constexpr (D == 5) {
    if (k == 4) return (product(0) + product(1)) + (product(2) + (product(3) + product(4)));
  }
  double r = product(0);
  for (int j = 1; j < D; ++j) r += product(j);
  return r;
}

/// The transposed matrix times a vector: columns lie in registers of two.
template <int D>
Vector<D> transposed_times_vector(const Matrix<D>& m, const Vector<D>& v) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) {
    const auto product = [&](int j) { return m.data()[k * D + j] * v.data()[j]; };
    double sum = product(0);
    if constexpr (D == 2 || D == 3) sum += product(1);
    if constexpr (D >= 4) sum = (sum + product(2)) + (product(1) + product(3));
    if constexpr (D % 2 == 1 && D > 1) sum += product(D - 1);
    r.data()[k] = sum;
  }
  return r;
}

}  // namespace detail

// In one dimension a matrix is of the type of a vector: products are Eigen's there.

template <int D>
requires(D > 1) Vector<D>
operator*(const Matrix<D>& m, const Vector<D>& v) {
  Vector<D> r;
  for (int k = 0; k < D; ++k) r.data()[k] = detail::row_times_vector<D>(m, k, v.data());
  return r;
}

template <int D>
requires(D > 1) Vector<D>
operator*(const Eigen::Transpose<Matrix<D>>& m, const Vector<D>& v) {
  return detail::transposed_times_vector<D>(m.nestedExpression(), v);
}

template <int D>
requires(D > 1) Vector<D>
operator*(const Eigen::Transpose<const Matrix<D>>& m, const Vector<D>& v) {
  return detail::transposed_times_vector<D>(m.nestedExpression(), v);
}

template <int D>
requires(D > 1) Matrix<D>
operator*(const Matrix<D>& a, const Matrix<D>& b) {
  Matrix<D> r;
  for (int j = 0; j < D; ++j) {
    for (int k = 0; k < D; ++k) r.data()[k + j * D] = detail::row_times_vector<D>(a, k, b.data() + j * D);
  }
  return r;
}

template <int D, typename Scalar>
requires(D > 1 && std::is_arithmetic_v<Scalar>) Matrix<D>
operator*(const Matrix<D>& m, Scalar s) {
  Matrix<D> r;
  for (int k = 0; k < D * D; ++k) r.data()[k] = m.data()[k] * s;
  return r;
}

template <int D, typename Scalar>
requires(D > 1 && std::is_arithmetic_v<Scalar>) Matrix<D>
operator*(Scalar s, const Matrix<D>& m) { return m * s; }

template <int D, typename Scalar>
requires(D > 1 && std::is_arithmetic_v<Scalar>) Matrix<D>
operator/(const Matrix<D>& m, Scalar s) {
  Matrix<D> r;
  for (int k = 0; k < D * D; ++k) r.data()[k] = m.data()[k] / s;
  return r;
}

}  // namespace pd::dimension
