/// @file
/// Writes the convex bodies of pdepth as shapes of a contact record (`pd/record/pd_record.h`), for every recorder.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "pd/record/pd_record.h"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// Writes a core with its margin under an id. Coordinates are in the frame of the shape, lengths in its unit.
struct WriteCore {
  pd_record& record;
  const char* id;
  double margin;

  void operator()(const ConvexPolytope& polytope) const {
    if (polytope.num_vertices() == 1 && polytope.vertex(0).isZero(0) && margin > 0) {
      pd_record_sphere(&record, id, margin);
      return;
    }
    std::vector<double> points;
    for (int v = 0; v < polytope.num_vertices(); ++v) {
      const Vec3 p = polytope.vertex(v);
      points.insert(points.end(), p.data(), p.data() + 3);
    }
    pd_record_convex(&record, id, points.data(), points.size() / 3, margin);
  }
  void operator()(const Ellipsoid& ellipsoid) const {
    pd_record_ellipsoid(&record, id, ellipsoid.radii.data(), margin);
  }
  void operator()(const Cylinder& cylinder) const {
    pd_record_round(&record, id, "cylinder", cylinder.radius, cylinder.half_height, "xyz"[cylinder.axis], margin);
  }
  void operator()(const Cone& cone) const {
    pd_record_round(&record, id, "cone", cone.radius, cone.half_height, "xyz"[cone.axis], margin);
  }
  void operator()(const SphereHull& hull) const {
    std::vector<double> spheres;
    for (const Sphere& s : hull.spheres()) {
      spheres.insert(spheres.end(), {s.centre.x(), s.centre.y(), s.centre.z(), s.radius});
    }
    pd_record_spheres(&record, id, spheres.data(), hull.spheres().size(), margin);
  }
};

/// Writes a shape under an id, which must be new in the record. An error of writing shows in `record.good`. Time O(n)
/// in the vertices of the shape.
inline void record_shape(pd_record& record, const std::string& id, const ConvexShape& shape) {
  std::visit(WriteCore{record, id.c_str(), shape.margin()}, shape.core());
}

}  // namespace pd::detail
