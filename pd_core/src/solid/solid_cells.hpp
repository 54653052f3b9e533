/// @file
/// Cells of space that planes cut exactly, with the pieces of a solid's faces that lie in each.
///
/// The cells that stem from `whole` tile a cube that holds the solid. A corner is the meeting point of three planes, so
/// that numbers do not grow with the number of cuts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pd/shape/mesh_solid.hpp"
#include "pd/shape/pose.hpp"
#include "solid/convex_cell.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

/// A cell, and the pieces of faces in its interior and on its walls.
struct SolidCell {
  ConvexCell cell;
  std::vector<PlanePolygon> faces;
  std::vector<PlanePolygon> on_walls;
};

class SolidCells {
 public:
  /// Refers to the solid, which must outlive it.
  explicit SolidCells(const MeshSolid& solid);
  SolidCells(const SolidCells&) = delete;
  SolidCells& operator=(const SolidCells&) = delete;

  /// The cube around the solid with all its faces.
  [[nodiscard]] SolidCell whole();

  /// The parts of a cell on both sides of a plane; nothing where a side has no interior.
  struct Halves {
    std::optional<SolidCell> inside;
    std::optional<SolidCell> beyond;
  };
  [[nodiscard]] Halves split(SolidCell here, Side plane);

  /// A cell without faces inside is all solid or all empty; nothing where that cannot be told.
  [[nodiscard]] std::optional<bool> is_solid(const SolidCell& here) const;
  /// The place of the cell's middle; nothing where rounding keeps the middle from lying inside.
  [[nodiscard]] std::optional<bool> middle_is_solid(const ConvexCell& cell) const;
  /// False for a corner of a cell (lengths of the planes) near which the cell is empty for certain. Requires a corner
  /// of the cell.
  [[nodiscard]] bool may_be_solid_at(const SolidCell& here, const Vec3& corner) const;
  /// True for a point that lies in the solid, when the point is taken as it is in doubles.
  [[nodiscard]] bool holds(const Vec3& x) const;

  [[nodiscard]] PlaneSet& planes() { return planes_; }
  [[nodiscard]] const PlaneSet& planes() const { return planes_; }
  /// Lengths of the planes = lengths of the solid * 2^-exponent.
  [[nodiscard]] int exponent() const { return exponent_; }
  /// Pieces of faces that were made.
  [[nodiscard]] std::int64_t polygons() const { return polygons_; }

 private:
  [[nodiscard]] PlanePolygon polygon_of(const MeshSolid::Triangle& t);
  [[nodiscard]] PosedPoint posed(const Vec3& x) const;

  const MeshSolid& solid_;
  Pose identity_;
  PosedSolids alone_;
  int exponent_;
  PlaneSet planes_;
  std::int64_t polygons_ = 0;
};

}  // namespace pd::detail
