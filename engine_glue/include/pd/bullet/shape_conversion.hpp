/// @file
/// The convex body that a Bullet shape means: its core (Bullet's support without margin) swept by a ball of its
/// margin.
///
/// Bullet's narrow phase sees `localGetSupportVertexNonVirtual(d) = core(d) + margin * d/|d|`, so the body is the
/// Minkowski sum of the core and a ball, for every type; only what the core is differs:
///
/// | Bullet shape | core | margin |
/// |---|---|---|
/// | box, 2D box | box of the half extents less the margin (the margin lies inside, the corners are round) | inside |
/// | convex hull, point cloud | hull of points * local scaling (the margin is not scaled) | outside |
/// | tetrahedron (btBU_Simplex1to4), triangle, custom polyhedral | hull of its vertices | outside |
/// | convex triangle mesh | hull of the mesh's scaled vertices | outside |
/// | cylinder | cylinder of the half extents less the margin | inside |
/// | cone | cone | outside |
/// | sphere, capsule | point, segment | the radius |
/// | multisphere, scaled uniformly | hull of the spheres, each thinner by the least radius | the least scaled radius |
/// | uniform scaling, 2D convex | the child's, scaled | the child's, scaled |
/// | Minkowski sum (Bullet's is A - B) of polyhedral cores | hull of all vertex differences | sum of both |
///
/// A box or cylinder whose margin reaches one of its half extents keeps its extents: its margin is taken as a
/// thousandth less than the least of them.
///
/// Refused as `ErrorCode::unsupported`, with the reason in the message:
///
/// - a multisphere that is scaled differently along its axes;
/// - a Minkowski sum with a smooth core, or with more than 65,536 pairs of vertices;
/// - a cylinder without height, a cone without height or radius;
/// - a margin or radius below zero;
/// - convex types of the host's own that are not polyhedral.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <cstdint>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"

class btBoxShape;

namespace pd {

/// The body that Bullet means by `shape`, in the shape's frame, in the world's unit of length.
/// @return as in the table above; `unsupported`, or the reason that the core's factories give (`too_few_points` for a
/// hull without points, `non_finite`, ...); `where` names the Bullet type. Time: that of the hull of the shape's
/// points.
[[nodiscard]] Expected<ConvexShape> to_convex_shape(const btConvexShape& shape);

/// A number of 64 bits that changes with everything that `to_convex_shape` reads: type, margin, scaling, sizes, every
/// point. Two shapes of different content agree by chance with probability 2^-64.
/// Time O(points): less than one of the dozens of support calls that Bullet's own solver makes on the same shape.
[[nodiscard]] std::uint64_t shape_fingerprint(const btConvexShape& shape);

/// A number that changes with the type, margin, scaling, sizes, the number of points and their address, but not with
/// the points themselves. Time O(1).
[[nodiscard]] std::uint64_t shape_signature(const btConvexShape& shape);

/// A box as Bullet's own box/box algorithm takes it: sharp, of the full half extents, whatever its margin.
[[nodiscard]] Expected<ConvexShape> to_sharp_box(const btBoxShape& shape);

}  // namespace pd
