/// @file
/// The part of a posed body's core that faces a direction: a point, a segment or a convex polygon.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/depth/penetration_depth.hpp"

namespace pd::detail {

/// Points of a rim: enough that the four kept of them span 0.9 of the disc's area or more.
inline constexpr int kRimPoints = 16;

struct FaceVertex {
  Vec3 point;       ///< common frame
  std::int32_t id;  ///< vertex of the polytope, or the number of the rim point or sphere
};

/// One vertex, two, or a convex loop of three and more in one plane.
struct SupportingFace {
  std::vector<FaceVertex> vertices;
  Vec3 plane_normal = Vec3::UnitZ();  ///< of a polygon: unit, outward; otherwise without meaning
  bool rim = false;                   ///< kRimPoints of a disc, one after the other
};

/// The face of the core of `shape` to which `direction` (unit, common frame) is most nearly normal, among those at the
/// answer's feature. If `feature` is none, or no feature of this body, among those at the support point.
/// A face more than 60 degrees off is no contact face: then the feature's edge, an edge at most 17 degrees off the
/// plane across the direction, or the vertex alone.
void supporting_face(const PosedShape& shape, const Vec3& direction, const Feature& feature, SupportingFace& face);

}  // namespace pd::detail
