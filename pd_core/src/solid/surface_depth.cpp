#include "solid/surface_depth.hpp"

#include <cmath>

#include "solid/surface_distance.hpp"
#include "solid/winding.hpp"

namespace pd::detail {

DepthProbe::DepthProbe(const PosedSolids& solids, Body body)
    : solids_(solids),
      body_(body),
      alone_(solids.solid(body), identity_, solids.solid(body), identity_),
      slack_(16 * solids.error()) {}

SurfaceDepth DepthProbe::at(const Vec3& x) const { return signed_depth(x, HUGE_VAL, 0); }

SurfaceDepth DepthProbe::at(const Vec3& x, const SurfaceDepth& near, double moved) const {
  const double kept = std::abs(near.depth) - moved - slack_;
  return signed_depth(x, std::abs(near.depth) + moved + 2 * slack_, kept > 0 ? near.depth : 0);
}

SurfaceDepth DepthProbe::signed_depth(const Vec3& x, double at_most, double known_sign) const {
  NearestTriangle nearest = nearest_triangle(solids_, body_, x, at_most);
  const bool is_far = nearest.distance > slack_;
  SurfaceDepth out;
  if (is_far && (known_sign != 0 ? known_sign > 0 : holds(x))) {
    out.depth = nearest.distance - slack_;
    if (nearest.triangle >= 0) out.inward = (x - nearest.foot).stableNormalized();
    return out;
  }
  if (nearest.triangle < 0) nearest = nearest_triangle(solids_, body_, x);
  out.depth = -reach_to_triangle(solids_.corners(body_, nearest.triangle), x) - slack_;
  if (is_far) out.inward = (nearest.foot - x).stableNormalized();
  return out;
}

bool DepthProbe::holds(const Vec3& x) const {
  PosedPoint own;
  own.x = alone_.inside(solids_.in_own_frame(body_, x));
  own.exact = true;
  const PointPlace place = place_in(alone_, Body::a, own);
  return !place.on_surface && place.winding > 0;
}

}  // namespace pd::detail
