/// @file
/// Whether a core is the one that a memory was made of.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// Equal curved cores, or the same stored polytope; margins may differ.
[[nodiscard]] inline bool same_core(const ConvexShape& x, const ConvexShape& y) {
  if (x.core().index() != y.core().index()) return false;
  if (x.polytope()) return x.polytope()->same_storage(*y.polytope());
  if (const auto* e = std::get_if<Ellipsoid>(&x.core())) return e->radii == std::get<Ellipsoid>(y.core()).radii;
  if (const auto* spheres = std::get_if<SphereHull>(&x.core())) return *spheres == std::get<SphereHull>(y.core());
  const auto same = [](const auto& p, const auto& q) {
    return p.radius == q.radius && p.half_height == q.half_height && p.axis == q.axis;
  };
  if (const auto* c = std::get_if<Cylinder>(&x.core())) return same(*c, std::get<Cylinder>(y.core()));
  return same(std::get<Cone>(x.core()), std::get<Cone>(y.core()));
}

}  // namespace pd::detail
