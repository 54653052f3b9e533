/// @file
/// The pieces of a non-convex Minkowski difference: with A the union of convex parts A_i and B that of B_j,
/// P = B + (-A) is the union of P_ij = B_j + (-A_i). Each P_ij that has an interior, as planes in doubles with a bound
/// of their errors, or as exact planes and polygons: either is made when it is asked for. Exact planes cost ten times
/// what doubles do, and most P_ij of a deep overlap only cover others, which doubles tell.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compound/plane_polygon.hpp"
#include "pd/depth/minkowski_difference.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/feature.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

class PosedPair;

/// Its plane, and its polygon, are made when they are asked for: an exact plane costs a thousand times a rough one.
struct DifferenceFacet {
  PlanePolygon polygon;
  bool plane_known = false;
  Feature on_a;
  Feature on_b;
  std::vector<VertexPair> corners;   ///< of the loop, as the polygon's
  std::vector<std::int32_t> beyond;  ///< the facet on the other side of each edge
};

/// A facet's plane in doubles (inside lengths). Beyond the plane of the facet where <normal, x> > offset + slack,
/// inside it where <normal, x> < offset - slack, for every x no farther out than the extent of the differences.
struct RoughPlane {
  Vec3 normal;  ///< unit
  double offset = 0;
  double slack = 0;
};

/// One P_ij: the points inside every facet's plane.
struct PartDifference {
  enum class Made : std::uint8_t { nothing, roughly, exactly };
  std::int32_t part_a = 0;
  std::int32_t part_b = 0;
  Made made = Made::nothing;
  bool flat = false;                                 ///< it has no interior; known once it is made
  std::vector<RoughPlane> planes;                    ///< one a facet
  std::vector<DifferenceFacet> facets;               ///< exact
  std::shared_ptr<const MinkowskiDifference> built;  ///< once it is made
  std::shared_ptr<const PosedPair> pair;             ///< once facets are
  Vec3 low = Vec3::Zero();                           ///< a box that holds it, rounded outwards
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

  /// The same, none of them made yet. Refers to the parts.
  static PartDifferences find(PosedParts a, std::span<const Box> boxes_a, PosedParts b, std::span<const Box> boxes_b,
                              int scale_exponent, double reach, std::int64_t max_facets);
  /// P_k with its planes in doubles; with exact facets. Where it would take more than `max_facets` facets in all, it
  /// stays empty and `limit_exceeded` holds from then on.
  const PartDifference& roughly(std::size_t k);
  const PartDifference& exactly(std::size_t k);
  /// The plane of facet f of P_k, exactly; and its polygon, with corners in doubles.
  Side side(std::size_t k, std::size_t f);
  const PlanePolygon& polygon(std::size_t k, std::size_t f);
  [[nodiscard]] bool limit_exceeded() const { return limit_exceeded_; }
  /// Facets made so far, in doubles or exactly.
  [[nodiscard]] std::int64_t num_facets() const { return num_facets_; }
  /// The halfspace {x : orientation * x[axis] <= orientation * at} (inside lengths).
  Side across_axis(int axis, int orientation, double at);

  [[nodiscard]] PosedParts parts_a() const { return a_; }
  [[nodiscard]] PosedParts parts_b() const { return b_; }
  [[nodiscard]] const PlaneSet& planes() const { return planes_; }
  [[nodiscard]] const std::vector<PartDifference>& pieces() const { return pieces_; }
  /// At least |coordinate| of every point of theirs.
  [[nodiscard]] double extent() const { return extent_; }
  /// Inside lengths = lengths outside * scale.
  [[nodiscard]] double scale() const { return std::ldexp(1.0, -scale_exponent_); }

 private:
  PartDifferences(PosedParts a, PosedParts b, int scale_exponent, std::int64_t max_facets)
      : a_(a), b_(b), scale_exponent_(scale_exponent), max_facets_(max_facets), planes_(scale_exponent) {}

  PosedParts a_;
  PosedParts b_;
  int scale_exponent_;
  std::int64_t max_facets_;
  std::int64_t num_facets_ = 0;
  bool limit_exceeded_ = false;
  PlaneSet planes_;
  std::vector<PartDifference> pieces_;
  double extent_ = 0;
};

}  // namespace pd::detail
