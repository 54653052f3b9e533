/// @file
/// Seidel's randomised linear program in K variables: maximise <objective, x> with <a_i, x> <= b_i and |x_k| <= bound.
///
/// Seidel, "Small-dimensional linear programming and convex hulls made easy", 1991: constraints enter one by one, and
/// one that cuts off the optimum so far holds it on its plane, a program in K - 1 variables. Expected O(K! n) in random
/// order, which the caller provides. In doubles: a constraint counts as kept within `slack` (rows of unit length).
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "pd/dimension/vector.hpp"

namespace pd::dimension::detail {

template <int K>
struct ProgramRow {
  Eigen::Matrix<double, K, 1, Eigen::DontAlign> a;
  double b;
};

/// False when no x keeps all rows.
template <int K>
bool maximise(const std::vector<ProgramRow<K>>& rows, const Eigen::Matrix<double, K, 1, Eigen::DontAlign>& objective,
              double bound, double slack, Eigen::Matrix<double, K, 1, Eigen::DontAlign>& x) {
  if constexpr (K == 1) {
    double low = -bound, high = bound;
    for (const ProgramRow<1>& row : rows) {
      const double a = row.a[0];
      if (std::abs(a) <= slack) {
        if (row.b < -slack) return false;
      } else if (a > 0) {
        high = std::fmin(high, row.b / a);
      } else {
        low = std::fmax(low, row.b / a);
      }
    }
    if (low > high + slack * (1 + std::abs(low))) return false;
    x[0] = objective[0] >= 0 ? high : low;
    return true;
  } else {
    using Row = ProgramRow<K - 1>;
    for (int k = 0; k < K; ++k) x[k] = objective[k] >= 0 ? bound : -bound;
    std::vector<Row> below;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double sum = rows[i].a.dot(x);
      if (sum <= rows[i].b + slack * (1 + rows[i].a.cwiseAbs().dot(x.cwiseAbs()))) continue;
      // On the plane of row i: x_pivot = (b - sum of the others) / a_pivot.
      Eigen::Index pivot;
      const double largest = rows[i].a.cwiseAbs().maxCoeff(&pivot);
      if (largest <= slack) return false;
      const auto without = [&](const auto& v) {
        Eigen::Matrix<double, K - 1, 1, Eigen::DontAlign> r;
        for (int k = 0, to = 0; k < K; ++k) {
          if (k != pivot) r[to++] = v[k];
        }
        return r;
      };
      const double a = rows[i].a[pivot], b = rows[i].b;
      const Eigen::Matrix<double, K - 1, 1, Eigen::DontAlign> along = without(rows[i].a) / a;
      below.clear();
      below.push_back({-along, bound - b / a});
      below.push_back({along, bound + b / a});
      bool empty = false;
      for (std::size_t j = 0; j < i; ++j) {
        Row row{without(rows[j].a) - rows[j].a[pivot] * along, rows[j].b - rows[j].a[pivot] * b / a};
        const double length = row.a.norm();
        if (length <= slack) {
          // Parallel to row i.
          empty = empty || row.b < -slack * (1 + std::abs(rows[j].b));
          continue;
        }
        row.a /= length;
        row.b /= length;
        below.push_back(row);
      }
      Eigen::Matrix<double, K - 1, 1, Eigen::DontAlign> y;
      if (empty || !maximise<K - 1>(below, without(objective) - objective[pivot] * along, bound, slack, y))
        return false;
      for (int k = 0, from = 0; k < K; ++k) {
        if (k != pivot) x[k] = y[from++];
      }
      x[pivot] = b / a - along.dot(y);
    }
    return true;
  }
}

}  // namespace pd::dimension::detail
