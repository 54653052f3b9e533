/// @file
/// The room's own types, whose dimension is known at run time, and the border to those of a fixed dimension that users
/// see: numbers are copied here and nowhere else.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "pd/dimension/body.hpp"

namespace pd::dimension {

// Loops of fixed length stand behind these two, like behind those of one D.
template <>
Vector<kAnyDimension> AffineMap<kAnyDimension>::apply(const Vector<kAnyDimension>& point) const;
template <>
Vector<kAnyDimension> AffineMap<kAnyDimension>::pull_back(const Vector<kAnyDimension>& direction) const;

}  // namespace pd::dimension

namespace pd::dimension::detail {

using AnyVector = Vector<kAnyDimension>;
using AnyMatrix = Matrix<kAnyDimension>;
using AnyMap = AffineMap<kAnyDimension>;
using AnySandwich = Sandwich<kAnyDimension>;
using AnyHalfspace = Halfspace<kAnyDimension>;
using AnySupport = SupportPoint<kAnyDimension>;

/// <a, b> of few coordinates, for which Eigen's loops over any size take long to begin. Two sums, since an addition
/// waits for the one before.
[[gnu::always_inline]] inline double dot(const double* a, const double* b, Eigen::Index size) {
  double even = 0, odd = 0;
  for (Eigen::Index k = 1; k < size; k += 2) {
    even += a[k - 1] * b[k - 1];
    odd += a[k] * b[k];
  }
  return size % 2 == 0 ? even + odd : even + odd + a[size - 1] * b[size - 1];
}
/// to += scale * from
inline void add_scaled(double* to, double scale, const double* from, Eigen::Index size) {
  for (Eigen::Index k = 0; k < size; ++k) to[k] += scale * from[k];
}

/// Calls `f` with the dimension as a constant: for loops that run millions of times, which have a fixed length then.
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

/// matrix * x of D x D and D numbers.
template <int D>
Vector<D> image(const double* matrix, const double* x) {
  return Eigen::Map<const Matrix<D>>(matrix) * Eigen::Map<const Vector<D>>(x);
}
/// Makes m + scale v v^T of m; one family of expressions less than Eigen's outer product.
inline void add_outer(AnyMatrix& m, double scale, const AnyVector& v) {
  for (Eigen::Index k = 0; k < v.size(); ++k) add_scaled(&m(0, k), scale * v[k], v.data(), v.size());
}
/// linear * (point - centre), the step of every pass over points: in loops of fixed length, like those of one D.
AnyVector in_frame(const AnyMatrix& linear, const AnyVector& centre, const double* point);

/// v' m v, in such loops, too.
double quadratic(const AnyMatrix& m, const double* v);

inline AnyMap identity_map(int dimension) {
  return {AnyMatrix::Identity(dimension, dimension), AnyVector::Zero(dimension)};
}

/// Points of one dimension at equal distances in memory; not owned.
class Points {
 public:
  template <int D>
  Points(std::span<const Vector<D>> points)  // NOLINT(google-explicit-constructor): a span of another kind
      : Points(points.empty() ? nullptr : points[0].data(), points.size(), sizeof(Vector<D>),
               D != kAnyDimension ? D
               : points.empty()   ? 0
                                  : static_cast<int>(points[0].size())) {}
  template <int D, class Allocator>
  Points(const std::vector<Vector<D>, Allocator>& points)  // NOLINT(google-explicit-constructor)
      : Points(std::span<const Vector<D>>(points)) {}

  /// @param stride  bytes from one point to the next
  Points(const double* first, std::size_t size, std::size_t stride, int dimension)
      : first_(first), size_(size), stride_(stride / sizeof(double)), dimension_(dimension) {}

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const double* data(std::size_t i) const { return first_ + i * stride_; }
  [[nodiscard]] Eigen::Map<const AnyVector> operator[](std::size_t i) const {
    return Eigen::Map<const AnyVector>(data(i), dimension_);
  }
  [[nodiscard]] Points part(std::size_t from, std::size_t count) const {
    return {data(from), count, stride_ * sizeof(double), dimension_};
  }

