/// @file
/// A convex body of the oracle: the raw points, and by exact arithmetic a list of edges and facet directions that is
/// sure to hold every edge and facet of their hull (it may hold more: that only adds candidates, never a wrong answer).
#pragma once

#include <span>
#include <vector>

#include "oracle/exact_integer.hpp"

namespace pd::oracle {

/// Built once a body, used by many pairs. Points are relative to `reference` = the first point, so that a body far from
/// its own origin loses nothing.
class Body {
 public:
  /// Requires at least one point, all finite.
  explicit Body(std::span<const Vec3> points);

  struct Edge {
    int from;
    int to;
    int left;  ///< facet direction, -1 for a segment
    int right;
    int direction;  ///< class of exactly parallel edges, all stored running the same way
  };
  /// A facet direction: three of its points, counter-clockwise from outside.
  struct Facet {
    int corner[3];
    Vec3 unit_normal;  ///< within 2^-50
  };
  struct Triangle {
    int corner[3];
    int facet;
  };

  int dimension = 0;
  int num_directions = 0;  ///< classes of parallel edges
  int exponent = 0;        ///< exact coordinates = integers * 2^exponent
  Vec3 reference;
  std::vector<int> vertices;  ///< points that bear an edge (or the only point)
  std::vector<IVec> exact;    ///< [points] relative to the reference
  std::vector<Edge> edges;
  std::vector<Vec3> edge_units;      ///< [edges] within 2^-50
  std::vector<int> direction_edges;  ///< [num_directions] one edge of each class
  std::vector<Facet> facets;
  std::vector<Triangle> triangles;  ///< cover the surface; for a polygon both sides
  std::vector<Vec3> relative;       ///< [points] rounded, in the true scale times 2^-scale_exponent
  int scale_exponent = 0;           ///< so that |relative| <= 1

 private:
  struct Face;
  void build_flat();
  void build_solid(const int (&start)[4]);
  void insert_point(int p, std::vector<Face>& faces, std::vector<int>& alive) const;
  std::vector<int> merge_coplanar(const std::vector<Face>& faces, const std::vector<int>& alive);
  void finish();
  [[nodiscard]] int orientation(int a, int b, int c, int d) const;
};

}  // namespace pd::oracle
