/// @file
/// Decompositions of n x n matrices, n <= 6, whose size is known at run time. Matrices are given and written column by
/// column.
///
/// Eigen's decompositions are templates over the size, and each instance costs the compiler several seconds. Matrices
/// of this size are decomposed a few times a query, so plain loops serve them all.
#pragma once

namespace pd::detail {

inline constexpr int kSmallSize = 6;

/// Gaussian elimination with full pivoting.
class SmallElimination {
 public:
  /// O(n^3)
  SmallElimination(const double* matrix, int size);

  /// Tells whether every pivot exceeds `threshold` times the largest one, which is the first.
  [[nodiscard]] bool regular(double threshold) const;

  /// Replaces the right-hand side by the solution. Requires a regular matrix; otherwise the numbers may be infinite or
  /// NaN. O(n^2).
  void solve(double* right) const;

  /// Writes the inverse. Requires a regular matrix, as `solve` does. O(n^3).
  void inverse(double* out) const;

 private:
  [[nodiscard]] double& entry(int row, int column) { return factors_[row + size_ * column]; }
  [[nodiscard]] double entry(int row, int column) const { return factors_[row + size_ * column]; }
  void bring_pivot(int step);
  void eliminate(int step);

  int size_;
  double factors_[kSmallSize * kSmallSize] = {};  ///< L below the diagonal, where its own is 1, and U
  int rows_[kSmallSize] = {};                     ///< the row that was exchanged with row k in step k
  int columns_[kSmallSize] = {};                  ///< the column that was exchanged with column k in step k
};

/// The Cholesky factor L of a symmetric positive definite matrix, L L^T.
class SmallCholesky {
 public:
  /// Reads the lower triangle. O(n^3)
  SmallCholesky(const double* matrix, int size);

  /// False where a pivot is not positive; the factor is then of no use.
  [[nodiscard]] bool positive() const { return positive_; }

  /// L with zeros above its diagonal.
  [[nodiscard]] const double* lower() const { return lower_; }

  /// Replaces the right-hand side by L^-1 times it. O(n^2)
  void solve_lower(double* right) const;

 private:
  int size_;
  bool positive_ = true;
  double lower_[kSmallSize * kSmallSize] = {};
};

/// The singular value decomposition A = U S V^T by one-sided Jacobi rotations (Hestenes 1958): columns of A V are
/// turned in pairs until all are orthogonal. Small singular values keep their relative accuracy. Values come in
/// descending order.
class SmallSingularValues {
 public:
  /// O(n^3) a sweep, of which some six suffice.
  SmallSingularValues(const double* matrix, int size);

  /// U S: orthogonal columns, whose lengths are the singular values.
  [[nodiscard]] const double* scaled_left() const { return columns_; }
  /// V, orthogonal.
  [[nodiscard]] const double* right() const { return right_; }
  [[nodiscard]] double value(int k) const { return values_[k]; }

 private:
  [[nodiscard]] bool turn_pair(int first, int second);
  void sort();

  int size_;
  double columns_[kSmallSize * kSmallSize] = {};
  double right_[kSmallSize * kSmallSize] = {};
  double values_[kSmallSize] = {};
};

}  // namespace pd::detail
