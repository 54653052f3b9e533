/// @file
/// Quickhull in three dimensions with exact visibility, on triangles.
///
/// Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls", 1996. Departure: no facet is thickened and
/// none is merged on the way. A point sees a triangle when it lies strictly above its plane, exactly. Coplanar
/// triangles therefore are seen all or none, the seen region is a topological disc whose rim runs along edges between
/// facets of different planes, and every new triangle is proper. What remains is a triangulation of the boundary of the
/// hull in which coplanar neighbours, and vertices inside facets and edges, may occur (`facet_loops.hpp` merges them).
#pragma once

#include <cstdint>
#include <vector>

#include "shape/hull/affine_frame.hpp"
#include "shape/hull/hull_points.hpp"

namespace pd::detail {

struct HullTriangle {
  std::int32_t vertex[3];     ///< counter-clockwise from outside
  std::int32_t neighbour[3];  ///< across the edge vertex[i] -> vertex[i + 1]
  double normal[3];           ///< rounded, not normalised
  double offset;              ///< rounded <normal, vertex[0]>
  double error;  ///< bounds |height() - true| for every point in [-1, 1]^3; 0: the sign of height() is that of one
                 ///< difference
  double furthest_height;      ///< of the first outside point
  std::int32_t first_outside;  ///< list of the points assigned to this triangle; -1: none, kDead: not of the hull
  std::int32_t mark;           ///< stamp of the last insertion that looked at it

  static constexpr std::int32_t kDead = -2;
  [[nodiscard]] bool dead() const { return first_outside == kDead; }
  [[nodiscard]] double height(const HullPoint& p) const {
    return normal[0] * p.x + normal[1] * p.y + normal[2] * p.z - offset;
  }
};

class Quickhull {
 public:
  /// Starts from the frame's tetrahedron. Requires frame.dimension == 3. Refers to `points`, which may grow.
  Quickhull(HullPoints& points, const AffineFrame& frame);

  /// Completes the hull with the points of index first .. last - 1. Expected time O(k log k) for k of them outside.
  void insert(int first, int last);

  /// Triangles, dead ones among them.
  [[nodiscard]] const std::vector<HullTriangle>& triangles() const { return triangles_; }
  /// Moves the living triangles to the front and drops the dead.
  void compact();

  /// Sign of the height of point p above triangle t, exact.
  [[nodiscard]] int side(const HullTriangle& t, int p) const {
    const double height = t.height(points_[p]);
    if (height > t.error) return 1;
    if (height < -t.error) return -1;
    if (t.error == 0 && points_.scaling_exact()) return 0;
    return points_.orient3d(t.vertex[0], t.vertex[1], t.vertex[2], p);
  }

 private:
  struct RimEdge {
    std::int32_t from, to;
    std::int32_t beyond;       ///< the unseen triangle
    std::int32_t beyond_edge;  ///< its edge
  };

  HullTriangle make_triangle(int a, int b, int c) const;
  /// Points are often given on planes across an axis; there one difference of coordinates decides, exactly.
  void align_with_axis(HullTriangle& t, int axis) const;
  [[nodiscard]] std::int32_t allocate();
  void add_outside(std::int32_t triangle, int p);
  void add_vertex(std::int32_t triangle);
  void find_rim(std::int32_t seed, int p);
  HullTriangle& at(std::int32_t t) { return triangles_[static_cast<std::size_t>(t)]; }

  HullPoints& points_;
  std::vector<HullTriangle> triangles_;
  std::vector<std::int32_t> free_;
  std::vector<std::int32_t> pending_;  ///< triangles that may have outside points
  std::int32_t stamp_ = 0;             ///< 2k: seen in insertion k, 2k + 1: looked at and not seen

  struct Visit {
    std::int32_t triangle;
    std::int32_t first_edge;
    std::int32_t edges_left;
  };
  std::vector<Visit> visits_;
  std::vector<std::int32_t> seen_;
  std::vector<RimEdge> rim_;
  std::vector<std::int32_t> fan_;
};

}  // namespace pd::detail
