#include "depth/pair/polytope_rescaled.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "depth/pair/scaled_shape.hpp"
#include "shape/hull/polytope_storage.hpp"

namespace pd::detail {

namespace {

/// Times 2^exponent, or nothing where that rounds or overflows.
std::optional<double> times_exactly(double x, int exponent) {
  const double scaled = std::ldexp(x, exponent);
  if (std::ldexp(scaled, -exponent) != x) return std::nullopt;
  return scaled;
}

std::optional<Pose> times_exactly(const Pose& pose, int exponent) {
  const Vec3& t = pose.translation();
  const Vec3 scaled = times_power(t, exponent);
  if (times_power(scaled, -exponent) != t || scaled.cwiseAbs().maxCoeff() > kMaxCoordinate) return std::nullopt;
  if (!pose.is_quaternion()) return Pose::from_trusted_matrix(pose.rotation(), scaled);
  return Pose::from_quaternion(pose.quaternion_wxyz(), scaled).value();
}

/// Of an answer, all lengths that are promised; witnesses are rounded as they are.
bool times_exactly(PenetrationDepth& answer, int exponent) {
  for (double* const x :
       {&answer.depth, &answer.lower, &answer.upper, &answer.distance, &answer.distance_lower, &answer.distance_upper,
        &answer.translation.x(), &answer.translation.y(), &answer.translation.z()}) {
    const std::optional<double> scaled = times_exactly(*x, exponent);
    if (!scaled) return false;
    *x = *scaled;
  }
  answer.witness_a = times_power(answer.witness_a, exponent);
  answer.witness_b = times_power(answer.witness_b, exponent);
  return true;
}

}  // namespace

bool answer_at_size_one(const PolytopeQuery& query, PenetrationDepth& out) {
  const PolytopePair& pair = query.pair;
  // Of no square: the reach may have overflown.
  const Vec3 offset = pair.pose_b->translation() - pair.pose_a->translation();
  const double size =
      std::max({pair.a->max_abs_coordinate(), pair.b->max_abs_coordinate(), offset.cwiseAbs().maxCoeff()});
  if (query.buffers.surface.watch || !(size > 0)) return false;
  const int exponent = std::ilogb(size);
  const std::optional<Pose> pose_a = times_exactly(*pair.pose_a, -exponent);
  const std::optional<Pose> pose_b = times_exactly(*pair.pose_b, -exponent);
  const std::optional<double> margin_a = times_exactly(pair.margins.a, -exponent);
  const std::optional<double> margin_b = times_exactly(pair.margins.b, -exponent);
  if (!pose_a || !pose_b || !margin_a || !margin_b) return false;
  const auto storage_a = scaled_exactly(pair.a->storage(), -exponent);
  const auto storage_b = scaled_exactly(pair.b->storage(), -exponent);
  if (!storage_a || !storage_b) return false;

  const ConvexPolytope a(storage_a), b(storage_b);
  DepthSettings settings = query.settings;
  // Beside a pair of size 1 a wider tolerance is none.
  settings.contact_tolerance = std::min(std::ldexp(settings.contact_tolerance, -exponent), 0x1p60);
  PenetrationDepth answer;
  polytope_depth({&a, &b, &*pose_a, &*pose_b, {*margin_a, *margin_b}}, settings, query.buffers, nullptr, answer);
  if (query.for_contact()) {
    scale_answer(answer, exponent);  // brackets outwards
  } else if (!times_exactly(answer, exponent)) {
    return false;
  }
  out = answer;
  return true;
}

}  // namespace pd::detail
