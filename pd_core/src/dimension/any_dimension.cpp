#include "dimension/any_dimension.hpp"

#include <type_traits>

namespace pd::dimension::detail {

namespace {

/// Calls `f` with the dimension as a constant.
template <class Function>
auto with_dimension(Eigen::Index dimension, const Function& f) {
  switch (dimension) {
    case 2:
      return f(std::integral_constant<int, 2>());
    case 3:
      return f(std::integral_constant<int, 3>());
    case 4:
      return f(std::integral_constant<int, 4>());
    default:
      return f(std::integral_constant<int, 5>());
  }
}

}  // namespace

AnyVector in_frame(const AnyMatrix& linear, const AnyVector& centre, const double* point) {
  AnyVector r(centre.size());
  with_dimension(centre.size(), [&](auto d) {
    using Fixed = Eigen::Map<const Vector<d>>;
    Eigen::Map<Vector<d>>(r.data()) =
        Eigen::Map<const Matrix<d>>(linear.data()) * (Fixed(point) - Fixed(centre.data()));
  });
  return r;
}

double quadratic(const AnyMatrix& m, const AnyVector& v) {
  return with_dimension(v.size(), [&](auto d) -> double {
    const Eigen::Map<const Vector<d>> fixed(v.data());
    return fixed.dot(Eigen::Map<const Matrix<d>>(m.data()) * fixed);
  });
}

}  // namespace pd::dimension::detail
