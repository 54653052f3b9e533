/// @file
/// [A] section 3, algorithm Approx-Separation, as it stands. One ray goes from the origin to the boundary of P = B +
/// (-A) for every direction of a grid (Lemma 3.1, Theorem 3.2). `Method::grid` is its adaptive form, which shoots far
/// fewer rays for a small delta.
///
/// Let Delta(u) be the length of the ray along u, and v the direction of the nearest boundary point. Some grid
/// direction u makes an angle of at most alpha with v, and Delta(u) u lies in P, which the plane at v supports:
/// cos(alpha) Delta(u) <= <Delta(u) u, v> <= pi. So cos(alpha) min Delta <= pi. Every ray ends on a plane that supports
/// P, no farther from the origin than the ray is long: the least distance of such a plane lies in [pi, min Delta].
///
/// Departures. The answer is the translation to the nearest of those planes, never longer than the paper's shortest
/// ray. The grid's radius is arccos(1 / (1 + delta)), not sqrt(delta) (`direction_grid.hpp`). A shot is a portal
/// search (`directional_depth.hpp`), whose O(log^2 (m + n)) with hierarchies is measured, not proved.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>

#include "pd/depth/directional_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/structure/direction_grid.hpp"

namespace pd {

class Scratch;

struct ApproximateSeparationSettings {
  GridKind grid = GridKind::geodesic;
  /// portal, or hierarchy: with supports from the bodies' inner hierarchies.
  DirectionalMethod shot = DirectionalMethod::portal;
  /// For DirectionalMethod::hierarchy: those of the two bodies' polytopes, or nullptr (they are built, in linear time).
  const DirectionalHierarchies* hierarchies = nullptr;
  std::int64_t max_rays = std::int64_t{1} << 22;
};

/// Lengths in the unit of the input, vectors in the frame that A and B share; all zero unless the bodies overlap.
struct ApproximateSeparation {
  ContactClass contact = ContactClass::separated;  ///< exact
  double lower = 0;                                ///< lower <= pi(A, B) <= upper <= (1 + delta) lower
  double upper = 0;
  Vec3 translation = Vec3::Zero();  ///< separates A from B exactly as stored; |translation| <= upper
  Vec3 normal = Vec3::UnitX();      ///< unit; translation / |translation|
  /// The paper's own output, min Delta(u) u, rounded; margins added along it. Zero where no ray was shot.
  Vec3 shortest_ray = Vec3::Zero();
  std::int64_t rays = 0;          ///< O(1 / delta)
  std::int64_t ray_supports = 0;  ///< supports of P that they asked for
  Statistics statistics;          ///< with the test for overlap
};

/// A separating translation of length at most (1 + delta) pi, for polytopes with or without margins.
///
/// Where the cores do not overlap (bodies that overlap by their margins alone included) the answer is exact and no ray
/// is shot.
///
/// @param delta  in (0, 1].
/// @return ErrorCode::bad_value ("delta"). limit_exceeded ("delta") where the grid needs more than `max_rays`, which is
/// known before the first of them. `unsupported` for smooth bodies (""), and for another shot than portal or
/// hierarchy ("shot"). `not_full_dimensional` for hierarchies of flat bodies. Errors of the given hierarchies are those
/// of `directional_depth`.
/// Time O(m + n + S / delta), S a shot: about 2.7 / delta of them (geodesic) or 6.2 / delta.
[[nodiscard]] Expected<ApproximateSeparation> approximate_separation(
    const PosedShape& a, const PosedShape& b, double delta, Scratch& scratch,
    const ApproximateSeparationSettings& settings = {});

}  // namespace pd
