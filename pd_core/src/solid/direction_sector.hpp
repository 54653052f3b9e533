/// @file
/// An open convex cone of directions, bounded by planes through the origin, exactly.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "numeric/dyadic.hpp"

namespace pd::detail {

/// {d : <w, d> > 0 for all walls w}, with no line in it. Walls follow each other counter-clockwise as seen from the
/// origin's opposite, so that the cross product of a wall and the next is the ray between the two.
class DirectionSector {
 public:
  /// Eight sectors whose closures cover all directions.
  static std::vector<DirectionSector> octants();

  /// Keeps the directions with <normal, d> > 0.
  /// @return false: none is left, and the sector is void.
  bool cut(const Dyadic3& normal);
  /// True if directions of the sector lie on both sides of the plane.
  [[nodiscard]] bool is_crossed_by(const Dyadic3& normal) const;
  [[nodiscard]] bool holds(const Dyadic3& direction) const;
  /// The sum of the unit vectors along the rays, rounded, so that it may lie outside of a thin sector.
  [[nodiscard]] Vec3 middle() const;

 private:
  struct Wall {
    Dyadic3 normal;
    Dyadic3 ray;  ///< between this wall and the next
    Vec3 unit;    ///< along the ray, rounded
  };
  explicit DirectionSector(const std::array<Dyadic3, 3>& normals);
  /// Sets the ray of each wall.
  void set_rays();
  [[nodiscard]] std::vector<int> sides_of_rays(const Dyadic3& normal) const;

  std::vector<Wall> walls_;
};

/// The vector in doubles, with components of at most 1.
[[nodiscard]] Vec3 rounded_unit(const Dyadic3& vector);

}  // namespace pd::detail
