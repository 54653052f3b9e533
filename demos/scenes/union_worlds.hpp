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

/// A bowl about the z axis, open upwards: a disc and two rings of `pieces` wedges each that share their faces, `radius`
/// at the rim, walls a tenth of that thick.
[[nodiscard]] WorldBody open_bowl(int pieces, double radius, const Vec3& at);
/// Twenty bowls of 25 pieces each fall into a heap on a floor, some into each other.
[[nodiscard]] ContactScene bowl_pour(std::uint64_t perturbation);
/// Two gears of 13 and 19 pieces on axles: one was spun and turns the other.
[[nodiscard]] ContactScene gear_pair(std::uint64_t perturbation);

/// A spur gear about the y axis: a hub and `teeth` wedges with straight flanks, flush in the hub. `pitch` is the radius
/// at which it meets another.
[[nodiscard]] WorldBody gear(int teeth, double pitch, double half_width, const Vec3& at);

/// For the demos: a box that slides over a flat mesh without friction, two gears on axles of which one is turned, the
/// torus on its peg.
[[nodiscard]] World slide_over_mesh(std::uint64_t seed);
[[nodiscard]] World two_gears(std::uint64_t seed);
[[nodiscard]] World torus_and_peg(std::uint64_t seed);
/// Plates thinner than the way that their edges come in a step, let go turned at random above a flat mesh.
[[nodiscard]] ContactScene thin_plates(std::uint64_t perturbation);

}  // namespace pd::scenes
