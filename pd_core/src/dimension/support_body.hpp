/// @file
/// A convex body of R^N as the searches of [M] see it: one support point a direction, and two ellipsoids about one
/// centre.
///
/// [M] Arya, da Fonseca, Mount, "Approximate convex intersection detection with applications to width and Minkowski
/// sums", 2018. Everything there reaches a body through approximate directional widths and its fattening (Lemmas 5 and
/// 10); these are the two halves of this interface.
#pragma once

#include <cstdint>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

/// Largest N. It is known at run time: intersections are met in a product of spaces.
inline constexpr int kMaxLiftedDimension = 40;

/// A point or direction of R^N; never on the heap.
using Point = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::DontAlign, kMaxLiftedDimension, 1>;
/// A matrix of N rows and at most N columns; never on the heap.
using LiftedMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign, kMaxLiftedDimension, kMaxLiftedDimension>;

/// K between two ellipsoids: for every v, <c, v> + |inner^T v| <= h_K(v) <= <c, v> + |outer^T v|. Both roots are lower
/// triangular. Roots, not the matrices inner inner^T: those would square the body's aspect.
struct EllipsoidBounds {
  Point center;
  LiftedMatrix inner;
  LiftedMatrix outer;

  static EllipsoidBounds zero(Eigen::Index size) {
    return {Point::Zero(size), LiftedMatrix::Zero(size, size), LiftedMatrix::Zero(size, size)};
  }
};

[[nodiscard]] LiftedMatrix product(const LiftedMatrix& left, const LiftedMatrix& right);

/// Makes root root^T + scale^2 more more^T of root root^T.
void add_to_root(LiftedMatrix& root, double scale, const LiftedMatrix& more);

/// Supports of a convex body K of R^N, within an error relative to the directional width.
class SupportBody {
 public:
  SupportBody() = default;
  SupportBody(const SupportBody&) = delete;
  SupportBody& operator=(const SupportBody&) = delete;
  virtual ~SupportBody() = default;

  /// A point p of K with <p, v> >= h_K(v) - relative_error() * width_K(v), for v other than zero.
  [[nodiscard]] virtual Point support(const Point& v) const = 0;
  [[nodiscard]] virtual double relative_error() const = 0;
  /// Whether the answers are the true extreme points of one fixed set: then the approximate support function is convex.
  [[nodiscard]] virtual bool consistent() const = 0;
  [[nodiscard]] virtual EllipsoidBounds bounds() const = 0;
  /// Largest |coordinate| that goes into a support point: what its rounding errors are measured by.
  [[nodiscard]] virtual double magnitude() const = 0;
};

}  // namespace pd::dimension::detail
