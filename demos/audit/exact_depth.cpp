#include "audit/exact_depth.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "audit/body_extent.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::audit {

namespace {

bool is_curved(const RecordedShape& shape) {
  return std::any_of(shape.body->parts().begin(), shape.body->parts().end(),
                     [](const Compound::Part& part) { return part.shape.polytope() == nullptr; });
}

SignedDepth interval_of(const PenetrationDepth& answer) {
  switch (answer.contact) {
    case ContactClass::overlapping:
      return {answer.lower, answer.upper};
    case ContactClass::separated:
      return {-answer.distance_upper, -answer.distance_lower};
    case ContactClass::touching:
      break;
  }
  return {0, 0};
}

using Extended = long double;

Extended dot(const Vec3& a, const Vec3& b) {
  return static_cast<Extended>(a.x()) * b.x() + static_cast<Extended>(a.y()) * b.y() +
         static_cast<Extended>(a.z()) * b.z();
}

}  // namespace

std::optional<PenetrationDepth> body_depth(const RecordedContact& contact, double delta, Scratch& scratch) {
  if (contact.a->is_union || contact.b->is_union) {
    UnionSettings settings;
    settings.delta = std::max(delta, kFinestUnionDelta);
    const auto answer = penetration_depth(PosedCompound{&*contact.a->body, contact.pose_a},
                                          PosedCompound{&*contact.b->body, contact.pose_b}, scratch, settings);
    if (!answer) return std::nullopt;
    return *answer;
  }
  DepthSettings settings;
  if (is_curved(*contact.a) || is_curved(*contact.b)) settings.delta = delta;
  return penetration_depth({&contact.a->convex(), contact.pose_a}, {&contact.b->convex(), contact.pose_b}, scratch,
                           settings);
}

std::optional<SignedDepth> signed_depth(const RecordedContact& contact, double tolerance, double scale,
                                        Scratch& scratch) {
  if (contact.a->halfspace || contact.b->halfspace) return plane_contact(contact).depth;
  const auto answer = body_depth(contact, std::min(tolerance / 10, 1.0), scratch);
  if (!answer) return std::nullopt;
  SignedDepth depth = interval_of(*answer);
  if (answer->contact == ContactClass::touching && (is_curved(*contact.a) || is_curved(*contact.b))) {
    depth = {-1e-12 * scale, 1e-12 * scale};  // what `touching` covers for curved bodies
  }
  return depth;
}

PlaneContact plane_contact(const RecordedContact& contact) {
  const bool a_is_plane = contact.a->halfspace.has_value();
  const RecordedShape& plane = a_is_plane ? *contact.a : *contact.b;
  const Pose& plane_pose = a_is_plane ? contact.pose_a : contact.pose_b;
  const RecordedShape& solid = a_is_plane ? *contact.b : *contact.a;
  const Pose& solid_pose = a_is_plane ? contact.pose_b : contact.pose_a;
  const Halfspace3& halfspace = *plane.halfspace;

  PlaneContact result;
  // {R x + t : <n,x> <= o} = {y : <R^-T n, y - t> <= o}; a recorded matrix is a rotation only up to 1e-6.
  result.normal =
      plane_pose == Pose() ? halfspace.normal : Vec3(plane_pose.rotation().inverse().transpose() * halfspace.normal);
  const double length = result.normal.norm();
  const double reach = turned_support(*solid.body, solid_pose, -result.normal);
  const Extended apart = dot(result.normal, solid_pose.translation()) - dot(result.normal, plane_pose.translation());
  const Extended x = (static_cast<Extended>(halfspace.offset) - apart + reach) / length;
  // Extended products and sums, and doubles where the body and the plane are turned.
  const Box box = bounding_box(*solid.body, solid_pose);
  const double radius = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm();
  const double far =
      std::abs(halfspace.offset) / length + solid_pose.translation().norm() + plane_pose.translation().norm();
  const double turned = plane_pose == Pose() ? 0 : (solid_pose.translation() - plane_pose.translation()).norm();
  const double error =
      0x1p-50 * (radius + turned) + static_cast<double>(8 * std::numeric_limits<Extended>::epsilon()) * far;
  result.depth = {static_cast<double>(x) - error, static_cast<double>(x) + error};
  return result;
}

}  // namespace pd::audit
