/// @file
/// This step's contact points put into Bullet's manifold of four in place of last step's, with their impulses.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <array>
#include <cstdint>

#include "pair/bounce.hpp"
#include "pair/pair_registry.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

struct FreshPoint {
  btVector3 normal;  ///< from B to A
  btVector3 point_on_b;
  btScalar distance;
  std::int64_t feature_id;
  int piece = 0;  ///< for `PointSurroundings`
};

struct FreshPoints {
  std::array<FreshPoint, 4> points;
  int count = 0;
};

/// Keeps the points that `is_kept` accepts, in their order.
/// @return for each kept point, the number that it had before.
template <class IsKept>
std::array<int, 4> keep_points(FreshPoints& points, IsKept&& is_kept) {
  std::array<int, 4> before{0, 1, 2, 3};
  int kept = 0;
  for (int k = 0; k < points.count; ++k) {
    const FreshPoint& point = points.points[static_cast<std::size_t>(k)];
    if (!is_kept(point)) continue;
    before[static_cast<std::size_t>(kept)] = k;
    points.points[static_cast<std::size_t>(kept++)] = point;
  }
  points.count = kept;
  return before;
}

/// Sets all but the piece.
void set_fresh_point(const btVector3& normal, const ContactPoint& point, FreshPoint& out);
void set_fresh_points(const ContactManifold& manifold, FreshPoints& out);

/// Of the pieces that a point lies between, as Bullet counts parts and children: of both bodies of the pair's result.
struct PieceNumbers {
  int part_0 = -1, index_0 = -1, part_1 = -1, index_1 = -1;
};

/// The pieces that points lie between stand in the result in place of their bodies while `btManifoldResult` takes a
/// point in, for the host's callbacks.
class PointSurroundings {
 public:
  virtual ~PointSurroundings() = default;
  /// @param piece  as of `FreshPoint`
  virtual void enter(int piece) = 0;
  virtual void leave() = 0;
  /// Tells what `enter` tells the result. @return false: it does not tell it of both bodies
  [[nodiscard]] virtual bool numbers(int piece, PieceNumbers& out) const = 0;
};

/// A manifold that nobody else writes to, and the points of this step.
struct PointsOfStep {
  btPersistentManifold& manifold;
  PairMemory& memory;  ///< keeps the features
  const FreshPoints& fresh;
  StepTime seconds;  ///< of the step
  btManifoldResult& result;
  /// Null: all points stand in one piece and under one normal, as those of the last step did.
  PointSurroundings* pieces = nullptr;
};

/// Puts the points of this step in place of the manifold's. Impulses (with their trend, impulse_trend.hpp), life times
/// and anchors go from the old points to the new ones by feature, else by place. Points that go on are written together
/// (lasting_points.hpp), all others by Bullet. Points of bodies that bounce are handed out as bounce.hpp says.
void replace_points(const PointsOfStep& step);

/// Adds points to a manifold that other pairs write to as well.
/// @param seconds of the step
void add_points(btPersistentManifold& manifold, const FreshPoints& fresh, const StepTime& seconds,
                btManifoldResult& result);

}  // namespace pd::detail