 private:
  const double* first_;
  std::size_t size_;
  std::size_t stride_;
  int dimension_;
};

/// Halfspaces of one dimension; not owned.
struct Halfspaces {
  Points normals;
  Points offsets;  ///< of one number each

  template <int D>
  Halfspaces(std::span<const Halfspace<D>> h)  // NOLINT(google-explicit-constructor): a span of another kind
      : normals(h.empty() ? nullptr : h[0].normal.data(), h.size(), sizeof(Halfspace<D>),
                D != kAnyDimension ? D
                : h.empty()        ? 0
                                   : static_cast<int>(h[0].normal.size())),
        offsets(h.empty() ? nullptr : &h[0].offset, h.size(), sizeof(Halfspace<D>), 1) {}

  [[nodiscard]] int dimension() const { return normals.dimension(); }
  [[nodiscard]] std::size_t size() const { return normals.size(); }
  [[nodiscard]] AnyHalfspace operator[](std::size_t i) const { return {normals[i], offset(i)}; }
  [[nodiscard]] double offset(std::size_t i) const { return *offsets.data(i); }
};

/// A body: a view of a `Body<D>`, or one with a storage of its own.
struct AnyBody {
  Representation representation;
  Points points;
  Halfspaces halfspaces;
  AnySandwich sandwich;
  std::shared_ptr<const void> storage;  ///< kept alive; none of a view

  /// `Body<D>::from_points`
  static Expected<AnyBody> of(std::vector<AnyVector> points);
  /// `Body<D>::from_halfspaces`
  static Expected<AnyBody> of(std::vector<AnyHalfspace> halfspaces);

  [[nodiscard]] int dimension() const { return static_cast<int>(sandwich.centre.size()); }
  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(points.size() + halfspaces.size()); }
  [[nodiscard]] AnySupport support(const AnyVector& direction) const;
};

template <int D>
AnyVector any(const Vector<D>& v) {
  return Eigen::Map<const AnyVector>(v.data(), D);
}
template <int D>
AnyMatrix any(const Matrix<D>& m) {
  return Eigen::Map<const AnyMatrix>(m.data(), D, D);
}
template <int D>
AnyMap any(const AffineMap<D>& map) {
  return {any<D>(map.linear), any<D>(map.translation)};
}
template <int D>
AnySandwich any(const Sandwich<D>& sandwich) {
  return {any<D>(sandwich.centre), any<D>(sandwich.axes), sandwich.ratio};
}

template <int D>
AnyBody any(const Body<D>& body) {
  return {body.representation(), body.points(), body.halfspaces(), any<D>(body.sandwich()), nullptr};
}

/// Requires D numbers.
template <int D>
Vector<D> fixed(const AnyVector& v) {
  Vector<D> r;
  std::copy_n(v.data(), D, r.data());
  return r;
}
template <int D>
Matrix<D> fixed(const AnyMatrix& m) {
  Matrix<D> r;
  std::copy_n(m.data(), D * D, r.data());
  return r;
}
template <int D>
Sandwich<D> fixed(const AnySandwich& sandwich) {
  return {fixed<D>(sandwich.centre), fixed<D>(sandwich.axes), sandwich.ratio};
}
template <int D>
SupportPoint<D> fixed(const AnySupport& p) {
  return {fixed<D>(p.point), p.value, p.index};
}
template <int D>
std::vector<Vector<D>> fixed(const std::vector<AnyVector>& points) {
  std::vector<Vector<D>> r;
  r.reserve(points.size());
  for (const AnyVector& p : points) r.push_back(fixed<D>(p));
  return r;
}
template <int D>
std::vector<Halfspace<D>> fixed(const std::vector<AnyHalfspace>& halfspaces) {
  std::vector<Halfspace<D>> r;
  r.reserve(halfspaces.size());
  for (const AnyHalfspace& h : halfspaces) r.push_back({fixed<D>(h.normal), h.offset});
  return r;
}

}  // namespace pd::dimension::detail
