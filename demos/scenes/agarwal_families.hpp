/// @file
/// The families of pairs on which the bounds of [A] are measured: pairs with a quadratic number K of facets of P = B +
/// (-A), pairs whose facets are all nearly as near, and pairs with a linear K beside them.
///
/// In all of them A lies below, B above: A's top (its support in +z) and B's bottom overlap by `overlap` along z, which
/// is the depth or close to it. Numbers as in `shape_families.hpp`: functions of the parameters and a seed, made with
/// +,
/// -, *, /, sqrt only.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
/// [FHW] Fogel, Halperin, Weibel, "On the exact maximum complexity of Minkowski sums of polytopes", 2009.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "scenes/shape_families.hpp"

namespace pd::scenes {

struct PolytopePair {
  ConvexPolytope a;
  ConvexPolytope b;
  Pose pose_a;
  Pose pose_b;
};

/// Two plano-convex lenses crossed at right angles: an arc of m edges with slopes over [-eta, eta] on a chord, extruded
/// by 1 to both sides, with flat caps. Every edge of one arc's rims meets every edge of the other's: m^2 edge-edge
/// facets, and O(m) others (of an odd m, (m - 1)^2: the flat tops are parallel). Requires m >= 2, eta > 0.
[[nodiscard]] PolytopePair lens_pair(int m, double eta, double overlap);

struct PatchShape {
  double eta = 0.5;     ///< the slopes of the m edges run over [-eta, eta]
  double jitter = 0.2;  ///< radial noise, in units of (slope step)^2
  double tilt = 0;      ///< each edge is turned out of the profile's plane by up to this many slope steps over eta
};

/// The round patch: of each body an arc of m edges on a circle of radius 1, one in the plane y = 0, the other in x = 0.
/// The faces beside an arc are steeper than eta, so that its edge with slope a is extreme for all normals (a, b, 1),
/// |b|
/// <= eta: m^2 edge-edge facets. At overlap 1 they stand at (sqrt(1 + a^2) + sqrt(1 + b^2) - 1) / sqrt(1 + a^2 + b^2)
/// from the origin: all nearly tied, and a search by support functions alone meets Theta(K) of them. Each body ends in
/// apexes, not in flat caps, and its far ends are tapered. With `tilt` the arcs of the two normal diagrams are no
/// longer straight lines through common points, which defeats pruning by blocks; 0.2 keeps all m^2 crossings.
/// Requires m >= 2, eta > 0. Time O(m log m).
[[nodiscard]] PolytopePair round_patch(int m, const PatchShape& shape, double overlap, std::uint64_t seed);

/// The round patch with slopes up to 0.1 and bodies of n >= 12 vertices each.
[[nodiscard]] PolytopePair crossed_roofs(int n, double overlap, std::uint64_t seed);

/// Two vaults crossed at right angles, each an arc of n - 4 points of a unit circle over slopes of 15 degrees to both
/// sides, their slopes off by up to a quarter of a step, closed by four far corners that half of the arc's points are
/// joined to. The bodies are off their places by up to 1e-3 along each axis, so that nothing is tied by symmetry. At
/// overlap 1 the top of each is at the middle of the other's circle, and all facets are nearly tied. Requires n >= 7.
[[nodiscard]] PolytopePair jittered_roofs(int n, double overlap, std::uint64_t seed);

/// Polytopes with `facets_a` and `facets_b` facets (each >= 4) and the most facets that a sum of such two can have, 4mn
/// - 9m - 9n + 26 [FHW]. Built otherwise than there: a simple polytope all of whose 2m - 4 vertices lie on its shadow,
/// pressed nearly flat; of two such, crossed, every two vertices make a vertex of P, and Euler's formula gives K.
[[nodiscard]] PolytopePair fogel_halperin_weibel(int facets_a, int facets_b, double overlap);

/// Hulls of n random points on the unit sphere, turned at random: K is linear in n.
[[nodiscard]] PolytopePair sphere_hulls(int n, double overlap, std::uint64_t seed);

/// Two balls of radius 1 with n vertices each, evenly spread along spirals, turned at random: near overlap 2
/// (concentric) all of the about 6 n facets are nearly tied.
[[nodiscard]] PolytopePair ball_pair(int n, double overlap, std::uint64_t seed);

enum class AgarwalFamily : std::uint8_t {
  lens,                   ///< eta = 0.5
  patch,                  ///< round patch, eta = 0.5
  low_patch,              ///< eta = 0.1
  flat_patch,             ///< eta = 1 / m
  tilt_noise,             ///< eta = 0.5, tilt 0.2
  low_tilt_noise,         ///< eta = 0.1
  flat_tilt_noise,        ///< eta = 4 / m
  crossed_roofs,          ///< m edges on each arc
  fogel_halperin_weibel,  ///< m facets on each body
  sphere_hulls,           ///< m vertices
  balls,                  ///< m vertices
};
[[nodiscard]] std::span<const AgarwalFamily> agarwal_families();
[[nodiscard]] std::string_view to_string(AgarwalFamily family);
/// K grows as m^2 (as m otherwise).
[[nodiscard]] bool is_quadratic(AgarwalFamily family);

/// shallow and mid: overlap 0.01 and 0.1; gap: 0.01 apart; deep: where the facets are most nearly tied. m >= 4.
[[nodiscard]] PolytopePair make_agarwal_pair(AgarwalFamily family, int m, DepthClass depth, std::uint64_t seed);

}  // namespace pd::scenes
