/// @file
/// Casts and closest points of one convex shape through a Bullet world's broadphase, exact where Bullet's own are not:
/// `convexSweepTest` approximates the cast (and turns long bodies through others), and takes no solver of ours.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <optional>

#include "pd/bullet/shape_cache.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

/// Lengths in the world's unit, positions in its frame.
struct WorldQuerySettings {
  /// Bullet's rule for callbacks: an object is asked if its group is in this mask and this group in its mask.
  int filter_group = btBroadphaseProxy::DefaultFilter;
  int filter_mask = btBroadphaseProxy::AllFilter;
  /// The gap that a cast may leave before a hit, > 0 and finite.
  double tolerance = 1e-6;
  /// Keeps converted shapes (`BulletPenetrationDepthSolver::cache()`); nullptr: converted at each call.
  BulletShapeCache* cache = nullptr;
};

/// An object that a shape meets or is nearest to.
struct WorldHit {
  const btCollisionObject* object = nullptr;
  /// For meshes and heightfields Bullet's numbers of the triangle, for compounds -1 and the child's number (of nested
  /// ones the outermost child's); else -1, -1.
  int part = -1;
  int index = -1;
  Vec3 point_on_shape = Vec3::Zero();
  Vec3 point_on_object = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< unit; the way in which the shape leaves the object
  double distance = 0;          ///< signed: negative inside by the penetration depth
};

struct SweepHit : WorldHit {
  /// Share of the way from `from` to `to`: nothing is met in [0, fraction), proved. 0 where the shape overlaps at the
  /// start.
  double fraction = 1;
};

struct SweepResult {
  std::optional<SweepHit> hit;  ///< the first one
  /// Objects in the way whose shape has no exact body (`to_convex_shape` says why): they are not asked.
  int unanswered = 0;
};

struct DistanceResult {
  std::optional<WorldHit> nearest;
  /// Objects without an exact body (as above) that lie near enough to be nearer than the answer.
  int unanswered = 0;
};

/// The first object that `shape` meets on the straight way from `from` to `to`, turning at constant speed about its
/// origin by the shorter turn. Objects stand still at their world transforms; the broadphase must be up to date
/// (`updateAabbs`, or a step), as for Bullet's own queries. Objects without contact response are asked, too.
/// @return an error where `shape` has no exact body, a transform is not finite (`non_finite`) or a setting is out of
/// its range (`bad_value`); hits with points, normal and distance as of `SweepHit`. Time: a time of impact
/// (`pd/contact/time_of_impact.hpp`, whose proof this is) for each convex piece that meets the box of the whole way.
/// Along a mesh the way is cut into stretches as long as the shape, or as a 256th of the mesh. Each triangle that meets
/// the box of a stretch before the hit is asked. Without a cache each is converted, too.
[[nodiscard]] Expected<SweepResult> sweep_test(btCollisionWorld& world, const btConvexShape& shape,
                                               const btTransform& from, const btTransform& to,
                                               const WorldQuerySettings& settings = {});

/// Sweeps for Bullet's callbacks, with `convexSweepTest`'s contract: `callback.needsCollision` decides who is asked
/// (its filters by default), and `addSingleResult` gets each object's first hit below `m_closestHitFraction`, normal in
/// the world. The settings' filters are not used.
/// @return how many objects are unanswered; errors as above.
Expected<int> sweep_test(btCollisionWorld& world, const btConvexShape& shape, const btTransform& from,
                         const btTransform& to, btCollisionWorld::ConvexResultCallback& callback,
                         const WorldQuerySettings& settings = {});

/// The object that is nearest to `shape` at `pose` (or overlaps it deepest), if one is within `reach` >= 0, with the
/// closest points.
/// @param reach  in the world's unit; it may be infinite.
/// @return an error as above, or where `reach` is below 0 or NaN (`bad_value`).
/// Time: an exact query (`penetration_depth`, tightest bracket) for each convex piece that may be nearer than the
/// answer by its box. Triangles count by their distance from the middle of the shape.
[[nodiscard]] Expected<DistanceResult> distance_test(btCollisionWorld& world, const btConvexShape& shape,
                                                     const btTransform& pose, double reach,
                                                     const WorldQuerySettings& settings = {});

}  // namespace pd
