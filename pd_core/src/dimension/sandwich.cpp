#include "pd/dimension/sandwich.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dimension/any_dimension.hpp"
#include "numeric/small_decompositions.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace {

using detail::AnyMatrix;
using detail::AnyVector;
using AnyBox = SandwichBox<kAnyDimension>;

/// Weights are as good as they get after some 50 halvings of their logarithms' error.
constexpr int kLewisSteps = 60;

FatteningMap<kAnyDimension> fatten(const std::vector<AnyBox>& boxes) {
  const int d = static_cast<int>(boxes[0].centre.size());
  AnyVector centre = AnyVector::Zero(d);
  double ratio = 1;
  std::vector<AnyVector> generators;
  for (const AnyBox& box : boxes) {
    centre += box.centre;
    ratio = std::max(ratio, box.ratio);
    for (int k = 0; k < d; ++k) generators.push_back(box.axes.col(k));
  }
  // Whitened first: needles would cost the weights their digits.
  AnyMatrix moments = AnyMatrix::Zero(d, d);
  for (const AnyVector& g : generators) detail::add_outer(moments, 1, g);
  const pd::detail::SmallSingularValues singular(moments.data(), d);
  AnyMatrix whitening = Eigen::Map<const AnyMatrix>(singular.right(), d, d).transpose();
  for (int k = 0; k < d; ++k) whitening.row(k) /= std::sqrt(std::max(singular.value(k), 1e-30 * singular.value(0)));
  for (AnyVector& g : generators) g = whitening * g;

  std::vector<double> weights(generators.size(), 1);
  AnyMatrix metric(d, d);
  double lower = 0, total = 0;
  for (int step = 0; step < kLewisSteps; ++step) {
    metric.setZero();
    for (std::size_t i = 0; i < generators.size(); ++i) {
      if (weights[i] > 0) detail::add_outer(metric, 1 / weights[i], generators[i]);
    }
    const AnyMatrix inverse = inverse_of<kAnyDimension>(metric);
    lower = 1;
    total = 0;
    std::vector<double> next;
    for (std::size_t i = 0; i < generators.size(); ++i) {
      next.push_back(std::sqrt(detail::quadratic(inverse, generators[i].data())));
      // |v|_M <= h_Z(v) max (next / weight);  h_Z(v) <= sqrt(sum of weights) |v|_M.
      if (weights[i] > 0) lower = std::max(lower, next[i] / weights[i]);
      total += weights[i];
    }
    if (step + 1 < kLewisSteps) weights = next;
  }
  // The ellipsoid {metric^(1/2) u} / lower lies in the zonotope.
  const pd::detail::SmallCholesky root(metric.data(), d);
  for (int k = 0; k < d; ++k) root.solve_lower(whitening.col(k).data());
  const AnyMatrix linear = lower * whitening;
  return {{linear, -(linear * centre)}, ratio * lower * std::sqrt(total) * (1 + 1e-9)};
}

}  // namespace

template <int D>
SandwichBox<D> sandwich_box(const Sandwich<D>& ellipsoid) {
  const Eigen::Index d = ellipsoid.axes.rows();
  const pd::detail::SmallSingularValues singular(ellipsoid.axes.data(), static_cast<int>(d));
  SandwichBox<D> box;
  box.centre = ellipsoid.centre;
  box.axes = Eigen::Map<const Matrix<D>>(singular.scaled_left(), d, d) / std::sqrt(static_cast<double>(d));
  box.ratio = ellipsoid.ratio * std::sqrt(static_cast<double>(d));
  return box;
}

template <int D>
FatteningMap<D> fatten_sum(std::span<const SandwichBox<D>> boxes) {
  std::vector<AnyBox> any;
  for (const SandwichBox<D>& box : boxes)
    any.push_back({detail::any<D>(box.centre), detail::any<D>(box.axes), box.ratio});
  const FatteningMap<kAnyDimension> r = fatten(any);
  return {{detail::fixed<D>(r.map.linear), detail::fixed<D>(r.map.translation)}, r.outer_radius};
}

template SandwichBox<kAnyDimension> sandwich_box<kAnyDimension>(const detail::AnySandwich&);
#define PD_INSTANTIATE(D)                                      \
  template SandwichBox<D> sandwich_box<D>(const Sandwich<D>&); \
  template FatteningMap<D> fatten_sum<D>(std::span<const SandwichBox<D>>);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
