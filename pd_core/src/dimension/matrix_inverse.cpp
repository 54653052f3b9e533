#include "pd/dimension/matrix_inverse.hpp"

#include <Eigen/LU>

namespace pd::dimension {

template <int D>
Matrix<D> inverse_of(const Matrix<D>& matrix) {
  return matrix.inverse();
}

template <int D>
std::optional<Matrix<D>> inverse_if_regular(const Matrix<D>& matrix) {
  const Eigen::FullPivLU<Eigen::Matrix<double, D, D>> decomposition(matrix);
  if (!decomposition.isInvertible()) return std::nullopt;
  return Matrix<D>(decomposition.inverse());
}

#define PD_INSTANTIATE(D)                             \
  template Matrix<D> inverse_of<D>(const Matrix<D>&); \
  template std::optional<Matrix<D>> inverse_if_regular<D>(const Matrix<D>&);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
