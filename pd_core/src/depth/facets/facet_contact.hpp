/// @file
/// The signed distance of a convex body from a facet of a polytope that it rests on, certified both ways in constant
/// time: what bodies at rest need, frame after frame.
///
/// Let n be the facet's outward normal, a the point of the body farthest along -n, and F the facet moved by -a: it lies
/// in P = facet's owner + (-body), whose supporting plane along n it spans, at the height d0 <= h_P(n).
/// 1. The signed distance c is at least -h_P(n), as for any direction.
/// 2. Where the origin projects into F, a point of F lies no farther than its height: c <= |height|.
/// 3. Where d0 > 0, P holds the ball of radius d0 round the origin, so that c <= -d0, if F reaches r >= d0 from the
///    projection to every side and P holds a point q, z below the origin along n and l aside, with
///        (1 - m) r - m l >= d0   for   m = (d0 + d1) / (z + d1),   d1 the greatest height of F.
///    Proof by support functions: along a unit vector at an angle t < 90 degrees from n, F reaches
///    d0 cos t + r sin t >= min(d0, r). Along one at an angle t from -n, F reaches r sin t - d1 cos t or more and q
///    z cos t - l sin t or more; their mean with weights 1 - m and m is d0 cos t + ((1 - m) r - m l) sin t >= d0.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// A point of a body, relative to the body's translation, in the caller's axes.
struct BodyPoint {
  Vec3 x;
  std::int32_t id;  ///< vertex, -1 for curved bodies
};

struct FacetContact {
  bool certified = false;  ///< the origin projects into F, and the bounds below hold
  double lower = 0;        ///< <= signed distance of the cores <= upper
  double upper = 0;
  double largest = 0;  ///< P reaches this |coordinate|
  double gap = 0;      ///< of `body` above the facet, rounded
  Vec3 normal;         ///< the facet's, unit, outward
  BodyPoint body;      ///< farthest along -normal
};

/// Whether the edges that leave a facet fall steeply enough for its corners to hold the polytope's maximum along the
/// facet's normal, for certain, under any rotation up to single precision: by convexity it is enough to look at these.
[[nodiscard]] bool is_supporting_facet(const ConvexPolytope& polytope, int facet);

/// Squared edges from here on, and their quotients, have all digits. Corners may round to one point, which has no side.
inline constexpr double kLeastSquaredEdge = 0x1p-900;

/// @param rotation     of the facet's owner, any matrix that is a rotation up to single precision.
/// @param offset       translation of the body less that of the owner.
/// @param body_centre  a point inside the body, relative to its translation.
/// @param error        of a plane that supports P, by a support and points of P (`support_plane_error`).
/// @param support      (Vec3 unit) -> BodyPoint: farthest along it.
/// Requires is_supporting_facet. Time: a support, and O(corners of the facet).
template <class Support>
FacetContact facet_contact(const ConvexPolytope& owner, const Mat3& rotation, int facet, const Vec3& offset,
                           const Vec3& body_centre, double error, Support&& support) {
  FacetContact out;
  // Planes turn by the cofactors, which are the rotation where that is one in full.
  const Vec3 x = rotation.col(0), y = rotation.col(1), z = rotation.col(2);
  const Vec3& local = owner.facet_normal(facet);
  const Vec3 turned = y.cross(z) * local.x() + z.cross(x) * local.y() + x.cross(y) * local.z();
  out.normal = turned / turned.norm();
  const Vec3& n = out.normal;
  out.body = support(-n);
  const Vec3 a = out.body.x + offset;

  // Corners of F: how high they are, and how far its sides lie from the projection.
  const auto loop = owner.facet_vertices(facet);
  Vec3 last = rotation * owner.vertex(loop[loop.size() - 1]) - a;
  double greatest = -std::numeric_limits<double>::infinity(), least = -greatest, side = -greatest, shortest = -greatest;
  Vec3 extent = Vec3::Zero();
  for (const std::int32_t v : loop) {
    const Vec3 corner = rotation * owner.vertex(v) - a;
    const double height = corner.dot(n);
    greatest = std::max(greatest, height);
    least = std::min(least, height);
    extent = extent.cwiseMax(corner.cwiseAbs());
    const Vec3 edge = corner - last;
    // The signed square of the distance: inside is to the left of every edge.
    const double twice_area = n.dot(last.cross(edge));
    const double squared = edge.squaredNorm();
    side = std::min(side, twice_area * std::abs(twice_area) / squared);
    shortest = std::min(shortest, squared);
    last = corner;
  }
  out.gap = -greatest;
  out.largest = extent.maxCoeff();
  out.lower = -greatest - error;
  const double inside = side > 0 && shortest >= kLeastSquaredEdge ? std::sqrt(side) - 2 * error : 0;
  if (!(inside > 0)) return out;
  out.certified = true;
  out.upper = std::max(std::abs(greatest), std::abs(least)) + error;
  const double depth = least - error;
  if (depth > 0) {
    const Vec3 centre = rotation * owner.centre() - (body_centre + offset);
    const double below = -centre.dot(n) - error;
    const double beside = (centre - centre.dot(n) * n).norm() + error;
    const double share = (depth + greatest + error) / (below + greatest + error);
    if (below > 0 && share < 1 && inside >= depth && (1 - share) * inside - share * beside >= depth) {
      out.upper = -depth;
    }
  }
  return out;
}

}  // namespace pd::detail
