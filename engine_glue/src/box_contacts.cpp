#include "box_contacts.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "query_meter.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

Vec3 sharp_half_extents(const btConvexShape& box) {
  return to_pd(static_cast<const btBoxShape&>(box).getHalfExtentsWithMargin());
}

}  // namespace

BoxContact ask_boxes(const btConvexShape& a, const Pose& pose_a, const btConvexShape& b, const Pose& pose_b,
                     double breaking_threshold, BoxWitness witness) {
  const Vec3 half_a = sharp_half_extents(a), half_b = sharp_half_extents(b);
  const double tolerance = contact_tolerance(pose_a, pose_b, std::min(half_a.norm(), half_b.norm()));
  return box_contact({half_a, &pose_a}, {half_b, &pose_b}, tolerance, breaking_threshold, witness);
}

bool box_contacts(const btConvexShape& a, const btTransform& transform_a, const btConvexShape& b,
                  const btTransform& transform_b, double breaking_threshold, ThreadBuffers& held, FreshPoints& out) {
  if (!in_range(transform_a) || !in_range(transform_b)) return false;
  QueryMeter meter(held);
  const Pose pose_a = to_pd(transform_a), pose_b = to_pd(transform_b);
  const BoxContact found = ask_boxes(a, pose_a, b, pose_b, breaking_threshold, BoxWitness::left_out);
  if (!found.answered) return false;
  held.counters.calls.add();
  meter.count(found.contact);
  out = fresh_points(found.manifold);
  return true;
}

}  // namespace pd::detail
