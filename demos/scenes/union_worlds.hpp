/// @file
/// Worlds of decomposed bodies: rings that are unions of convex pieces, on a peg and in a heap.
#pragma once

#include "scenes/contact_worlds.hpp"

namespace pd::scenes {

/// A torus about the z axis in `pieces` wedges that share their end faces: tube of an octagon of circumradius `tube`
/// about a circle of radius `ring`. Moves, mass by volume (roughly) of 700 kg/m^3.
[[nodiscard]] WorldBody torus(int pieces, double ring, double tube, const Vec3& at);

/// A torus (hole of radius .35) tilted on a standing peg of radius .28: it slides down, and must not jam.
[[nodiscard]] ContactScene torus_on_peg(std::uint64_t perturbation);
/// Fifty tori of twelve pieces fall into a heap on a floor, some through each other's holes.
[[nodiscard]] ContactScene torus_pour(std::uint64_t perturbation);

}  // namespace pd::scenes
