/// @file
/// Decompositions of small matrices, judged by the matrix they come from.

#include "numeric/small_decompositions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

namespace pd::detail {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix random_matrix(int size, std::mt19937_64& random) {
  std::uniform_real_distribution<double> entry(-1, 1);
  return Matrix::NullaryExpr(size, size, [&] { return entry(random); });
}

TEST(SmallElimination, SolvesAndInvertsEverySize) {
  std::mt19937_64 random(7);
  for (int size = 1; size <= kSmallSize; ++size) {
    for (int run = 0; run < 200; ++run) {
      const Matrix matrix = random_matrix(size, random);
      const SmallElimination elimination(matrix.data(), size);
      if (!elimination.regular(1e-3)) continue;
      Matrix inverse(size, size);
      elimination.inverse(inverse.data());
      EXPECT_LE((matrix * inverse - Matrix::Identity(size, size)).norm(), 1e-11) << matrix;
      const Eigen::VectorXd expected = random_matrix(size, random).col(0);
      Eigen::VectorXd solution = matrix * expected;
      elimination.solve(solution.data());
      EXPECT_LE((solution - expected).norm(), 1e-11) << matrix;
    }
  }
}

TEST(SmallElimination, APivotOfZeroInTheCornerIsExchanged) {
  Matrix matrix(3, 3);
  matrix << 0, 0, 2, 4, 0, 0, 0, 1, 0;
  const SmallElimination elimination(matrix.data(), 3);
  ASSERT_TRUE(elimination.regular(0.2));
  double right[3] = {6, 8, 5};
  elimination.solve(right);
  EXPECT_EQ(right[0], 2);
  EXPECT_EQ(right[1], 5);
  EXPECT_EQ(right[2], 3);
}

TEST(SmallElimination, DependentRowsAreNotRegular) {
  Matrix matrix(3, 3);
  matrix << 1, 2, 3, 4, 5, 6, 5, 7, 9;
  EXPECT_FALSE(SmallElimination(matrix.data(), 3).regular(1e-12));
  const Matrix zero = Matrix::Zero(4, 4);
  EXPECT_FALSE(SmallElimination(zero.data(), 4).regular(0));
}

TEST(SmallCholesky, FactorsAndSolvesEverySize) {
  std::mt19937_64 random(8);
  for (int size = 1; size <= kSmallSize; ++size) {
    const Matrix root = random_matrix(size, random) + 2 * Matrix::Identity(size, size);
    const Matrix matrix = root * root.transpose();
    const SmallCholesky cholesky(matrix.data(), size);
    ASSERT_TRUE(cholesky.positive());
    const Eigen::Map<const Matrix> lower(cholesky.lower(), size, size);
    EXPECT_LE((lower * lower.transpose() - matrix).norm(), 1e-13 * matrix.norm());
    EXPECT_TRUE(lower.isLowerTriangular());
    const Eigen::VectorXd expected = random_matrix(size, random).col(0);
    Eigen::VectorXd solution = lower * expected;
    cholesky.solve_lower(solution.data());
    EXPECT_LE((solution - expected).norm(), 1e-12);
  }
}

TEST(SmallCholesky, IndefiniteMatricesAreRefused) {
  Matrix matrix(2, 2);
  matrix << 1, 2, 2, 1;
  EXPECT_FALSE(SmallCholesky(matrix.data(), 2).positive());
  matrix << 1, 1, 1, 1;
  EXPECT_FALSE(SmallCholesky(matrix.data(), 2).positive());
}

void expect_singular_values(const Matrix& matrix) {
  const int size = static_cast<int>(matrix.rows());
  const SmallSingularValues singular(matrix.data(), size);
  const Eigen::Map<const Matrix> left(singular.scaled_left(), size, size), right(singular.right(), size, size);
  EXPECT_LE((left * right.transpose() - matrix).norm(), 1e-14 * matrix.norm()) << matrix;
  EXPECT_LE((right.transpose() * right - Matrix::Identity(size, size)).norm(), 1e-14) << matrix;
  for (int k = 0; k < size; ++k) {
    EXPECT_NEAR(left.col(k).stableNorm(), singular.value(k), 1e-15 * singular.value(0)) << matrix;
    EXPECT_LE(singular.value(k), singular.value(std::max(k - 1, 0))) << matrix;
    for (int j = 0; j < k; ++j) {
      const double product = left.col(j).stableNormalized().dot(left.col(k).stableNormalized());
      EXPECT_LE(std::abs(product), 1e-14) << matrix;
    }
  }
}

TEST(SmallSingularValues, ColumnsAreOrthogonalAndGiveTheMatrixBack) {
  std::mt19937_64 random(9);
  for (int size = 1; size <= kSmallSize; ++size) {
    for (int run = 0; run < 100; ++run) expect_singular_values(random_matrix(size, random));
    expect_singular_values(Matrix::Identity(size, size));
    expect_singular_values(Matrix::Ones(size, size));
  }
  expect_singular_values(1e90 * random_matrix(4, random));
  expect_singular_values(1e-90 * random_matrix(4, random));
}

TEST(SmallSingularValues, SmallValuesKeepTheirDigits) {
  Matrix matrix(2, 2);
  matrix << 1, 1e-12, 0, 1e-12;
  const SmallSingularValues singular(matrix.data(), 2);
  // The product of the values is the determinant.
  EXPECT_NEAR(singular.value(0) * singular.value(1) / 1e-12, 1, 1e-15);
}

}  // namespace
}  // namespace pd::detail
