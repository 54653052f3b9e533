/// @file
/// A union of convex polytopes, such as `pd::decompose` makes of a solid, as a compound shape of Bullet. Needs C++20.
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <memory>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"

namespace pd {

struct BulletCompoundSettings {
  /// Radius of a ball that sweeps every child, outside of its points, in place of Bullet's 0.04. A margin of the part
  /// itself is added.
  double margin = 0;
  /// The shape's origin is the centre of mass. False: it is the origin of the parts.
  bool at_centre_of_mass = true;
};

/// Owns the children and the compound, which refers to them. Movable.
struct BulletCompound {
  std::vector<std::unique_ptr<btConvexHullShape>> children;  ///< in the order of the parts
  std::unique_ptr<btCompoundShape> shape;
  /// The shape's origin in the parts' frame. A body at x in the parts' frame stands at x - origin in the shape's frame.
  Vec3 origin = Vec3::Zero();
  double volume = 0;                   ///< the sum over the parts
  Vec3 centre_of_mass = Vec3::Zero();  ///< in the parts' frame
  /// About the centre of mass, along the parts' axes, for a mass of 1. `btRigidBody` takes the diagonal.
  Mat3 inertia = Mat3::Zero();
  /// The farthest that a vertex moved when it became a btScalar; 0 in double precision.
  double rounding = 0;
};

/// Makes a compound of one convex hull for each part.
///
/// The children hold the parts' own vertices, rounded to btScalar and never shifted, and all stand at one translation:
/// parts that share a face in the stored numbers share it in Bullet. Mass is spread evenly over each part, without
/// margins, so that where parts overlap it counts twice.
///
/// @return unsupported ("parts[i]") for a part that is no polytope; not_full_dimensional ("parts[i]") without a volume;
/// out_of_range for a vertex that a btScalar ("parts[i]"), or a moment that a double ("parts") does not hold; bad_value
/// ("margin"). Lengths are in the unit of the parts, which is the world's. Time O(n) for n vertices and edges of all
/// parts.
[[nodiscard]] Expected<BulletCompound> compound_of(const Compound& parts, const BulletCompoundSettings& settings = {});

}  // namespace pd
