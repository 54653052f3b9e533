/// @file
/// The two faces of A and B whose difference is the face of P in a supporting plane, found from one known pair of
/// features by exact signs along edges.
#pragma once

#include <span>

#include "depth/certificate/facet_plane.hpp"
#include "depth/difference/exact_support.hpp"
#include "depth/distance/gjk_exact.hpp"

namespace pd::detail {

/// Every vertex of each body that lies exactly on its side's supporting plane, ascending. Grown on first use.
struct SupportFaces {
  SupportFace on_a;
  SupportFace on_b;
};

/// A facet of the body, not `skip`, that holds three of its vertices; -1 when there is none.
[[nodiscard]] int facet_holding(const ConvexPolytope& body, std::int32_t v0, std::int32_t v1, std::int32_t v2,
                                int skip = -1);

/// Collects the faces in the plane of `facet`, whose features must lie in it. `plane` serves as a filter.
/// Time of the order of the faces' vertices and their degrees; exact arithmetic only for ties within rounding.
/// @return whether the plane supports P exactly: by convexity no other edges need be asked than those that leave the
///         faces. The faces are complete only then.
[[nodiscard]] bool collect_faces(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane,
                                 SupportFaces& faces);

/// The exact sign of <edge, normal> for a normal that is not that of a facet.
class NormalSign {
 public:
  virtual ~NormalSign() = default;
  [[nodiscard]] virtual int along(const PairVector& edge) const = 0;
};
/// The same for the supporting plane through points that are known to lie in it.
/// @param plane   its unit normal serves as a filter.
/// @param sign    asked where the filter fails.
/// @param points  one to three vertices of P in the plane.
[[nodiscard]] bool collect_faces(const PosedPair& pair, const FacetPlane& plane, const NormalSign& sign,
                                 std::span<const VertexPair> points, SupportFaces& faces);

/// The features that an answer reports for the face of P with these faces (facet and lowest vertex, or two edges).
/// @param unit  outward normal of P there.
struct FacetFeatures {
  Feature on_a;
  Feature on_b;
};
[[nodiscard]] FacetFeatures features_of(const PosedPair& pair, const SupportFaces& faces, const Vec3& unit);

}  // namespace pd::detail
