#include <algorithm>
#include <cmath>

#include "depth/pair/beyond.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// At least |R v| / |v|: a host's matrix is a rotation up to single precision only.
double stretch(const Mat3& r) {
  const Mat3 excess = r.transpose() * r - Mat3::Identity();
  return std::sqrt(1 + excess.norm() * (1 + 16 * kUnitRoundoff) + 32 * kUnitRoundoff);
}

}  // namespace

bool answer_balls_beyond(const PosedShape& a, const PosedShape& b, double beyond, PenetrationDepth& out) {
  const ConvexPolytope *const core_a = a.shape->polytope(), *const core_b = b.shape->polytope();
  const Vec3 offset = b.pose.translation() - a.pose.translation();
  const double margin_a = a.shape->margin(), margin_b = b.shape->margin();
  const double asked = std::max(beyond, 0.0) + (margin_a + margin_b);
  const double squared = offset.squaredNorm();
  if (!(squared < 0x1p200 && squared > 0x1p-200)) return false;
  const double length = std::sqrt(squared);
  // Each body lies in the ball round its frame's origin; lengths, sums and products round by a few u of the greatest.
  const double balls = core_a->radius() * stretch(a.pose.rotation()) + core_b->radius() * stretch(b.pose.rotation());
  const double rounding = 16 * kUnitRoundoff * (length + balls + asked);
  const double lower = length - balls - (margin_a + margin_b) - rounding;
  if (!(lower > beyond)) return false;
  out.contact = ContactClass::separated;
  out.method = Method::expansion;
  out.normal = offset / -length;
  const Vec3 on_a = a.pose.rotation() * core_a->vertex(0), on_b = b.pose.rotation() * core_b->vertex(0);
  const Vec3 witness_a = on_a - margin_a * out.normal, witness_b = on_b + margin_b * out.normal;
  out.distance_lower = lower;
  out.distance = std::max((witness_b - witness_a + offset).norm(), lower);
  out.distance_upper = out.distance + 2 * rounding;
  out.witness_a = witness_a + a.pose.translation();
  out.witness_b = witness_b + b.pose.translation();
  out.feature_a = out.feature_b = {Feature::Kind::vertex, 0, -1};
  return true;
}

}  // namespace pd::detail
