#include "depth/certificate/nearest_plane.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numeric/root_sum.hpp"
#include "numeric/unit_roundoff.hpp"
#include "numeric/unrounded.hpp"

namespace pd::detail {

namespace {

DoubleDouble scaled(const DoubleDouble& x, double power_of_two) { return {x.hi * power_of_two, x.lo * power_of_two}; }

}  // namespace

NearestPlane exact_plane(const PosedPair& pair, const FacetOfDifference& facet) {
  ExactDirection normal(cross(pair.exact(facet.u), pair.exact(facet.v)));
  Dyadic level = dot(normal.exact, pair.exact(facet.point()));
  return {std::move(normal), pair.homogeneous_factor(), std::move(level)};
}

NearestPlane exact_plane(const ExactClosestPoint& nearest) {
  const Dyadic3& y = nearest.point;  // times nearest.scale
  return {ExactDirection(Dyadic3{-y.x, -y.y, -y.z}), nearest.scale, -dot(y, y)};
}

Separation::Separation(NearestPlane plane, const Dyadic& r)
    : plane_(std::move(plane)),
      radius_(r),
      unit_(unit_double_double(plane_->normal.exact)),
      depth_error_(std::numeric_limits<double>::infinity()) {}

Separation::Separation(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane, double margin_a,
                       double margin_b)
    : facet_(facet) {
  measure(pair, plane, margin_a, margin_b);
}

Separation::Separation(const PosedPair& pair, const ProvenSeparation& proof, double margin_a, double margin_b)
    : apart_(&proof) {
  measure(pair, proof.plane, margin_a, margin_b);
}

void Separation::measure(const PosedPair& pair, const FacetPlane& plane, double margin_a, double margin_b) {
  pair_ = &pair;
  margins_ = two_sum(margin_a, margin_b);
  unit_ = plane.unit;
  unit_error_ = plane.unit_error;
  if (plane.axis >= 0) {  // lengths are not scaled there
    depth_ = plane.distance;
    if (add_exactly(depth_, margins_.hi) && add_exactly(depth_, margins_.lo)) {
      axis_ = plane.axis;
      depth_error_ = 0;
      return;
    }
  }
  const double scale = pair.outwards();
  depth_ = scaled(plane.distance, scale) + margins_;
  // The sum's own error is relative to its greater part, which the other may cancel.
  const double largest = std::max(std::abs(plane.distance.hi) * scale, margins_.hi);
  depth_error_ = (plane.distance_error * scale + 4 * kUdd * largest) * (1 + 4 * kUnitRoundoff) + 0x1p-960;
}

double Separation::slack(const DoubleDouble& depth) const {
  const double error = measured() ? depth_error_ : RootSum::kApproximationError * depth.hi;
  // |t|_1 <= sqrt(3) |t|, and |t| exceeds the depth by an ulp or two.
  return 2 * error + 2 * depth.hi * (unit_error_ + 32 * kUdd);
}

bool Separation::reached(const Vec3& t) {
  if (axis_ >= 0) {
    const double along = t[axis_] * (axis_ == 0 ? unit_.x.hi : axis_ == 1 ? unit_.y.hi : unit_.z.hi);
    return along == depth_.hi ? depth_.lo <= 0 : along > depth_.hi;
  }
  if (measured()) {
    const DoubleDouble along = unit_.x * t.x() + unit_.y * t.y() + unit_.z * t.z();
    const double size = std::abs(t.x()) + std::abs(t.y()) + std::abs(t.z());
    const double error =
        (depth_error_ + size * (unit_error_ + 16 * kUdd) + 4 * kUdd * std::abs(depth_.hi)) * (1 + 16 * kUnitRoundoff);
    const double gap = to_double(along - depth_);
    if (gap > error) return true;
    if (gap < -error) return false;
  }
  const NearestPlane& exact = plane();
  const Dyadic gap = dot(exact.normal.exact, to_dyadic(t)) * exact.weight - exact.level;
  if (gap.sign() < 0 || radius().sign() == 0) return gap.sign() >= 0;
  const Dyadic reach = radius() * exact.weight;
  return (gap * gap - reach * reach * dot(exact.normal.exact, exact.normal.exact)).sign() >= 0;
}

const NearestPlane& Separation::plane() {
  if (!plane_) {
    if (apart_) {
      plane_ = exact_plane(exact_closest_point(*pair_, apart_->simplex.data(), apart_->count));
    } else {
      plane_ = exact_plane(*pair_, facet_);
    }
    radius_ = Dyadic(margins_.hi) + Dyadic(margins_.lo);
  }
  return *plane_;
}

}  // namespace pd::detail
