/// @file
/// A convex body of R^N as the searches of [M] see it: one support point a direction, and two ellipsoids about one
/// centre.
///
/// [M] Arya, da Fonseca, Mount, "Approximate convex intersection detection with applications to width and Minkowski
/// sums", 2018. Everything there reaches a body through approximate directional widths and its fattening (Lemmas 5 and
/// 10); these are the two halves of this interface.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace pd::dimension::detail {

/// Largest N of a space that is only known at run time: intersections are met in a product of spaces
/// (`lifted_body.hpp`).
inline constexpr int kMaxLiftedDimension = 40;

template <int N>
inline constexpr int kMaxRows = N == Eigen::Dynamic ? kMaxLiftedDimension : N;
/// A point or direction of R^N; never on the heap.
template <int N>
using Point = Eigen::Matrix<double, N, 1, Eigen::DontAlign, kMaxRows<N>, 1>;
template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N, Eigen::DontAlign, kMaxRows<N>, kMaxRows<N>>;

/// K between two ellipsoids: for every v, <c, v> + sqrt(v' inner v) <= h_K(v) <= <c, v> + sqrt(v' outer v). Both
/// matrices are symmetric and positive definite.
template <int N>
struct EllipsoidBounds {
  Point<N> center;
  SquareMatrix<N> inner;
  SquareMatrix<N> outer;
};

/// Supports of a convex body K of R^N, within an error relative to the directional width.
template <int N>
class SupportBody {
 public:
  SupportBody() = default;
  SupportBody(const SupportBody&) = delete;
  SupportBody& operator=(const SupportBody&) = delete;
  virtual ~SupportBody() = default;

  /// A point p of K with <p, v> >= h_K(v) - relative_error() * width_K(v), for v other than zero.
  [[nodiscard]] virtual Point<N> support(const Point<N>& v) const = 0;
  [[nodiscard]] virtual double relative_error() const = 0;
  /// Whether the answers are the true extreme points of one fixed set: then the approximate support function is convex.
  [[nodiscard]] virtual bool consistent() const = 0;
  [[nodiscard]] virtual EllipsoidBounds<N> bounds() const = 0;
  /// Largest |coordinate| that goes into a support point: what its rounding errors are measured by.
  [[nodiscard]] virtual double magnitude() const = 0;
};

}  // namespace pd::dimension::detail
