#include "dimension/backends/macbeath_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

/// Ellipsoids through Khachiyan's ascent are taken once they are within this factor of the optimal d, squared.
constexpr double kRoundness = 1.25;

template <int D>
double square(const Matrix<D>& m, const Vector<D>& v) {
  return v.dot(m * v);
}

}  // namespace

template <int D>
ShadowCone<D> MacbeathRegion<D>::shadow(double c) const {
  // The ray t v meets {x + z : z' A z <= c^2} where (v'Ax)^2 >= v'Av (x'Ax - c^2).
  ShadowCone<D> r;
  r.axis = ellipsoid * center;
  const double beyond = center.dot(r.axis) - c * c;
  r.everything = beyond <= 0;
  r.form = r.axis * r.axis.transpose() - beyond * ellipsoid;
  return r;
}

template <int D>
std::int32_t PolarBody<D>::extreme(const Vector<D>& v) const {
  std::int32_t best = 0;
  double reach = v.dot(points_[0]);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double at = v.dot(points_[i]);
    if (at > reach) {
      reach = at;
      best = static_cast<std::int32_t>(i);
    }
  }
  return best;
}

/// The largest ellipsoid in slabs is polar to the smallest one about the points a = slab(p) and -a: its weights by
/// Khachiyan's ascent (see enclosing_ellipsoid.hpp).
template <int D>
template <class Slab>
Matrix<D> PolarBody<D>::ellipsoid_in(const Slab& slab, std::span<const std::int32_t> candidates) const {
  std::vector<Vector<D>> slabs;
  slabs.reserve(candidates.size());
  for (const std::int32_t p : candidates) slabs.push_back(slab(p));
  // The start: D points, each the farthest in a direction orthogonal to those before (Kumar and Yildirim).
  Matrix<D> moment = Matrix<D>::Zero();
  Matrix<D> basis = Matrix<D>::Zero();
  for (int k = 0; k < D; ++k) {
    Vector<D> direction = Vector<D>::Zero();
    for (int i = 0; i < D; ++i) {
      const Vector<D> rest = Vector<D>::Unit(i) - basis * basis.row(i).transpose();
      if (rest.squaredNorm() > direction.squaredNorm()) direction = rest;
    }
    Vector<D> far = Vector<D>::Zero();
    double most = -1;
    for (const Vector<D>& a : slabs) {
      const double at = std::abs(a.dot(direction));
      if (at > most) {
        most = at;
        far = a;
      }
    }
    moment += far * far.transpose() / D;
    Vector<D> rest = far - basis * (basis.transpose() * far);
    rest -= basis * (basis.transpose() * rest);
    basis.col(k) = rest / rest.norm();
  }
  Matrix<D> inverse = inverse_of<D>(moment);
  constexpr int kSteps = 60;
  std::vector<double> values(slabs.size());
  for (int step = 0; step < kSteps; ++step) {
    double most = 0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      values[i] = square<D>(inverse, slabs[i]);
      if (values[i] > most) {
        most = values[i];
        far = i;
      }
    }
    if (most <= kRoundness * D) break;
    const double share = (most / D - 1) / (most - 1);
    moment = (1 - share) * moment + share * slabs[far] * slabs[far].transpose();
    inverse = inverse_of<D>(moment);
    // What carries no weight at the optimum is left out (Harman and Pronzato 2007).
    const double gap = most / D - 1;
    const double least = D * (1 + 0.5 * (gap - std::sqrt(gap * (4 + gap - 4.0 / D))));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      if (values[i] >= least) slabs[kept++] = slabs[i];
    }
    slabs.resize(kept);
  }
  double most = 0;  // whatever the weights: E = {z : z' moment z <= 1 / most} lies in every slab
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Vector<D> a = slab(static_cast<std::int32_t>(p));
    most = std::max(most, square<D>(inverse, a));
  }
  return moment * most;
}

template <int D>
MacbeathRegion<D> PolarBody<D>::region(const Vector<D>& v, double delta,
                                       std::span<const std::int32_t> candidates) const {
  MacbeathRegion<D> r;
  r.point = extreme(v);
  r.center = v * ((1 - delta) / v.dot(points_[r.point]));
  const auto slab = [&](std::int32_t p) -> Vector<D> { return points_[p] / (1 - points_[p].dot(r.center)); };
  r.ellipsoid = ellipsoid_in(slab, candidates);
  return r;
}

template <int D>
MacbeathRegion<D> PolarBody<D>::answering_region(const Vector<D>& v, double depth, double epsilon,
                                                 std::span<const std::int32_t> candidates) const {
  MacbeathRegion<D> r;
  r.point = extreme(v);
  const Vector<D>& q = points_[r.point];
  r.center = v * ((1 - depth) / v.dot(q));
  const auto lead = [&](const Vector<D>& p) -> Vector<D> { return q - (1 - epsilon) * p; };
  const auto slab = [&](std::int32_t p) -> Vector<D> {
    if (p == r.point) return q / depth;
    const Vector<D> w = lead(points_[p]);
    return w / w.dot(r.center);
  };
  r.ellipsoid = ellipsoid_in(slab, candidates);
  // Over x + {z : z' A z <= c^2}, and so over its shadow, <w, y> >= 0 where <w, x>^2 >= c^2 w' A^-1 w.
  const Matrix<D> inverse = inverse_of<D>(r.ellipsoid);
  double scale_squared = std::numeric_limits<double>::infinity();
  for (const Vector<D>& p : points_) {
    const Vector<D> w = lead(p);
    const double height = w.dot(r.center);
    scale_squared = std::min(scale_squared, height * height / square<D>(inverse, w));
  }
  constexpr double kRoom = 1e-9;
  r.ellipsoid /= scale_squared * (1 - kRoom);
  return r;
}

template <int D>
std::vector<std::int32_t> PolarBody<D>::neighbours(const MacbeathRegion<D>& region,
                                                   std::span<const std::int32_t> candidates) const {
  // A deeper region in the shadow is centred at s (x + z), z in the ellipsoid, 1 <= s <= <q, hit> / ..., and reaches at
  // most twice as far as this region's slabs do, which end within sqrt(roundness d) of the ellipsoid.
  const double reach = 1 + 2.5 * std::sqrt(kRoundness * D);
  const Matrix<D> inverse = inverse_of<D>(region.ellipsoid);
  const double depth = region.center.dot(points_[region.point]);  // 1 - delta
  std::vector<std::int32_t> r;
  for (const std::int32_t p : candidates) {
    const double along = points_[p].dot(region.center);
    const double outwards = std::max(along, along / std::max(depth, 0.25));
    if (outwards + reach * std::sqrt(square<D>(inverse, points_[p])) >= 1) r.push_back(p);
  }
  return r;
}

#define PD_INSTANTIATE(D)            \
  template struct MacbeathRegion<D>; \
  template class PolarBody<D>;
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
