#include "pd/solid/solid_depth.hpp"

#include <cmath>

#include "depth/pair/canonical_order.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "pd/depth/scratch.hpp"
#include "solid/overlap_depth.hpp"
#include "solid/posed_solids.hpp"
#include "solid/solid_contact.hpp"
#include "solid/solid_distance.hpp"

namespace pd {

namespace {

using detail::Body;
using detail::PosedSolids;
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

}  // namespace

ContactClass classify(const PosedSolid& a, const PosedSolid& b) {
  const detail::FloatingPointGuard guard;
  return contact_of(PosedSolids(*a.solid, a.pose, *b.solid, b.pose)).contact;
}

Expected<SolidDepth> penetration_depth(const PosedSolid& a, const PosedSolid& b, Scratch& scratch,
                                       const SolidSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (!(settings.delta > 0 && settings.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  }
  if (settings.max_points < 0) return Error{ErrorCode::bad_value, "max_points must not be negative", "max_points"};
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

}  // namespace pd
