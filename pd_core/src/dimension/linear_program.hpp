/// @file
/// Seidel's randomised linear program in a few variables: maximise <objective, x> with <a_i, x> <= b_i and |x_k| <=
/// bound.
///
/// Seidel, "Small-dimensional linear programming and convex hulls made easy", 1991: constraints enter one by one, and
/// one that cuts off the optimum so far holds it on its plane, a program in one variable less. Expected O(K! n) for K
/// variables in random order, which the caller provides. In doubles or in double-double: a constraint counts as kept
/// within `slack` (rows of unit length). Optima of the programs in fewer variables may lie at the bound, so that slack
/// * bound has to be small beside the body.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "numeric/double_double.hpp"
#include "pd/dimension/vector.hpp"

namespace pd::dimension::detail {

/// Holds a number for each variable of a program, and leaves the rest unused.
template <typename Scalar>
using ProgramVector = std::array<Scalar, kMaxDimension>;

template <typename Scalar>
struct ProgramRow {
  ProgramVector<Scalar> a;
  Scalar b;
};

inline double head(double x) { return x; }
inline double head(const pd::detail::DoubleDouble& x) { return x.hi; }
inline double root(double x) { return std::sqrt(x); }
inline pd::detail::DoubleDouble root(const pd::detail::DoubleDouble& x) { return sqrt(x); }

template <typename Scalar>
Scalar dot(const ProgramVector<Scalar>& a, const ProgramVector<Scalar>& b, std::size_t variables) {
  Scalar sum = a[0] * b[0];
  for (std::size_t k = 1; k < variables; ++k) sum = sum + a[k] * b[k];
  return sum;
}

/// What rounding may add to dot(a, b), in units of the slack.
template <typename Scalar>
double magnitude(const ProgramVector<Scalar>& a, const ProgramVector<Scalar>& b, std::size_t variables) {
  double sum = 1;
  for (std::size_t k = 0; k < variables; ++k) sum += std::abs(head(a[k]) * head(b[k]));
  return sum;
}

/// The plane of `row`, solved for the variable `pivot`: x_pivot = offset - <along, the others>.
template <typename Scalar>
struct Elimination {
  std::size_t variables;
  std::size_t pivot = 0;
  ProgramVector<Scalar> along;
  Scalar offset;

  Elimination(const ProgramRow<Scalar>& row, std::size_t count) : variables(count) {
    for (std::size_t k = 1; k < variables; ++k) {
      if (std::abs(head(row.a[k])) > std::abs(head(row.a[pivot]))) pivot = k;
    }
    for (std::size_t k = 0, to = 0; k < variables; ++k) {
      if (k != pivot) along[to++] = row.a[k] / row.a[pivot];
    }
    offset = row.b / row.a[pivot];
  }
  /// The linear form `v` on the plane, but for its constant v_pivot * offset.
  void restrict(const ProgramVector<Scalar>& v, ProgramVector<Scalar>& r) const {
    const Scalar at = v[pivot];
    for (std::size_t k = 0; k < pivot; ++k) r[k] = v[k] - at * along[k];
    for (std::size_t k = pivot + 1; k < variables; ++k) r[k - 1] = v[k] - at * along[k - 1];
  }
  void lift(const ProgramVector<Scalar>& y, ProgramVector<Scalar>& x) const {
    for (std::size_t k = 0, from = 0; k < variables; ++k) {
      if (k != pivot) x[k] = y[from++];
    }
    x[pivot] = offset - dot(along, y, variables - 1);
  }
};

/// The program in one variable.
template <typename Scalar>
bool maximise_on_line(const std::vector<ProgramRow<Scalar>>& rows, const Scalar& objective, double bound, double slack,
                      Scalar& x) {
  Scalar low{-bound}, high{bound};
  for (const ProgramRow<Scalar>& row : rows) {
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
  x = head(objective) >= 0 ? high : low;
  return true;
}

/// False when no x keeps all rows.
template <typename Scalar>
bool maximise(const std::vector<ProgramRow<Scalar>>& rows, std::size_t variables,
              const ProgramVector<Scalar>& objective, double bound, double slack, ProgramVector<Scalar>& x) {
  if (variables == 1) return maximise_on_line(rows, objective[0], bound, slack, x[0]);
  for (std::size_t k = 0; k < variables; ++k) x[k] = Scalar{head(objective[k]) >= 0 ? bound : -bound};
  std::vector<ProgramRow<Scalar>> below;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (head(dot(rows[i].a, x, variables) - rows[i].b) <= slack * magnitude(rows[i].a, x, variables)) continue;
    const Elimination<Scalar> plane(rows[i], variables);
    if (std::abs(head(rows[i].a[plane.pivot])) <= slack) return false;
    below.clear();
    ProgramVector<Scalar> opposite;
    for (std::size_t k = 0; k + 1 < variables; ++k) opposite[k] = -plane.along[k];
    below.push_back({opposite, Scalar{bound} - plane.offset});
    below.push_back({plane.along, Scalar{bound} + plane.offset});
    for (std::size_t j = 0; j < i; ++j) {
      ProgramRow<Scalar> row;
      plane.restrict(rows[j].a, row.a);
      row.b = rows[j].b - rows[j].a[plane.pivot] * plane.offset;
      const Scalar length = root(dot(row.a, row.a, variables - 1));
      if (head(length) <= slack) {
        // Parallel to row i.
        if (head(row.b) < -slack * (1 + std::abs(head(rows[j].b)))) return false;
        continue;
      }
      for (std::size_t k = 0; k + 1 < variables; ++k) row.a[k] = row.a[k] / length;
      row.b = row.b / length;
      below.push_back(row);
    }
    ProgramVector<Scalar> y, restricted;
    plane.restrict(objective, restricted);
    if (!maximise(below, variables - 1, restricted, bound, slack, y)) return false;
    plane.lift(y, x);
  }
  return true;
}

}  // namespace pd::dimension::detail
