#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

AnyVector in_frame(const AnyMatrix& linear, const AnyVector& centre, const double* point) {
  AnyVector r(centre.size());
  with_dimension(centre.size(), [&](auto d) {
    double from_centre[d];
    for (int k = 0; k < d; ++k) from_centre[k] = point[k] - centre[k];
    Eigen::Map<Vector<d>>(r.data()) = image<d>(linear.data(), from_centre);
  });
  return r;
}

double quadratic(const AnyMatrix& m, const double* v) {
  return with_dimension(m.rows(), [&](auto d) {
    const Vector<d> along = image<d>(m.data(), v);
    double sum = 0;
    for (int k = 0; k < d; ++k) sum += along[k] * v[k];
    return sum;
  });
}

}  // namespace pd::dimension::detail

namespace pd::dimension {

template <>
Vector<kAnyDimension> AffineMap<kAnyDimension>::apply(const Vector<kAnyDimension>& point) const {
  Vector<kAnyDimension> r(point.size());
  detail::with_dimension(point.size(), [&](auto d) {
    const Vector<d> linear_part = detail::image<d>(linear.data(), point.data());
    for (int k = 0; k < d; ++k) r[k] = linear_part[k] + translation[k];
  });
  return r;
}

template <>
Vector<kAnyDimension> AffineMap<kAnyDimension>::pull_back(const Vector<kAnyDimension>& direction) const {
  const Eigen::Index d = direction.size();
  Vector<kAnyDimension> r(d);
  for (Eigen::Index k = 0; k < d; ++k) r[k] = detail::dot(&linear(0, k), direction.data(), d);
  return r;
}

}  // namespace pd::dimension
