/// @file
/// The convex pieces and triangles of an object that a region of the world meets, for queries of one shape.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <array>
#include <memory>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/triangles_in_box.hpp"

namespace pd::detail {

/// A shape's exact body, by the cache where there is one, or why it has none.
Expected<std::shared_ptr<const CachedShape>> exact_body(const btConvexShape& shape, BulletShapeCache* cache);

/// A convex piece of an object.
struct RegionPiece {
  std::shared_ptr<const CachedShape> body;
  btTransform pose;
  int part;
  int index;
};

/// A piece that may be asked: a body, or a triangle that is converted when it is asked.
struct RegionCandidate {
  RegionPiece piece;  ///< without a body where it is a triangle
  std::array<Vec3, 3> corners;
  double margin = 0;   ///< of the triangle
  double nearest = 0;  ///< no point of the shape's way is nearer
};

/// Around the shape on its way, and as far as it reaches from there.
struct Region {
  ChildBox way;
  ChildBox reached;
  double diameter;  ///< of the shape, or more
  double reach = 0;
  bool nearest = false;  ///< of the triangles of a mesh, those that may be nearest are enough
};

/// Converts a candidate that is a triangle. @return false where it is no body: Bullet leaves it out, too.
bool convert(RegionCandidate& candidate);

/// Rounded poses and boxes change lengths by less.
inline constexpr double kTurned = 1 + 1e-5;
/// Coordinates of Bullet's boxes and poses are rounded by less than this share.
inline constexpr double kRounded = 16 * static_cast<double>(SIMD_EPSILON);

/// The pieces of an object that a region of the world meets.
class Pieces {
 public:
  Pieces(const Region& region, BulletShapeCache* cache) : region_(region), cache_(cache) {}

  /// Adds those of a shape. @return false where one has no exact body.
  /// @param part, index  of the pieces. The children of the outermost shape, if it is a compound, count from 0.
  bool add(const btCollisionShape& shape, const btTransform& pose, int part, int index, bool outermost);
  /// Puts the pieces in the order of their lower bounds of the distance.
  void sort();

  std::vector<RegionCandidate> pieces;

 private:
  void add_triangles(const btConcaveShape& shape, const btTransform& pose, const ChildBox& own);
  void add_plane(const btStaticPlaneShape& plane, const btTransform& pose);
  /// The ball around the shape's way, in the frame of a pose.
  [[nodiscard]] Whereabouts whereabouts(const btTransform& pose) const;

  const Region& region_;
  BulletShapeCache* cache_;
};

}  // namespace pd::detail
