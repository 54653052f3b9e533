/// @file
/// Planes through pairs of edges of a solid: cuts that end a reflex edge, where two convex parts may meet.
///
/// A part is convex only if every reflex edge of the solid lies on its walls. A plane through a reflex edge and another
/// edge, which lies behind both faces of the first, ends the reflex edge there and begins no new one. Edges of smooth
/// surfaces are left out.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/shape/mesh_solid.hpp"
#include "solid/convex_cell.hpp"

namespace pd::detail {

/// Immutable.
class SharpEdges {
 public:
  /// Refers to the solid, which must outlive it. @param exponent  lengths of the planes = the solid's * 2^-exponent
  SharpEdges(const MeshSolid& solid, int exponent);

  /// Planes through the reflex edges in a cell that are nearest to a point (lengths of the planes), a few for each.
  [[nodiscard]] std::vector<Side> planes_in(const ConvexCell& cell, PlaneSet& planes, const Vec3& near) const;

 private:
  struct Edge {
    std::int32_t vertices[2];
    Vec3 p, q;  ///< lengths of the planes
    bool reflex;
    Vec3 normals[2];  ///< of the two faces, unit
  };
  struct Ranked {
    double distance;
    const Edge* edge;
    bool operator<(const Ranked& other) const { return distance < other.distance; }
  };
  /// Keeps the nearest ones.
  static void keep(std::vector<Ranked>& list, std::size_t most, const Ranked& found);
  [[nodiscard]] Side plane_through(const Edge& edge, std::int32_t vertex, PlaneSet& planes) const;

  const MeshSolid& solid_;
  std::vector<Edge> edges_;
};

}  // namespace pd::detail
