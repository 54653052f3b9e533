#include "pd/solid/solid_depth.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "depth/pair/canonical_order.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "pd/depth/scratch.hpp"
#include "solid/overlap_depth.hpp"
#include "solid/posed_solids.hpp"
#include "solid/shape_beside.hpp"
#include "solid/solid_contact.hpp"
#include "solid/solid_distance.hpp"

namespace pd {

namespace {

using detail::Body;
using detail::PosedSolids;
using detail::ShapeBeside;
using detail::SolidContact;

Vec3 unit_normal(const detail::PosedTriangle& t) { return (t[1].x - t[0].x).cross(t[2].x - t[0].x).normalized(); }

/// True if a triangle lies above the plane of another, or in it.
bool lies_above(const PosedSolids& solids, const detail::PosedTriangle& plane, const detail::PosedTriangle& t) {
  return solids.orient3d(plane, t[0]) >= 0 && solids.orient3d(plane, t[1]) >= 0 && solids.orient3d(plane, t[2]) >= 0;
}

void set_touching(const PosedSolids& solids, const SolidContact& found, Scratch& scratch, SolidDepth& out) {
  static_cast<PenetrationDepth&>(out) =
      detail::answer_of_triangles(solids, found.triangle_a, found.triangle_b, scratch);
  out.contact = ContactClass::touching;
  out.depth = out.lower = out.upper = out.distance = out.distance_lower = out.distance_upper = 0;
  out.translation = Vec3::Zero();
  out.witness_b = out.witness_a;
  out.bracket_reached = true;
  out.feature_a = out.feature_b = {};
  // A leaves B across the face that the other's triangle stands on.
  const detail::PosedTriangle a = solids.corners(Body::a, found.triangle_a);
  const detail::PosedTriangle b = solids.corners(Body::b, found.triangle_b);
  if (lies_above(solids, b, a)) {
    out.normal = unit_normal(b);
  } else if (lies_above(solids, a, b)) {
    out.normal = -unit_normal(a);
  }
  out.face_a = solids.solid(Body::a).triangle(found.triangle_a).face;
  out.face_b = solids.solid(Body::b).triangle(found.triangle_b).face;
}

std::optional<Error> refuse_settings(const SolidSettings& settings) {
  if (!(settings.delta > 0 && settings.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  }
  if (settings.max_points < 0) return Error{ErrorCode::bad_value, "max_points must not be negative", "max_points"};
  return std::nullopt;
}

bool is_bare_polytope(const ConvexShape& shape) { return shape.polytope() != nullptr && shape.margin() == 0; }

}  // namespace

ContactClass classify(const PosedSolid& a, const PosedSolid& b) {
  const detail::FloatingPointGuard guard;
  return contact_of(PosedSolids(*a.solid, a.pose, *b.solid, b.pose)).contact;
}

Expected<SolidDepth> penetration_depth(const PosedSolid& a, const PosedSolid& b, Scratch& scratch,
                                       const SolidSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (auto refused = refuse_settings(settings)) return *std::move(refused);
  const PosedSolids solids(*a.solid, a.pose, *b.solid, b.pose);
  const SolidContact found = contact_of(solids);
  SolidDepth out;
  out.work.triangle_pairs = found.pairs;
  switch (found.contact) {
    case ContactClass::separated:
      set_distance(solids, scratch, out);
      break;
    case ContactClass::touching:
      set_touching(solids, found, scratch, out);
      break;
    case ContactClass::overlapping:
      detail::set_depth({a, b, solids, settings}, scratch, out);
      break;
  }
  detail::clear_negative_zeros(out);
  return out;
}

Expected<SolidDepth> penetration_depth(const PosedSolid& a, const PosedShape& b, Scratch& scratch,
                                       const SolidSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (auto refused = refuse_settings(settings)) return *std::move(refused);
  if (is_bare_polytope(*b.shape)) {
    const Expected<MeshSolid> solid = MeshSolid::from_polytope(*b.shape->polytope());
    if (!solid) return solid.error();
    return penetration_depth(a, PosedSolid{&*solid, b.pose}, scratch, settings);
  }
  const Expected<std::unique_ptr<ShapeBeside>> beside = ShapeBeside::place(a, b, scratch);
  if (!beside) return beside.error();
  const ShapeBeside::Found found = (*beside)->meet(a.pose, Vec3::Zero(), HUGE_VAL);
  SolidDepth out;
  out.exact = false;
  if (found.contact == ContactClass::overlapping) {
    detail::set_depth_beside(a, b, **beside, settings, scratch, out);
  } else {
    static_cast<PenetrationDepth&>(out) = found.answer;
    out.feature_a = out.feature_b = {};
    out.face_a = a.solid->triangle(found.triangle).face;
    if (found.contact == ContactClass::separated) out.distance_lower = found.distance_lower;
  }
  out.work.triangle_pairs = found.triangles;
  detail::clear_negative_zeros(out);
  return out;
}

Expected<SolidDepth> penetration_depth(const PosedShape& a, const PosedSolid& b, Scratch& scratch,
                                       const SolidSettings& settings) {
  if (is_bare_polytope(*a.shape)) {
    const Expected<MeshSolid> solid = MeshSolid::from_polytope(*a.shape->polytope());
    if (!solid) return solid.error();
    return penetration_depth(PosedSolid{&*solid, a.pose}, b, scratch, settings);
  }
  const Expected<SolidDepth> turned = penetration_depth(b, a, scratch, settings);
  if (!turned) return turned.error();
  SolidDepth out = *turned;
  detail::exchange_bodies(out);
  std::swap(out.face_a, out.face_b);
  std::swap(out.work.parts_a, out.work.parts_b);
  detail::clear_negative_zeros(out);
  return out;
}

Expected<ContactClass> classify(const PosedSolid& a, const PosedShape& b, Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  if (is_bare_polytope(*b.shape)) {
    const Expected<MeshSolid> solid = MeshSolid::from_polytope(*b.shape->polytope());
    if (!solid) return solid.error();
    return classify(a, PosedSolid{&*solid, b.pose});
  }
  const Expected<std::unique_ptr<ShapeBeside>> beside = ShapeBeside::place(a, b, scratch);
  if (!beside) return beside.error();
  return (*beside)->meet(a.pose, Vec3::Zero(), 0).contact;
}

}  // namespace pd
