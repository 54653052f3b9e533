/// @file
/// The pairs that are measured: which families, sizes and depths, and the bodies of each draw.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/peers/solver.hpp"

namespace pd::bench {

/// What the bench makes of a family of the scenes.
enum class Variant : std::uint8_t {
  own,             ///< the family itself
  jittered,        ///< of roofs: `scenes::jittered_roofs`
  ellipsoid,       ///< of spheres: points on an ellipsoid of semi-axes 1, 1/2, 1/4
  flat,            ///< of spheres: semi-axes 1, 1, 1/100
  nearly_aligned,  ///< of cubes: B turned by 1e-7 rad
  resting          ///< of cubes: a box at rest on another, turned about the vertical
};

/// One row of the table: a family, its size and how deep the bodies stand.
struct Cell {
  scenes::PairFamily family;
  int vertices;
  scenes::DepthClass depth;
  Variant variant = Variant::own;
  bool turned = false;  ///< cubes, grids and roofs: both bodies by one random rotation, which all others have anyway
  /// Each body's points stand in a random frame and are rounded to single precision, as a mesh file holds them.
  bool from_files = false;
};

/// The family's name.
[[nodiscard]] std::string_view name_of(const Cell& cell);

struct Draw {
  Bodies bodies;
  Pose pose_a;
  Pose pose_b;
};

/// Families by name, sizes by number; both empty = all that the bench knows. `quick` leaves the dear ones out.
/// An unknown family is an Error that names it.
[[nodiscard]] Expected<std::vector<Cell>> choose_cells(const std::vector<std::string>& families,
                                                       const std::vector<int>& vertices, bool quick);

/// The point of the shape, turned by `rotation`, that is extreme in the direction.
[[nodiscard]] Vec3 extreme(const ConvexShape& shape, const Mat3& rotation, const Vec3& direction);

struct Extent {
  Vec3 middle;  ///< of the bounding box in the shape's own frame
  Vec3 size;    ///< of its sides
};
[[nodiscard]] Extent extent_of(const scenes::Points& points);

/// Random attitudes; then the extreme points of a random direction meet and go on by 1 % (shallow) or 10 % (mid) of
/// `size`, or the middles nearly coincide (deep).
[[nodiscard]] Draw placed(const Bodies& bodies, double size, scenes::DepthClass depth, scenes::Random& random);

/// The pair of this number. Cubes are placed here, aligned with the axes (or nearly) and overlapping by 1/64 or 1/8 of
/// a unit, or at rest, in each other by 1e-6 (shallow), 1e-4 (mid) or 1e-2 (deep) of a unit; needles, ellipsoids and
/// flat hulls by `placed`; all others are the scenes' own. Nothing where the bodies happen not to be what the cell asks
/// for (the next number is another draw).
[[nodiscard]] std::optional<Draw> draw(const Cell& cell, std::uint64_t seed, std::uint64_t number);

}  // namespace pd::bench
