/// @file
/// Scenes of `contact_worlds.hpp` in which bodies are let go from a height or under a heavy load.
#pragma once

#include "scenes/contact_worlds.hpp"

namespace pd::scenes {

/// Spheres, boxes and cylinders that fall 2 m on a floor with this restitution of each pair.
[[nodiscard]] ContactScene rebound(double restitution, std::uint64_t perturbation);
/// A slab of nine boxes that lies on a slab of a two-hundredth of its weight.
[[nodiscard]] ContactScene heavy_slab(std::uint64_t perturbation);
/// Ten boxes of two metres that fall 19 m as a column.
[[nodiscard]] ContactScene dropped_column(std::uint64_t perturbation);

/// Fifty gears with a bore fall into a heap: a solid cut by `decompose` into convex parts that cover it within a
/// hundredth of a metre. Every second one is drawn by its parts, the others as the solid.
[[nodiscard]] World pour_of_gears(std::uint64_t seed);

}  // namespace pd::scenes
