/// @file
/// The two faces of A and B whose difference is the face of P in a supporting plane, found from one known pair of
/// features by exact signs along edges.
#pragma once

#include "depth/exact_support.hpp"
#include "depth/facet_plane.hpp"

namespace pd::detail {

/// Every vertex of each body that lies exactly on its side's supporting plane, ascending. Grown on first use.
struct PlaneFaces {
  SupportFace on_a;
  SupportFace on_b;
};

/// Collects the faces in the plane of `facet`, whose features must lie in it. `plane` serves as a filter.
/// Time of the order of the faces' vertices and their degrees; exact arithmetic only for ties within rounding.
/// @return whether the plane supports P exactly: by convexity no other edges need be asked than those that leave the
///         faces. The faces are complete only then.
[[nodiscard]] bool collect_faces(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane,
                                 PlaneFaces& faces);

/// The features that an answer reports for the face of P with these faces (facet and lowest vertex, or two edges).
/// @param unit  outward normal of P there.
struct FacetFeatures {
  Feature on_a;
  Feature on_b;
};
[[nodiscard]] FacetFeatures features_of(const PosedPair& pair, const PlaneFaces& faces, const Vec3& unit);

}  // namespace pd::detail
