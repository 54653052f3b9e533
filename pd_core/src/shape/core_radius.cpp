#include "shape/core_radius.hpp"

#include "numeric/length.hpp"

namespace pd::detail {

namespace {

struct CoreRadius {
  double operator()(const ConvexPolytope& p) const { return p.radius(); }
  double operator()(const Ellipsoid& e) const { return e.radii.maxCoeff(); }
  double operator()(const Cylinder& c) const { return length(c.radius, c.half_height); }
  double operator()(const Cone& c) const { return length(c.radius, c.half_height); }
};

}  // namespace

double core_radius(const ConvexShape::Core& core) { return std::visit(CoreRadius{}, core); }

}  // namespace pd::detail
