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

/// K between two ellipsoids: for every v, <c, v> + |inner^T v| <= h_K(v) <= <c, v> + |outer^T v|. Both roots are lower
/// triangular. Roots, not the matrices inner inner^T: those would square the body's aspect.
template <int N>
struct EllipsoidBounds {
  Point<N> center;
  SquareMatrix<N> inner;
  SquareMatrix<N> outer;

  static EllipsoidBounds zero(Eigen::Index size) {
    return {Point<N>::Zero(size), SquareMatrix<N>::Zero(size, size), SquareMatrix<N>::Zero(size, size)};
  }
};

/// Makes root root^T + scale^2 more more^T of root root^T: the rows of [root, scale more] orthogonalised, twice each.
template <int N, class More>
void add_to_root(SquareMatrix<N>& root, double scale, const More& more) {
  const Eigen::Index n = root.rows();
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxRows<N>, 2 * kMaxRows<N>>;
  Rows q(n, n + more.cols());
  q.leftCols(n) = root;
  q.rightCols(more.cols()) = scale * more;
  root.setZero();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int turn = 0; turn < 2; ++turn) {
      for (Eigen::Index j = 0; j < i; ++j) {
        const double part = q.row(j).dot(q.row(i));
        root(i, j) += part;
        q.row(i) -= part * q.row(j);
      }
    }
    root(i, i) = q.row(i).norm();
    if (root(i, i) > 0) q.row(i) /= root(i, i);
  }
}

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
