/// @file
/// The pieces of a non-convex Minkowski difference: with A the union of convex parts A_i and B that of B_j,
/// P = B + (-A) is the union of P_ij = B_j + (-A_i). Each P_ij that has an interior, as exact planes and polygons.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compound/plane_polygon.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/feature.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

struct DifferenceFacet {
  PlanePolygon polygon;
  Feature on_a;
  Feature on_b;
  std::vector<VertexPair> corners;  ///< of the loop, as the polygon's
};

/// One P_ij: the points inside every facet's plane.
struct PartDifference {
  std::int32_t part_a = 0;
  std::int32_t part_b = 0;
  std::vector<DifferenceFacet> facets;
  Vec3 low = Vec3::Zero();  ///< a box that holds it, rounded outwards
  Vec3 high = Vec3::Zero();
};

/// Axis-parallel, closed.
struct Box {
  Vec3 low;
  Vec3 high;
};

/// Parts of one union where they stand.
using PosedParts = std::span<const PosedShape>;

class PartDifferences {
 public:
  /// The P_ij whose boxes (from boxes of the parts) come within `reach` of the origin (inside lengths: *
  /// 2^-scale_exponent). Requires polytopes without margins.
  /// @return ErrorCode::limit_exceeded when they have more than `max_facets` facets.
  static Expected<PartDifferences> build(PosedParts a, std::span<const Box> boxes_a, PosedParts b,
                                         std::span<const Box> boxes_b, int scale_exponent, double reach,
                                         std::int64_t max_facets);

  [[nodiscard]] const PlaneSet& planes() const { return planes_; }
  [[nodiscard]] const std::vector<PartDifference>& pieces() const { return pieces_; }
  /// Largest |coordinate| of a corner.
  [[nodiscard]] double extent() const { return extent_; }

 private:
  explicit PartDifferences(int scale_exponent) : planes_(scale_exponent) {}

  PlaneSet planes_;
  std::vector<PartDifference> pieces_;
  double extent_ = 0;
};

}  // namespace pd::detail
