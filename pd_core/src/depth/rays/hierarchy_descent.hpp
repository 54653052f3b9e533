/// @file
/// Where a line leaves P = B + (-A), by descending the inner hierarchies of both bodies: [D] section 5.2, algorithm
/// Compute-Depth-3D, in O(log n log m).
///
/// The state is a portal, a triangle of vertices of P that the line crosses, as in portal.hpp. Let its plane H support
/// B_j - A_i, for levels i and j of the two hierarchies. At most one vertex u of A_{i-1} lies beyond H's plane on A
/// (those beyond are connected and independent); the part of A_{i-1} beyond it lies in the hull of u and its at most 8
/// neighbours (the cap of [D]). So the portal is pushed outwards with this list for A. Its new plane has a corner at u,
/// because u was beyond; u is extreme among its neighbours, hence in all of A_{i-1}, and the plane supports
/// B_j - A_{i-1}. For B the same. [D] Corollary 5.5, a cap against all of B, is the descent of B for a fixed list of A:
/// O(log m) lists of at most 9 against 9 vertices. The body with fewer levels gives the outer loop.
///
/// Departures.
/// - [D] step 1D takes the larger depth of (cap of P, Q) and (P, cap of Q) for a plane that merely separates. That is
///   wrong where the direction points into P's side: the last contact may pair a vertex beyond H with one that is not.
///   Here a plane always supports the difference where the line leaves it, for which the argument above holds, and only
///   one body descends at a time.
/// - Phase 1 (the levels do not meet) needs no search of its own: three corners of the first portal are infinitely far
///   behind, z_k = -M^2 d + M g_k for M beyond all bounds. While one of them is left, the portal's plane is parallel to
///   d and separates the shadows of the levels along d.
/// - [D] asks hierarchies of P_i's outer side for lines; both line queries come out of the same descent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "depth/difference/direction_signs.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::detail {

struct HierarchyDescentResult {
  /// Counter-clockwise seen against the direction. Empty: the line does not meet the interior of P.
  std::optional<std::array<VertexPair, 3>> corners;
  /// The line itself, not only one moved by infinitely little, meets the interior of P.
  bool crosses = false;
  std::int64_t steps = 0;        ///< vertices evaluated and signs asked for
  std::int64_t certificate = 0;  ///< edges looked at in the end: all that leave the corners' vertices
  std::int32_t caps = 0;         ///< vertices of either body that came in
  std::int32_t repairs = 0;      ///< vertices that the descent lost to rounding, and the certificate found
};

/// A body's inner hierarchy and the finest level that counts. Without one the body is its own cap: of any affine
/// dimension, with at most kMaxDegree + 1 vertices ([D] Corollary 5.5).
struct DescentSide {
  const PolyhedralHierarchy* hierarchy = nullptr;
  int finest = 0;
};

/// At least one side has a hierarchy, of its polytope in the pair. Decisions by exact signs; where the path through the
/// levels is lost to rounding (a tie of values), the exact check at level 0 resumes from where it stands. At coarser
/// levels there is no such check, and the plane supports up to rounding.
[[nodiscard]] HierarchyDescentResult descend_hierarchies(const DirectionSigns& ray, const DescentSide& a,
                                                         const DescentSide& b);

/// Returns why a caller's hierarchy does not serve a body, empty if it does. Time: O(n) if the body is equal to the
/// hierarchy's own polytope but does not share its storage.
/// @param where  names the hierarchy for the error.
[[nodiscard]] std::optional<Error> refuse_hierarchy(const PolyhedralHierarchy* hierarchy, const ConvexPolytope& body,
                                                    const char* where);

}  // namespace pd::detail
