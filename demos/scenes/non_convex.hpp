/// @file
/// Non-convex test bodies: unions of boxes and hulls, and star-shaped surfaces. As the families of convex bodies, the
/// same bits everywhere.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "scenes/shape_families.hpp"

namespace pd::scenes {

/// A convex part of a union: the points of its hull and where it stands.
struct PointPart {
  Points points;
  Pose pose;
};
using PartList = std::vector<PointPart>;

/// Arms of length 2 and thickness 1 (half extents), abutting without overlap.
[[nodiscard]] PartList letter_l();
/// A channel with an opening of the given width, 2 deep and 2 long: three abutting boxes. A body of exactly that width
/// that stands in it has a slot of zero width on both sides.
[[nodiscard]] PartList letter_u(double opening);
/// Three bars of half length 2 and half thickness 0.5 through the origin, along the axes.
[[nodiscard]] PartList cross();
/// Two round ends of n vertices each, joined by a thin bar.
[[nodiscard]] PartList dumbbell(int n, Random& random);
/// `layers` abutting boxes, each of the size 2 x 2 x height, in a column about the origin.
[[nodiscard]] PartList stack(int layers, double height);
/// A closed room of half extent `half` inside walls of thickness `wall`: six abutting boxes about a cavity.
[[nodiscard]] PartList room(double half, double wall);
/// `parts` random hulls of n vertices, scattered in a ball of radius 2, in random poses.
[[nodiscard]] PartList rubble(int parts, int n, Random& random);

/// Triangles of a closed surface, counter-clockwise from outside.
struct Surface {
  Points vertices;
  std::vector<std::array<std::int32_t, 3>> faces;
  Vec3 centre = Vec3::Zero();
};
/// The icosphere of `levels` subdivisions (20 * 4^levels faces), each vertex at a random distance in [1 - roughness,
/// 1].
[[nodiscard]] Surface rough_ball(int levels, double roughness, Random& random);
/// A cube's surface with a spike of the given height on the middle of each face: 24 faces, star-shaped about the
/// origin.
[[nodiscard]] Surface spiked_star(double height);
/// A prism of height 1 over a star polygon with k rough spikes of radius up to 1 and corners at radius `inner` between
/// them: 8 k faces, star-shaped about the origin.
[[nodiscard]] Surface star_prism(int k, double inner, Random& random);

}  // namespace pd::scenes
