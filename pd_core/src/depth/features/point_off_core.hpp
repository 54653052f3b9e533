/// @file
/// How far a point lies outside a core with flat faces or an axis.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// At most the distance of a local point from a solid polytope, a cylinder or a cone, up to rounding; 0 inside. Near a
/// face it is that distance. Infinite where the core is another.
struct PointOffCore {
  Vec3 point;

  double operator()(const ConvexPolytope& p) const {
    double off = 0;
    for (int f = 0; f < p.num_facets(); ++f) {
      off = std::max(off, p.facet_normal(f).dot(point - p.vertex(p.facet_vertices(f)[0])));
    }
    return off;
  }
  double operator()(const Cylinder& c) const {
    return std::hypot(std::max(0.0, across(c.axis) - c.radius), std::max(0.0, std::abs(point[c.axis]) - c.half_height));
  }
  double operator()(const Cone& c) const {
    const double height = 2 * c.half_height;
    const double slant =
        (height * across(c.axis) + c.radius * (point[c.axis] - c.half_height)) / std::hypot(height, c.radius);
    return std::max({0.0, slant, -c.half_height - point[c.axis]});
  }
  template <class Other>
  double operator()(const Other& /*no faces*/) const {
    return std::numeric_limits<double>::infinity();
  }

 private:
  [[nodiscard]] double across(int axis) const { return std::hypot(point[(axis + 1) % 3], point[(axis + 2) % 3]); }
};

}  // namespace pd::detail
