/// @file
/// The fattened frame of a body: an affine image in which its outer ellipsoid is a unit ball ([M] Lemma 10).
#pragma once

#include <cmath>
#include <limits>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

/// x = root * y. The origin stays where it is; a direction u of the frame is the direction root^-T u of the body's
/// space.
template <int N>
class OriginFrame {
 public:
  explicit OriginFrame(const SupportBody<N>& body) : body_(body) {
    const EllipsoidBounds<N> bounds = body.bounds();
    const Eigen::Index n = bounds.center.size();
    root_ = bounds.outer;
    center_ = solve(bounds.center);
    // The inner ellipsoid in the frame is the image of a ball by root^-1 inner_root, and holds the ball whose radius is
    // one over the norm of that map's inverse.
    double inverse_squared = 0;
    double root_squared = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      inverse_squared += solve_lower(bounds.inner, Point<N>(root_.col(k))).squaredNorm();
      root_squared += solve(Point<N>(Point<N>::Unit(n, k))).squaredNorm();
    }
    inner_radius_ = 1 / std::sqrt(inverse_squared);
    // A solve by a triangular matrix has the backward error of a few products a row; the norm of the inverse bounds it.
    const double size = static_cast<double>(n);
    rounding_ =
        16 * size * std::numeric_limits<double>::epsilon() * (1 + std::sqrt(root_squared * size) * body.magnitude());
  }

  /// The support point in a direction of the frame, in the frame. Counts.
  [[nodiscard]] Point<N> support(const Point<N>& u) const {
    ++supports_;
    return solve(body_.support(to_body(u)));
  }
  /// root^-T u.
  [[nodiscard]] Point<N> to_body(const Point<N>& u) const {
    Point<N> v = u;
    for (Eigen::Index i = v.size() - 1; i >= 0; --i) {
      for (Eigen::Index k = i + 1; k < v.size(); ++k) v(i) -= root_(k, i) * v(k);
      v(i) /= root_(i, i);
    }
    return v;
  }

  [[nodiscard]] const Point<N>& center() const { return center_; }     ///< the body lies in the unit ball about it
  [[nodiscard]] double inner_radius() const { return inner_radius_; }  ///< and holds the ball of this radius about it
  /// Bounds the error of <support(u), u> for unit u.
  [[nodiscard]] double rounding() const { return rounding_; }
  [[nodiscard]] std::int64_t supports() const { return supports_; }

 private:
  static Point<N> solve_lower(const SquareMatrix<N>& lower, Point<N> x) {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      for (Eigen::Index k = 0; k < i; ++k) x(i) -= lower(i, k) * x(k);
      x(i) /= lower(i, i);
    }
    return x;
  }
  [[nodiscard]] Point<N> solve(const Point<N>& x) const { return solve_lower(root_, x); }

  const SupportBody<N>& body_;
  SquareMatrix<N> root_;
  Point<N> center_;
  double inner_radius_ = 0;
  double rounding_ = 0;
  mutable std::int64_t supports_ = 0;
};

}  // namespace pd::dimension::detail
