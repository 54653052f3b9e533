/// @file
/// The demos' non-convex bodies as compounds.
#pragma once

#include <utility>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace pd {

inline Compound compound_of(const scenes::PartList& parts) {
  std::vector<Compound::Part> list;
  for (const scenes::PointPart& part : parts) list.push_back({*ConvexPolytope::from_points(part.points), part.pose});
  return *Compound::from_parts(std::move(list));
}

inline Compound compound_of(const scenes::Surface& surface) {
  return StarBody::from_faces(surface.vertices, surface.faces, surface.centre)->tetrahedra();
}

}  // namespace pd
