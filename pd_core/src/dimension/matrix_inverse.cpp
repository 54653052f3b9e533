#include "pd/dimension/matrix_inverse.hpp"

#include <limits>

#include "numeric/small_decompositions.hpp"

namespace pd::dimension {

template <int D>
Matrix<D> inverse_of(const Matrix<D>& matrix) {
  Matrix<D> inverse;
  pd::detail::SmallElimination(matrix.data(), D).inverse(inverse.data());
  return inverse;
}

template <int D>
std::optional<Matrix<D>> inverse_if_regular(const Matrix<D>& matrix) {
  const pd::detail::SmallElimination elimination(matrix.data(), D);
  if (!elimination.regular(D * std::numeric_limits<double>::epsilon())) return std::nullopt;
  Matrix<D> inverse;
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
#undef PD_INSTANTIATE

}  // namespace pd::dimension
