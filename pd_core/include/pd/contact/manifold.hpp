/// @file
/// The contact of two bodies as at most four pairs of points: the two faces that face each other, intersected.
///
/// Let n be the answer's normal (A leaves B along n). The face of A that looks along -n and the face of B that looks
/// along n are projected on the plane across n and intersected there. Each corner of the intersection is lifted back
/// to both faces. The depth of a pair is measured along n, so it is never more than the penetration depth, and the
/// deepest pair is that of the witnesses. Independent of engines and hosts.
///
/// A body with a margin offers the face of its core, moved along n by the margin, and a hull of spheres that of their
/// centres by their radii. Let t be the angle of the face to the plane across n. Its points but the deepest then lie
/// inside of the body by up to margin * (1 / cos t - 1), and their depths are as much too small.
///
/// Curved bodies offer a flat part where they have one (the disc of a cylinder or cone as 16 points of its rim, the
/// side as a segment), else the witness point alone. The depth itself is never taken from those points.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "pd/depth/penetration_depth.hpp"

namespace pd {

namespace detail {
struct ManifoldBuffers;
}

struct ContactPoint {
  Vec3 position_a = Vec3::Zero();  ///< on A's surface, up to what is said of margins
  Vec3 position_b = Vec3::Zero();  ///< on B's surface; position_b - position_a = depth * normal up to rounding
  double depth = 0;                ///< > 0 inside, < 0 a gap.
  /// Stays the same number while the same two features meet (vertex of A, vertex of B, or a crossing of two edges), so
  /// that a host can carry impulses from frame to frame. Below 2^53; not ordered.
  std::int64_t feature_id = 0;
};

struct ContactManifold {
  Vec3 normal = Vec3::UnitX();  ///< unit, from B to A, as the translation of A
  std::array<ContactPoint, 4> points;
  int count = 0;
};

/// Buffers of `contact_manifold`: one per thread, grown on first use.
class ManifoldScratch {
 public:
  ManifoldScratch();
  ~ManifoldScratch();
  ManifoldScratch(ManifoldScratch&&) noexcept;
  ManifoldScratch& operator=(ManifoldScratch&&) noexcept;
  [[nodiscard]] detail::ManifoldBuffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<detail::ManifoldBuffers> buffers_;
};

/// The depth that the deepest of the four points reports.
enum class DeepestPoint : std::uint8_t {
  /// The bodies' own depth, and every point lies on both bodies (their cores, moved by the margins): up to 1e-8 of the
  /// lengths at hand, and as near as the answer's bracket is wide.
  on_bodies,
  /// The bodies' own depth, for engines. Two edges within 3 degrees of each other share a stretch. The deepest corner
  /// counts as the witness where it misses the depth by the noise of a resting contact.
  at_depth,
  /// The depth of its own corner, like the other points. An engine lets a face rest on the differences between its
  /// points, and one point that is corrected alone would falsify them.
  as_lifted
};

/// The contact points of a pair whose answer is known.
///
/// @param answer  of `penetration_depth(a, b)` for these two posed shapes. Features that the bodies do not have count
/// as none, and the faces at the support points take their place.
/// @param breaking_threshold  >= 0: pairs of points with a wider gap are left out; no points when the bodies are
/// further apart than that. In the unit of the input. Four points of a larger intersection are kept: the deepest, the
/// farthest from it, and those that span the largest area. Time O(k m) in the vertices of the two faces.
/// @param deepest  on_bodies for those who judge, at_depth and as_lifted for engines.
[[nodiscard]] ContactManifold contact_manifold(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                               double breaking_threshold, ManifoldScratch& scratch,
                                               DeepestPoint deepest = DeepestPoint::on_bodies);

}  // namespace pd
