/// @file
/// The convex hull of points of P in doubles, kept by exact signs: where a surface in doubles loses its convexity.
///
/// Near contact ruled bodies (cylinders, cones, against edges) leave faces as long as the bodies and 1e-8 wide.
/// Rounding turns their planes, so that the faces visible from a new point by their planes are not those that are
/// (inner_surface.hpp), and the surface loses its convexity: the lower bound, still true, falls. Exact orientation
/// (predicates.hpp) of the stored points keeps every step a convex hull: the faces strictly visible from a point
/// outside form one disc, and no new face is degenerate, since a point in line with the disc's border lies in the plane
/// of a face visible from it. Distances of planes are taken in double-double. A step costs some microseconds, so only
/// queries that lost convexity come here.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/growing_hull.hpp"
#include "depth/expansion/surface_check.hpp"

namespace pd::detail {

struct ExactHullFace {
  std::int32_t v[3] = {-1, -1, -1};  ///< counter-clockwise from outside
  std::int32_t adj[3] = {-1, -1, -1};
  Vec3 unit_normal;
  double distance = 0;  ///< signed, of the plane from the origin; relative error of some u, as the normal's
  bool alive = true;
};

class ExactHull : public GrowingHull<ExactHull, ExactHullFace> {
 public:
  using Face = ExactHullFace;

  std::vector<DifferenceVertex> vertices;

  void clear();
  /// Four of the vertices that span a volume become the first faces. False when all lie in one plane.
  bool start();
  /// Puts the last vertex in. False when it does not lie strictly outside face `from`.
  bool insert(int from);
  /// The face whose plane is nearest (signed).
  [[nodiscard]] int nearest() const;
  /// Number of faces alive. Time O(slots).
  [[nodiscard]] int size() const;

  /// The faces in use, numbered without gaps, and all vertices.
  void snapshot(SurfaceSnapshot& out) const;
  /// The first invariant that is broken (surface_check.hpp), exact convexity among them, or nothing.
  [[nodiscard]] std::optional<SurfaceFault> validate() const;

 private:
  friend class GrowingHull<ExactHull, ExactHullFace>;
  [[nodiscard]] const Vec3& at(std::int32_t v) const { return vertices[static_cast<std::size_t>(v)].x; }
  [[nodiscard]] int side(int f, int v) const;
  void forget(int /*slot*/) const {}
  void measure(Face& f) const;

  int checked_insertions_ = 0;  ///< see validate_after_insertion
};

}  // namespace pd::detail
