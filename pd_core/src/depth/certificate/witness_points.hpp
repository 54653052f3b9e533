/// @file
/// Witness points: the nearest point of P's boundary split into a point of A and a point of B.
#pragma once

#include "depth/certificate/support_faces.hpp"
#include "depth/distance/gjk_exact.hpp"

namespace pd::detail {

/// The two nearest points of the cores, in the frame that A and B share.
struct CorePoints {
  Vec3 a;
  Vec3 b;
};

/// The point of the nearest facet at the core's translation, split into a point of A's face and one of B's.
/// @param unit  the facet's outward unit normal.
[[nodiscard]] CorePoints witness_points_overlapping(const PosedPair& pair, const SupportFaces& faces, const Vec3& unit,
                                                    const Vec3& translation);

/// The nearest points of cores that are apart or touch, from the weights of the simplex.
[[nodiscard]] CorePoints witness_points_separated(const PosedPair& pair, const VertexPair* simplex,
                                                  const double* weights, int count);

}  // namespace pd::detail
