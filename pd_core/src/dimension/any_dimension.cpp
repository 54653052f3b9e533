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
    double from_centre[d];
    for (int k = 0; k < d; ++k) from_centre[k] = point[k] - centre[k];
    Eigen::Map<Vector<d>>(r.data()) = image<d>(linear.data(), from_centre);
  });
  return r;
}

double quadratic(const AnyMatrix& m, const AnyVector& v) {
  return with_dimension(v.size(), [&](auto d) {
    const Vector<d> along = image<d>(m.data(), v.data());
    double sum = 0;
    for (int k = 0; k < d; ++k) sum += along[k] * v[k];
    return sum;
  });
}

}  // namespace pd::dimension::detail
