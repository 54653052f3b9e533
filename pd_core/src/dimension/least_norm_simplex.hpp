/// @file
/// The point nearest to the origin in the hull of a few points of R^N, one point added at a time (Wolfe 1976).
#pragma once

#include <algorithm>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

/// At most N + 1 affinely independent points with the weights of the hull's nearest point to O.
template <int N>
class LeastNormSimplex {
 public:
  explicit LeastNormSimplex(const Point<N>& first)
      : points_(first.size(), first.size() + 1), count_(1), nearest_(first) {
    points_.col(0) = first;
    weights_.resize(first.size() + 1);
    weights_(0) = 1;
  }

  [[nodiscard]] const Point<N>& nearest() const { return nearest_; }

  /// Adds a point and drops those that the nearest point does not need. False, and nothing said of the nearest point's
  /// progress, when the points are too close to dependent for doubles: the caller stops or goes on by other means.
  [[nodiscard]] bool add(const Point<N>& p) {
    if (count_ > nearest_.size()) return false;
    points_.col(count_) = p;
    weights_(count_) = 0;
    ++count_;
    while (true) {
      Weights affine(count_);
      if (!affine_minimum(affine)) return false;
      if ((affine.array() > 0).all()) {
        weights_.head(count_) = affine;
        nearest_ = points_.leftCols(count_) * affine;
        return true;
      }
      step_towards(affine);
    }
  }

 private:
  static constexpr int kRows = kMaxRows<N>;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRows + 1, 1>;
  using Edges = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kRows, kRows>;

  /// Weights of the point nearest to O in the affine hull: least squares over the edges from the last point, by
  /// Gram-Schmidt run twice a column (Eigen's decompositions take minutes to compile for five sizes).
  bool affine_minimum(Weights& weights) const {
    const int edges = count_ - 1;
    const Eigen::Index n = nearest_.size();
    Edges q(n, edges);
    Edges r(edges, edges);
    Point<N> rest = -points_.col(edges);
    Weights along(edges + 1);
    for (int k = 0; k < edges; ++k) {
      Point<N> column = points_.col(k) - points_.col(edges);
      const double length = column.norm();
      for (int i = 0; i < k; ++i) r(i, k) = 0;
      for (int turn = 0; turn < 2; ++turn) {
        for (int i = 0; i < k; ++i) {
          const double part = q.col(i).dot(column);
          r(i, k) += part;
          column -= part * q.col(i);
        }
      }
      r(k, k) = column.norm();
      if (!(r(k, k) > 1e-13 * length)) return false;
      q.col(k) = column / r(k, k);
      along(k) = q.col(k).dot(rest);
      rest -= along(k) * q.col(k);
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

  Eigen::Matrix<double, N, Eigen::Dynamic, 0, kRows, kRows + 1> points_;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRows + 1, 1> weights_;
  int count_;
  Point<N> nearest_;
};

}  // namespace pd::dimension::detail
