#include "pd/dimension/matrix_inverse.hpp"

#include <limits>

#include "numeric/small_decompositions.hpp"

namespace pd::dimension {

template <int D>
Matrix<D> inverse_of(const Matrix<D>& matrix) {
  Matrix<D> inverse = matrix;
  pd::detail::SmallElimination(matrix.data(), static_cast<int>(matrix.rows())).inverse(inverse.data());
  return inverse;
}

template <int D>
std::optional<Matrix<D>> inverse_if_regular(const Matrix<D>& matrix) {
  const int size = static_cast<int>(matrix.rows());
  const pd::detail::SmallElimination elimination(matrix.data(), size);
  if (!elimination.regular(size * std::numeric_limits<double>::epsilon())) return std::nullopt;
  Matrix<D> inverse = matrix;
  elimination.inverse(inverse.data());
  return inverse;
}

#define PD_INSTANTIATE(D)                             \
  template Matrix<D> inverse_of<D>(const Matrix<D>&); \
  template std::optional<Matrix<D>> inverse_if_regular<D>(const Matrix<D>&);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
PD_INSTANTIATE(kAnyDimension)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
