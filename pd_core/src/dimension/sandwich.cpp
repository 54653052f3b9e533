#include "pd/dimension/sandwich.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/small_decompositions.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace {

/// Weights are as good as they get after some 50 halvings of their logarithms' error.
constexpr int kLewisSteps = 60;

}  // namespace

template <int D>
SandwichBox<D> sandwich_box(const Sandwich<D>& ellipsoid) {
  const pd::detail::SmallSingularValues singular(ellipsoid.axes.data(), D);
  SandwichBox<D> box;
  box.centre = ellipsoid.centre;
  box.axes = Eigen::Map<const Matrix<D>>(singular.scaled_left()) / std::sqrt(static_cast<double>(D));
  box.ratio = ellipsoid.ratio * std::sqrt(static_cast<double>(D));
  return box;
}

template <int D>
FatteningMap<D> fatten_sum(std::span<const SandwichBox<D>> boxes) {
  Vector<D> centre = Vector<D>::Zero();
  double ratio = 1;
  std::vector<Vector<D>> generators;
  for (const SandwichBox<D>& box : boxes) {
    centre += box.centre;
    ratio = std::max(ratio, box.ratio);
    for (int k = 0; k < D; ++k) generators.push_back(box.axes.col(k));
  }
  // Whitened first: needles would cost the weights their digits.
  Matrix<D> moments = Matrix<D>::Zero();
  for (const Vector<D>& g : generators) moments += g * g.transpose();
  const pd::detail::SmallSingularValues singular(moments.data(), D);
  Matrix<D> whitening = Eigen::Map<const Matrix<D>>(singular.right()).transpose();
  for (int k = 0; k < D; ++k) whitening.row(k) /= std::sqrt(std::max(singular.value(k), 1e-30 * singular.value(0)));
  for (Vector<D>& g : generators) g = whitening * g;

  std::vector<double> weights(generators.size(), 1);
  Matrix<D> metric;
  double lower = 0, total = 0;
  for (int step = 0; step < kLewisSteps; ++step) {
    metric.setZero();
    for (std::size_t i = 0; i < generators.size(); ++i) {
      if (weights[i] > 0) metric += generators[i] * generators[i].transpose() / weights[i];
    }
    const Matrix<D> inverse = inverse_of<D>(metric);
    lower = 1;
    total = 0;
    std::vector<double> next;
    for (std::size_t i = 0; i < generators.size(); ++i) {
      next.push_back(std::sqrt(generators[i].dot(inverse * generators[i])));
      // |v|_M <= h_Z(v) max (next / weight);  h_Z(v) <= sqrt(sum of weights) |v|_M.
      if (weights[i] > 0) lower = std::max(lower, next[i] / weights[i]);
      total += weights[i];
    }
    if (step + 1 < kLewisSteps) weights = next;
  }
  // The ellipsoid {metric^(1/2) u} / lower lies in the zonotope.
  const pd::detail::SmallCholesky root(metric.data(), D);
  for (int k = 0; k < D; ++k) root.solve_lower(whitening.col(k).data());
  FatteningMap<D> r;
  r.map.linear = lower * whitening;
  r.map.translation = -(r.map.linear * centre);
  r.outer_radius = ratio * lower * std::sqrt(total) * (1 + 1e-9);
  return r;
}

#define PD_INSTANTIATE(D)                                      \
  template SandwichBox<D> sandwich_box<D>(const Sandwich<D>&); \
  template FatteningMap<D> fatten_sum<D>(std::span<const SandwichBox<D>>);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
