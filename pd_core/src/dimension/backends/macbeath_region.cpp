#include "dimension/backends/macbeath_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

/// Ellipsoids through Khachiyan's ascent are taken once they are within this factor of the optimal d, squared.
constexpr double kRoundness = 1.25;

}  // namespace

ShadowCone MacbeathRegion::shadow(double c) const {
  // The ray t v meets {x + z : z' A z <= c^2} where (v'Ax)^2 >= v'Av (x'Ax - c^2).
  ShadowCone r;
  r.axis = ellipsoid * center;
  const double beyond = center.dot(r.axis) - c * c;
  r.everything = beyond <= 0;
  r.form = -beyond * ellipsoid;
  add_outer(r.form, 1, r.axis);
  return r;
}

std::int32_t PolarBody::extreme(const AnyVector& v) const {
  std::int32_t best = 0;
  double reach = dot(v.data(), points_[0].data(), v.size());
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double at = dot(v.data(), points_[i].data(), v.size());
    if (at > reach) {
      reach = at;
      best = static_cast<std::int32_t>(i);
    }
  }
  return best;
}

/// The largest ellipsoid in slabs is polar to the smallest one about the points a = slab(p) and -a: its weights by
/// Khachiyan's ascent (see enclosing_ellipsoid.hpp).
template <class Slab>
AnyMatrix PolarBody::ellipsoid_in(const Slab& slab, std::span<const std::int32_t> candidates) const {
  const int d = dimension();
  std::vector<AnyVector> slabs(candidates.size(), AnyVector::Zero(d));
  for (std::size_t i = 0; i < slabs.size(); ++i) slab(candidates[i], slabs[i]);
  // The start: d points, each the farthest in a direction orthogonal to those before (Kumar and Yildirim).
  AnyMatrix moment = AnyMatrix::Zero(d, d);
  AnyMatrix basis = AnyMatrix::Zero(d, d);
  for (int k = 0; k < d; ++k) {
    AnyVector direction = AnyVector::Zero(d);
    for (int i = 0; i < d; ++i) {
      const AnyVector rest = AnyVector::Unit(d, i) - basis * basis.row(i).transpose();
      if (rest.squaredNorm() > direction.squaredNorm()) direction = rest;
    }
    std::size_t farthest = 0;
    double most = -1;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      const double at = std::abs(dot(slabs[i].data(), direction.data(), d));
      if (at > most) {
        most = at;
        farthest = i;
      }
    }
    AnyVector far = AnyVector::Zero(d);
    if (!slabs.empty()) far = slabs[farthest];
    add_outer(moment, 1.0 / d, far);
    AnyVector rest = far - basis * (basis.transpose() * far);
    rest -= basis * (basis.transpose() * rest);
    basis.col(k) = rest / rest.norm();
  }
  AnyMatrix inverse = inverse_of<kAnyDimension>(moment);
  constexpr int kSteps = 60;
  std::vector<double> values(slabs.size());
  for (int step = 0; step < kSteps; ++step) {
    double most = 0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      values[i] = quadratic(inverse, slabs[i].data());
      if (values[i] > most) {
        most = values[i];
        far = i;
      }
    }
    if (most <= kRoundness * d) break;
    const double share = (most / d - 1) / (most - 1);
    moment *= 1 - share;
    add_outer(moment, share, slabs[far]);
    inverse = inverse_of<kAnyDimension>(moment);
    // What carries no weight at the optimum is left out (Harman and Pronzato 2007).
    const double gap = most / d - 1;
    const double least = d * (1 + 0.5 * (gap - std::sqrt(gap * (4 + gap - 4.0 / d))));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      if (values[i] >= least) slabs[kept++] = slabs[i];
    }
    slabs.resize(kept);
  }
  double most = 0;  // whatever the weights: E = {z : z' moment z <= 1 / most} lies in every slab
  AnyVector a(d);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    slab(static_cast<std::int32_t>(p), a);
    most = std::max(most, quadratic(inverse, a.data()));
  }
  return moment * most;
}

MacbeathRegion PolarBody::region(const AnyVector& v, double delta, std::span<const std::int32_t> candidates) const {
  MacbeathRegion r;
  r.point = extreme(v);
  r.center = v * ((1 - delta) / v.dot(points_[r.point]));
  const auto slab = [&](std::int32_t p, AnyVector& to) {
    with_dimension(to.size(), [&](auto d) {
      const double* const from = points_[p].data();
      const double height = 1 - dot(from, r.center.data(), d);
      for (int k = 0; k < d; ++k) to[k] = from[k] / height;
    });
  };
  r.ellipsoid = ellipsoid_in(slab, candidates);
  return r;
}

MacbeathRegion PolarBody::answering_region(const AnyVector& v, double depth, double epsilon,
                                           std::span<const std::int32_t> candidates) const {
  MacbeathRegion r;
  r.point = extreme(v);
  const AnyVector& q = points_[r.point];
  r.center = v * ((1 - depth) / v.dot(q));
  const auto lead = [&](const AnyVector& p, AnyVector& to) {
    return with_dimension(to.size(), [&](auto d) {
      for (int k = 0; k < d; ++k) to[k] = q[k] - (1 - epsilon) * p[k];
      return dot(to.data(), r.center.data(), d);
    });
  };
  const auto slab = [&](std::int32_t p, AnyVector& to) {
    double height = lead(points_[p], to);
    if (p == r.point) {
      to = q;
      height = depth;
    }
    for (double& number : to) number /= height;
  };
  r.ellipsoid = ellipsoid_in(slab, candidates);
  // Over x + {z : z' A z <= c^2}, and so over its shadow, <w, y> >= 0 where <w, x>^2 >= c^2 w' A^-1 w.
  const AnyMatrix inverse = inverse_of<kAnyDimension>(r.ellipsoid);
  double scale_squared = std::numeric_limits<double>::infinity();
  AnyVector w(v.size());
  for (const AnyVector& p : points_) {
    const double height = lead(p, w);
    scale_squared = std::min(scale_squared, height * height / quadratic(inverse, w.data()));
  }
  constexpr double kRounding = 1e-9;
  r.ellipsoid /= scale_squared * (1 - kRounding);
  return r;
}

std::vector<std::int32_t> PolarBody::neighbours(const MacbeathRegion& region,
                                                std::span<const std::int32_t> candidates) const {
  // A deeper region in the shadow is centred at s (x + z), z in the ellipsoid, 1 <= s <= <q, hit> / ..., and reaches at
  // most twice as far as this region's slabs do, which end within sqrt(roundness d) of the ellipsoid.
  const double reach = 1 + 2.5 * std::sqrt(kRoundness * dimension());
  const AnyMatrix inverse = inverse_of<kAnyDimension>(region.ellipsoid);
  const double depth = region.center.dot(points_[region.point]);  // 1 - delta
  std::vector<std::int32_t> r;
  for (const std::int32_t p : candidates) {
    const double along = dot(points_[p].data(), region.center.data(), region.center.size());
    const double outwards = std::max(along, along / std::max(depth, 0.25));
    if (outwards + reach * std::sqrt(quadratic(inverse, points_[p].data())) >= 1) r.push_back(p);
  }
  return r;
}

}  // namespace pd::dimension::detail
