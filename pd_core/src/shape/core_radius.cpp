#include "shape/core_radius.hpp"

#include <algorithm>

#include "numeric/length.hpp"

namespace pd::detail {

namespace {

struct CoreRadius {
  double operator()(const ConvexPolytope& p) const { return p.radius(); }
  double operator()(const Ellipsoid& e) const { return e.radii.maxCoeff(); }
  double operator()(const Cylinder& c) const { return length(c.radius, c.half_height); }
  double operator()(const Cone& c) const { return length(c.radius, c.half_height); }
  double operator()(const SphereHull& hull) const {
    double farthest = 0;
    for (const Sphere& s : hull.spheres()) {
      farthest = std::max(farthest, length(length(s.centre.x(), s.centre.y()), s.centre.z()) + s.radius);
    }
    return farthest;
  }
};

}  // namespace

double core_radius(const ConvexShape::Core& core) { return std::visit(CoreRadius{}, core); }

}  // namespace pd::detail
