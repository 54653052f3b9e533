/// @file
/// The boundary of a non-convex Minkowski difference, built: [A] section 4 names it as the O(m^3 n^3) way to the depth
/// of two non-convex polytopes, and for star-shaped bodies as the upper envelope of O(mn) triangles seen from the
/// common centre. For small bodies, and as the judge of the faster searches.
///
/// P = B + (-A) is the union of the convex P_ij = B_j + (-A_i). The boundary of int P is what is left of the facets of
/// each P_ij when the interiors of the others, and what faces it across walls of zero width, are cut away. Departure
/// from the paper: no arrangement and no envelope is swept. Each facet is cut by the P_ij that meet it. Most facets are
/// buried in P, which cubes of translations tell in doubles (`src/compound/cover_cubes.hpp`).
///
/// A star-shaped body's difference is star-shaped about c_B - c_A, so that this boundary is the radial envelope itself.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/compound/compound_depth.hpp"

namespace pd {

struct UnionDifference {
  struct Facet {
    Vec3 normal;  ///< outward, unit, rounded
    std::int32_t part_a;
    std::int32_t part_b;
    Feature on_a;  ///< the faces of the two parts whose difference holds it
    Feature on_b;
    std::int32_t first;  ///< its corners are `corners[first .. first + count)`, counter-clockwise from outside
    std::int32_t count;
  };
  /// Exact points rounded once; those that round alike are one vertex. In lexicographic order.
  std::vector<Vec3> vertices;
  /// Convex polygons that tile the boundary of int P: no point lies inside two of them. A corner may lie inside a
  /// neighbour's edge.
  std::vector<Facet> facets;
  std::vector<std::int32_t> corners;
  UnionStatistics work;
};

/// The budget of a union's difference: polygons looked at and cut, some 25 microseconds each. 512 tests in doubles are
/// one such unit. Two stars of 26 vertices take 23,000, of 53 vertices 121,000.
inline constexpr std::int64_t kDifferenceWork = std::int64_t{1} << 17;

/// Builds the boundary of int P for unions of polytopes without margins.
/// @param max_facets  of the P_ij, and of the boundary.
/// @param max_work    polygons looked at and cut, as above.
/// @return ErrorCode::limit_exceeded beyond them; unsupported for other shapes; out_of_range as `penetration_depth`.
/// Time O(N F C) for N pairs of parts, F facets of P_ij and C the cuts of one facet; measured by `bench_union`.
[[nodiscard]] Expected<UnionDifference> minkowski_difference(const PosedCompound& a, const PosedCompound& b,
                                                             std::int64_t max_facets = std::int64_t{1} << 20,
                                                             std::int64_t max_work = kDifferenceWork);

}  // namespace pd
