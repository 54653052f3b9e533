#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

LiftedMatrix product(const LiftedMatrix& left, const LiftedMatrix& right) {
  LiftedMatrix r = LiftedMatrix::Zero(left.rows(), right.cols());
  for (Eigen::Index column = 0; column < right.cols(); ++column) {
    for (Eigen::Index k = 0; k < left.cols(); ++k)
      add_scaled(&r(0, column), right(k, column), &left(0, k), left.rows());
  }
  return r;
}

/// The rows of [root, scale more] are orthogonalised, twice each.
void add_to_root(LiftedMatrix& root, double scale, const LiftedMatrix& more) {
  const Eigen::Index n = root.rows();
  // A row of [root, scale more] is a column here.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign, 2 * kMaxLiftedDimension, kMaxLiftedDimension>
      q(n + more.cols(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) q(k, i) = root(i, k);
    for (Eigen::Index k = 0; k < more.cols(); ++k) q(n + k, i) = scale * more(i, k);
  }
  root.setZero();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int turn = 0; turn < 2; ++turn) {
      for (Eigen::Index j = 0; j < i; ++j) {
        const double part = dot(&q(0, j), &q(0, i), q.rows());
        root(i, j) += part;
        add_scaled(&q(0, i), -part, &q(0, j), q.rows());
      }
    }
    root(i, i) = q.col(i).norm();
    if (root(i, i) > 0) q.col(i) /= root(i, i);
  }
}

}  // namespace pd::dimension::detail
