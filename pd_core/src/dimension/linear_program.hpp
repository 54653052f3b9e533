/// @file
/// Seidel's randomised linear program in K variables: maximise <objective, x> with <a_i, x> <= b_i and |x_k| <= bound.
///
/// Seidel, "Small-dimensional linear programming and convex hulls made easy", 1991: constraints enter one by one, and
/// one that cuts off the optimum so far holds it on its plane, a program in K - 1 variables. Expected O(K! n) in random
/// order, which the caller provides. In doubles or in double-double: a constraint counts as kept within `slack` (rows
/// of unit length). Optima of the programs in fewer variables may lie at the bound, so that slack * bound has to be
/// small beside the body.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "numeric/double_double.hpp"

namespace pd::dimension::detail {

template <typename Scalar, int K>
using ProgramVector = std::array<Scalar, std::size_t(K)>;

template <typename Scalar, int K>
struct ProgramRow {
  ProgramVector<Scalar, K> a;
  Scalar b;
};

inline double head(double x) { return x; }
inline double head(const pd::detail::DoubleDouble& x) { return x.hi; }
inline double root(double x) { return std::sqrt(x); }
inline pd::detail::DoubleDouble root(const pd::detail::DoubleDouble& x) { return sqrt(x); }

template <typename Scalar, std::size_t K>
Scalar dot(const std::array<Scalar, K>& a, const std::array<Scalar, K>& b) {
  Scalar sum = a[0] * b[0];
  for (std::size_t k = 1; k < K; ++k) sum = sum + a[k] * b[k];
  return sum;
}

/// What rounding may add to dot(a, b), in units of the slack.
template <typename Scalar, std::size_t K>
double magnitude(const std::array<Scalar, K>& a, const std::array<Scalar, K>& b) {
  double sum = 1;
  for (std::size_t k = 0; k < K; ++k) sum += std::abs(head(a[k]) * head(b[k]));
  return sum;
}

/// The plane of `row`, solved for the variable `pivot`: x_pivot = offset - <along, the others>.
template <typename Scalar, int K>
struct Elimination {
  std::size_t pivot = 0;
  ProgramVector<Scalar, K - 1> along;
  Scalar offset;

  explicit Elimination(const ProgramRow<Scalar, K>& row) {
    for (std::size_t k = 1; k < K; ++k) {
      if (std::abs(head(row.a[k])) > std::abs(head(row.a[pivot]))) pivot = k;
    }
    for (std::size_t k = 0, to = 0; k < K; ++k) {
      if (k != pivot) along[to++] = row.a[k] / row.a[pivot];
    }
    offset = row.b / row.a[pivot];
  }
  /// The linear form `v` on the plane, but for its constant v_pivot * offset.
  [[nodiscard]] ProgramVector<Scalar, K - 1> restricted(const ProgramVector<Scalar, K>& v) const {
    ProgramVector<Scalar, K - 1> r;
    for (std::size_t k = 0, to = 0; k < K; ++k) {
      if (k == pivot) continue;
      r[to] = v[k] - v[pivot] * along[to];
      ++to;
    }
    return r;
  }
  [[nodiscard]] ProgramVector<Scalar, K> lifted(const ProgramVector<Scalar, K - 1>& y) const {
    ProgramVector<Scalar, K> x;
    for (std::size_t k = 0, from = 0; k < K; ++k) {
      if (k != pivot) x[k] = y[from++];
    }
    x[pivot] = offset - dot(along, y);
    return x;
  }
};

/// False when no x keeps all rows.
template <typename Scalar, int K>
bool maximise(const std::vector<ProgramRow<Scalar, K>>& rows, const ProgramVector<Scalar, K>& objective, double bound,
              double slack, ProgramVector<Scalar, K>& x) {
  if constexpr (K == 1) {
    Scalar low{-bound}, high{bound};
    for (const ProgramRow<Scalar, 1>& row : rows) {
      const Scalar& a = row.a[0];
      if (std::abs(head(a)) <= slack) {
        if (head(row.b) < -slack) return false;
        continue;
      }
      const Scalar end = row.b / a;
      if (head(a) > 0) {
        if (head(end - high) < 0) high = end;
      } else if (head(end - low) > 0) {
        low = end;
      }
    }
    if (head(low - high) > slack * (1 + std::abs(head(low)))) return false;
    x[0] = head(objective[0]) >= 0 ? high : low;
    return true;
  } else {
    for (std::size_t k = 0; k < K; ++k) x[k] = Scalar{head(objective[k]) >= 0 ? bound : -bound};
    std::vector<ProgramRow<Scalar, K - 1>> below;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (head(dot(rows[i].a, x) - rows[i].b) <= slack * magnitude(rows[i].a, x)) continue;
      const Elimination<Scalar, K> plane(rows[i]);
      if (std::abs(head(rows[i].a[plane.pivot])) <= slack) return false;
      below.clear();
      ProgramVector<Scalar, K - 1> opposite;
      for (std::size_t k = 0; k + 1 < K; ++k) opposite[k] = -plane.along[k];
      below.push_back({opposite, Scalar{bound} - plane.offset});
      below.push_back({plane.along, Scalar{bound} + plane.offset});
      for (std::size_t j = 0; j < i; ++j) {
        ProgramRow<Scalar, K - 1> row{plane.restricted(rows[j].a), rows[j].b - rows[j].a[plane.pivot] * plane.offset};
        const Scalar length = root(dot(row.a, row.a));
        if (head(length) <= slack) {
          // Parallel to row i.
          if (head(row.b) < -slack * (1 + std::abs(head(rows[j].b)))) return false;
          continue;
        }
        for (Scalar& a : row.a) a = a / length;
        row.b = row.b / length;
        below.push_back(row);
      }
      ProgramVector<Scalar, K - 1> y;
      if (!maximise<Scalar, K - 1>(below, plane.restricted(objective), bound, slack, y)) return false;
      x = plane.lifted(y);
    }
    return true;
  }
}

}  // namespace pd::dimension::detail
