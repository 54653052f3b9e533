#include "pair/box_contacts.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>
#include <cmath>

#include "pair/query_meter.hpp"
#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

btVector3 sharp_half_extents(const btConvexShape& box) {
  return static_cast<const btBoxShape&>(box).getHalfExtentsWithMargin();
}

BoxInRows in_rows(const btConvexShape& box, const btTransform& transform) {
  BoxInRows out;
  to_pd(transform.getBasis()[0], out.x);
  to_pd(transform.getBasis()[1], out.y);
  to_pd(transform.getBasis()[2], out.z);
  to_pd(sharp_half_extents(box), out.half_extents);
  out.centre = to_pd(transform.getOrigin());
  return out;
}

}  // namespace

BoxContact ask_boxes(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b,
                     const btTransform& pose_b, double breaking_threshold, BoxWitness witness) {
  const BoxInRows box_a = in_rows(a, pose_a), box_b = in_rows(b, pose_b);
  const auto squared_radius = [](const BoxInRows& box) {
    return Vec3(box.half_extents[0], box.half_extents[1], box.half_extents[2]).squaredNorm();
  };
  const double radius = std::sqrt(std::min(squared_radius(box_a), squared_radius(box_b)));
  const double tolerance = contact_tolerance(box_a.centre, box_b.centre, radius);
  return box_contact(box_a, box_b, tolerance, breaking_threshold, witness);
}

bool box_contacts(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b, const btTransform& pose_b,
                  double breaking_threshold, ThreadBuffers& held, FreshPoints& out) {
  if (!in_range(pose_a) || !in_range(pose_b)) return false;
  QueryMeter meter(held);
  const BoxContact found = ask_boxes(a, pose_a, b, pose_b, breaking_threshold, BoxWitness::left_out);
  if (!found.answered) return false;
  held.counters.calls.add();
  meter.count(found.contact);
  set_fresh_points(found.manifold, out);
  return true;
}

}  // namespace pd::detail
