/// @file
/// The contents of a cell are the part of a solid that lies in it: their corners in doubles, and planes along which to
/// cut them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "solid/part_corners.hpp"
#include "solid/solid_cells.hpp"

namespace pd::detail {

/// The corners of what the cell holds of the solid, the closure of the common interior: corners of the pieces of faces,
/// and corners of the cell near which the cell is solid. A face on a wall that shows its front to the cell bounds what
/// lies in the next cell.
///
/// Why these are all: near an extreme point of the contents that lies on no face, the contents are the cell alone, so
/// that the point is a corner of the cell.
class CellContents {
 public:
  /// Refers to both, which must outlive it.
  CellContents(const SolidCells& cells, const SolidCell& here);

  /// Lengths of the planes.
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  /// Adds the planes that meet in each corner.
  void add_to(PartCorners& corners) const;

  /// The largest height of a corner above the plane of a face: 0 or rounding for what is convex.
  [[nodiscard]] double largest_rise() const;

  /// The plane that leaves the smallest hulls on its two sides: a face's, or one across an axis. Nothing where no plane
  /// parts the corners.
  /// @param worst  a point that is far from the solid
  /// @param steps  grows by the work, a microsecond or several each
  [[nodiscard]] std::optional<Side> best_cut(PlaneSet& planes, const Vec3& worst, std::int64_t& steps) const;

 private:
  struct Sides;
  [[nodiscard]] Sides sides_of(const PlaneSet& planes, Side plane) const;
  [[nodiscard]] std::vector<Side> planes_of_faces(const Vec3& worst) const;
  [[nodiscard]] std::vector<Side> planes_across_axes(PlaneSet& planes, const Vec3& worst) const;

  const SolidCells& cells_;
  const SolidCell& here_;
  std::vector<const PlanePolygon*> polygons_;  ///< the pieces of faces that bound the contents
  std::vector<Vec3> points_;
  std::vector<PlaneMeet> own_corners_;  ///< corners of the cell that lie in the solid
  std::vector<Vec3> own_points_;
};

}  // namespace pd::detail
