/// @file
/// The point nearest to the origin in the hull of a few points of R^N, one point added at a time (Wolfe 1976).
#pragma once

#include <algorithm>
#include <cmath>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

/// At most N + 1 affinely independent points with the weights of the hull's nearest point to O.
class LeastNormSimplex {
 public:
  explicit LeastNormSimplex(const Point& first) : points_(first.size(), first.size() + 1), count_(1), nearest_(first) {
    points_.col(0) = first;
    weights_.resize(first.size() + 1);
    weights_(0) = 1;
  }

  [[nodiscard]] const Point& nearest() const { return nearest_; }

  /// Adds a point and drops those that the nearest point does not need. False, and nothing said of the nearest point's
  /// progress, when the points are too close to dependent for doubles: the caller stops or goes on by other means.
  [[nodiscard]] bool add(const Point& p) {
    if (count_ > nearest_.size()) return false;
    points_.col(count_) = p;
    weights_(count_) = 0;
    ++count_;
    while (true) {
      Weights affine(count_);
      if (!affine_minimum(affine)) return false;
      if ((affine.array() > 0).all()) {
        weights_.head(count_) = affine;
        nearest_ = affine(0) * points_.col(0);
        for (int i = 1; i < count_; ++i) add_scaled(nearest_.data(), affine(i), &points_(0, i), nearest_.size());
        return true;
      }
      step_towards(affine);
    }
  }

 private:
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLiftedDimension + 1, 1>;

  /// Weights of the point nearest to O in the affine hull: least squares over the edges from the last point, by
  /// Gram-Schmidt run twice a column.
  bool affine_minimum(Weights& weights) const {
    const int edges = count_ - 1;
    const Eigen::Index n = nearest_.size();
    LiftedMatrix q(n, edges);
    LiftedMatrix r(edges, edges);
    Point rest = -points_.col(edges);
    Weights along(edges + 1);
    for (int k = 0; k < edges; ++k) {
      Point column(n);
      for (Eigen::Index i = 0; i < n; ++i) column(i) = points_(i, k) - points_(i, edges);
      const double length = std::sqrt(dot(column.data(), column.data(), n));
      for (int i = 0; i < k; ++i) r(i, k) = 0;
      for (int turn = 0; turn < 2; ++turn) {
        for (int i = 0; i < k; ++i) {
          const double part = dot(&q(0, i), column.data(), n);
          r(i, k) += part;
          add_scaled(column.data(), -part, &q(0, i), n);
        }
      }
      r(k, k) = std::sqrt(dot(column.data(), column.data(), n));
      if (!(r(k, k) > 1e-13 * length)) return false;
      for (Eigen::Index i = 0; i < n; ++i) q(i, k) = column(i) / r(k, k);
      along(k) = dot(&q(0, k), rest.data(), n);
      add_scaled(rest.data(), -along(k), &q(0, k), n);
    }
    double sum = 0;
    for (int k = edges - 1; k >= 0; --k) {
      double x = along(k);
      for (int i = k + 1; i < edges; ++i) x -= r(k, i) * weights(i);
      weights(k) = x / r(k, k);
      sum += weights(k);
    }
    weights(edges) = 1 - sum;
    return weights.allFinite();
  }

  /// Moves the weights towards the affine minimum until the first of them is zero, and drops it.
  void step_towards(const Weights& affine) {
    double t = 1;
    int dropped = 0;
    for (int i = 0; i < count_; ++i) {
      if (affine(i) > 0) continue;
      const double ratio = weights_(i) > 0 ? weights_(i) / (weights_(i) - affine(i)) : 0.0;
      if (ratio > t) continue;
      t = ratio;
      dropped = i;
    }
    for (int i = 0; i < count_; ++i) weights_(i) = std::max(0.0, (1 - t) * weights_(i) + t * affine(i));
    --count_;
    points_.col(dropped) = points_.col(count_);
    weights_(dropped) = weights_(count_);
  }

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLiftedDimension, kMaxLiftedDimension + 1> points_;
  Weights weights_;
  int count_;
  Point nearest_;
};

}  // namespace pd::dimension::detail
