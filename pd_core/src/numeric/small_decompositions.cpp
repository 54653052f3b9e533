#include "numeric/small_decompositions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pd::detail {

SmallElimination::SmallElimination(const double* matrix, int size) : size_(size) {
  std::copy(matrix, matrix + size * size, factors_);
  for (int step = 0; step < size; ++step) {
    bring_pivot(step);
    if (entry(step, step) != 0) eliminate(step);
  }
}

/// Exchanges rows and columns so that the largest remaining entry stands in the diagonal.
void SmallElimination::bring_pivot(int step) {
  int row = step, column = step;
  for (int j = step; j < size_; ++j) {
    for (int i = step; i < size_; ++i) {
      if (std::abs(entry(i, j)) > std::abs(entry(row, column))) row = i, column = j;
    }
  }
  rows_[step] = row;
  columns_[step] = column;
  for (int j = 0; j < size_; ++j) std::swap(entry(step, j), entry(row, j));
  for (int i = 0; i < size_; ++i) std::swap(entry(i, step), entry(i, column));
}

void SmallElimination::eliminate(int step) {
  for (int i = step + 1; i < size_; ++i) {
    entry(i, step) /= entry(step, step);
    for (int j = step + 1; j < size_; ++j) entry(i, j) -= entry(i, step) * entry(step, j);
  }
}

bool SmallElimination::regular(double threshold) const {
  const double least = threshold * std::abs(entry(0, 0));
  for (int k = 0; k < size_; ++k) {
    if (!(std::abs(entry(k, k)) > least)) return false;
  }
  return true;
}

void SmallElimination::solve(double* right) const {
  // All exchanges first: rows of L were exchanged with those of the matrix.
  for (int k = 0; k < size_; ++k) std::swap(right[k], right[rows_[k]]);
  for (int k = 0; k < size_; ++k) {
    for (int i = k + 1; i < size_; ++i) right[i] -= entry(i, k) * right[k];
  }
  for (int k = size_ - 1; k >= 0; --k) {
    for (int j = k + 1; j < size_; ++j) right[k] -= entry(k, j) * right[j];
    right[k] /= entry(k, k);
  }
  for (int k = size_ - 1; k >= 0; --k) std::swap(right[k], right[columns_[k]]);
}

void SmallElimination::inverse(double* out) const {
  for (int column = 0; column < size_; ++column) {
    double* const right = out + size_ * column;
    for (int i = 0; i < size_; ++i) right[i] = i == column ? 1 : 0;
    solve(right);
  }
}

SmallCholesky::SmallCholesky(const double* matrix, int size) : size_(size) {
  for (int j = 0; j < size && positive_; ++j) {
    for (int i = j; i < size; ++i) {
      double rest = matrix[i + size * j];
      for (int k = 0; k < j; ++k) rest -= lower_[i + size * k] * lower_[j + size * k];
      if (i == j) {
        positive_ = rest > 0;
        lower_[j + size * j] = std::sqrt(rest);
      } else {
        lower_[i + size * j] = rest / lower_[j + size * j];
      }
    }
  }
}

void SmallCholesky::solve_lower(double* right) const {
  for (int i = 0; i < size_; ++i) {
    for (int k = 0; k < i; ++k) right[i] -= lower_[i + size_ * k] * right[k];
    right[i] /= lower_[i + size_ * i];
  }
}

namespace {

double dot_of_columns(const double* a, const double* b, int size) {
  double sum = 0;
  for (int i = 0; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

void turn_columns(double* a, double* b, double cosine, double sine, int size) {
  for (int i = 0; i < size; ++i) {
    const double x = a[i], y = b[i];
    a[i] = cosine * x - sine * y;
    b[i] = sine * x + cosine * y;
  }
}

}  // namespace

SmallSingularValues::SmallSingularValues(const double* matrix, int size) : size_(size) {
  const int count = size * size;
  double largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(matrix[i]));
  // Squares of the entries must neither overflow nor vanish.
  const int exponent = largest > 0 ? std::ilogb(largest) : 0;
  for (int i = 0; i < count; ++i) columns_[i] = std::ldexp(matrix[i], -exponent);
  for (int k = 0; k < size; ++k) right_[k + size * k] = 1;
  constexpr int kMaxSweeps = 40;
  bool turned = true;
  for (int sweep = 0; turned && sweep < kMaxSweeps; ++sweep) {
    turned = false;
    for (int i = 0; i < size; ++i) {
      for (int j = i + 1; j < size; ++j) turned = turn_pair(i, j) || turned;
    }
  }
  sort();
  for (int i = 0; i < count; ++i) columns_[i] = std::ldexp(columns_[i], exponent);
  for (int k = 0; k < size; ++k) values_[k] = std::ldexp(values_[k], exponent);
}

/// Makes two columns orthogonal. False where they were.
bool SmallSingularValues::turn_pair(int first, int second) {
  double* const a = columns_ + size_ * first;
  double* const b = columns_ + size_ * second;
  const double aa = dot_of_columns(a, a, size_), bb = dot_of_columns(b, b, size_), ab = dot_of_columns(a, b, size_);
  if (!(std::abs(ab) > 2 * std::numeric_limits<double>::epsilon() * std::sqrt(aa) * std::sqrt(bb))) return false;
  const double zeta = (bb - aa) / (2 * ab);
  const double tangent = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::hypot(1.0, zeta));
  const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = cosine * tangent;
  turn_columns(a, b, cosine, sine, size_);
  turn_columns(right_ + size_ * first, right_ + size_ * second, cosine, sine, size_);
  return true;
}

void SmallSingularValues::sort() {
  for (int k = 0; k < size_; ++k)
    values_[k] = std::sqrt(dot_of_columns(columns_ + size_ * k, columns_ + size_ * k, size_));
  for (int k = 0; k < size_; ++k) {
    const int largest = static_cast<int>(std::max_element(values_ + k, values_ + size_) - values_);
    std::swap(values_[k], values_[largest]);
    std::swap_ranges(columns_ + size_ * k, columns_ + size_ * (k + 1), columns_ + size_ * largest);
    std::swap_ranges(right_ + size_ * k, right_ + size_ * (k + 1), right_ + size_ * largest);
  }
}

}  // namespace pd::detail
