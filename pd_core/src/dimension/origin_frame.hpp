/// @file
/// The fattened frame of a body: an affine image in which its outer ellipsoid is a unit ball ([M] Lemma 10).
#pragma once

#include <cmath>
#include <limits>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

/// x = root * y. The origin stays where it is; a direction u of the frame is the direction root^-T u of the body's
/// space.
class OriginFrame {
 public:
  explicit OriginFrame(const SupportBody& body) : body_(body) {
    const EllipsoidBounds bounds = body.bounds();
    const Eigen::Index n = bounds.center.size();
    root_ = bounds.outer;
    center_ = bounds.center;
    solve_lower(root_, center_);
    // The inner ellipsoid in the frame is the image of a ball by root^-1 inner_root, and holds the ball whose radius is
    // one over the norm of that map's inverse.
    double inverse_squared = 0;
    double root_squared = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      Point column = root_.col(k);
      solve_lower(bounds.inner, column, k);
      inverse_squared += column.squaredNorm();
      column = Point::Unit(n, k);
      solve_lower(root_, column, k);
      root_squared += column.squaredNorm();
    }
    inner_radius_ = 1 / std::sqrt(inverse_squared);
    // A solve by a triangular matrix has the backward error of a few products a row; the norm of the inverse bounds it.
    const double size = static_cast<double>(n);
    rounding_ =
        16 * size * std::numeric_limits<double>::epsilon() * (1 + std::sqrt(root_squared * size) * body.magnitude());
  }

  /// The support point in a direction of the frame, in the frame. Counts.
  [[nodiscard]] Point support(const Point& u) const {
    ++supports_;
    Point p = body_.support(to_body(u));
    solve_lower(root_, p);
    return p;
  }
  /// root^-T u.
  [[nodiscard]] Point to_body(const Point& u) const {
    Point v = u;
    for (Eigen::Index i = v.size() - 1; i >= 0; --i) {
      for (Eigen::Index k = i + 1; k < v.size(); ++k) v(i) -= root_(k, i) * v(k);
      v(i) /= root_(i, i);
    }
    return v;
  }

  [[nodiscard]] const Point& center() const { return center_; }        ///< the body lies in the unit ball about it
  [[nodiscard]] double inner_radius() const { return inner_radius_; }  ///< and holds the ball of this radius about it
  /// Bounds the error of <support(u), u> for unit u.
  [[nodiscard]] double rounding() const { return rounding_; }
  [[nodiscard]] std::int64_t supports() const { return supports_; }

 private:
  /// Replaces x, whose coordinates before `first` are zero, by lower^-1 x.
  static void solve_lower(const LiftedMatrix& lower, Point& x, Eigen::Index first = 0) {
    for (Eigen::Index i = first; i < x.size(); ++i) {
      for (Eigen::Index k = first; k < i; ++k) x(i) -= lower(i, k) * x(k);
      x(i) /= lower(i, i);
    }
  }

  const SupportBody& body_;
  LiftedMatrix root_;
  Point center_;
  double inner_radius_ = 0;
  double rounding_ = 0;
  mutable std::int64_t supports_ = 0;
};

}  // namespace pd::dimension::detail
