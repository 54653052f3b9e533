#include "compound/part_differences.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "pd/depth/minkowski_difference.hpp"
#include "shape/posed_pair.hpp"

namespace pd::detail {

namespace {

/// Fills the facets of one P_ij from the built convex difference.
PartDifference facets_of(const PosedShape& a, const PosedShape& b, const MinkowskiDifference& difference,
                         PlaneSet& planes) {
  const PosedPair pair(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose);
  PartDifference piece;
  // Edge from corner to corner -> the facet to its left.
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> left_of;
  std::vector<Side> sides;
  for (std::size_t f = 0; f < difference.facets.size(); ++f) {
    const MinkowskiDifference::Facet& facet = difference.facets[f];
    const auto corner = [&](std::int32_t k) {
      return difference.corners[static_cast<std::size_t>(facet.first + k % facet.count)];
    };
    const auto vertex = [&](std::int32_t k) { return difference.vertices[static_cast<std::size_t>(corner(k))]; };
    const auto v0 = vertex(0), v1 = vertex(facet.count / 3), v2 = vertex(2 * facet.count / 3);
    const Dyadic3 normal = cross(pair.exact(PairVector::difference(v0.a, v0.b, v1.a, v1.b)),
                                 pair.exact(PairVector::difference(v0.a, v0.b, v2.a, v2.b)));
    const Dyadic offset = dot(pair.exact(PairVector::point(v0.a, v0.b)), normal);
    sides.push_back(planes.add(normal * pair.homogeneous_factor(), offset));
    for (std::int32_t k = 0; k < facet.count; ++k) left_of[{corner(k), corner(k + 1)}] = f;
    DifferenceFacet entry;
    entry.on_a = facet.on_a;
    entry.on_b = facet.on_b;
    entry.polygon.plane = sides.back();
    piece.facets.push_back(std::move(entry));
  }
  for (std::size_t f = 0; f < difference.facets.size(); ++f) {
    const MinkowskiDifference::Facet& facet = difference.facets[f];
    DifferenceFacet& entry = piece.facets[f];
    // Corner k lies between edge k and edge k + 1.
    for (std::int32_t k = 0; k < facet.count; ++k) {
      const auto from = difference.corners[static_cast<std::size_t>(facet.first + k)];
      const auto to = difference.corners[static_cast<std::size_t>(facet.first + (k + 1) % facet.count)];
      entry.polygon.sides.push_back(sides[left_of.at({to, from})]);
      const MinkowskiDifference::Vertex& v = difference.vertices[static_cast<std::size_t>(to)];
      entry.corners.push_back({v.a, v.b});
    }
    entry.polygon.update(planes);
  }
  return piece;
}

}  // namespace

Expected<PartDifferences> PartDifferences::build(PosedParts a, std::span<const Box> boxes_a, PosedParts b,
                                                 std::span<const Box> boxes_b, int scale_exponent, double reach,
                                                 std::int64_t max_facets) {
  PartDifferences result(scale_exponent);
  const double scale = std::ldexp(1.0, -scale_exponent);
  std::int64_t facets = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Box& box_a = boxes_a[i];
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 low = (boxes_b[j].low - box_a.high) * scale, high = (boxes_b[j].high - box_a.low) * scale;
      const Vec3 nearest = low.cwiseMax(Vec3::Zero()) + high.cwiseMin(Vec3::Zero());
      if (nearest.norm() > reach * (1 + 0x1p-40)) continue;
      const auto difference = minkowski_difference(*a[i].shape->polytope(), a[i].pose, *b[j].shape->polytope(),
                                                   b[j].pose, max_facets - facets);
      if (!difference) return difference.error();
      if (difference->affine_dimension < 3) continue;
      facets += difference->num_facets();
      PartDifference piece = facets_of(a[i], b[j], *difference, result.planes_);
      piece.part_a = static_cast<std::int32_t>(i);
      piece.part_b = static_cast<std::int32_t>(j);
      piece.low = low;
      piece.high = high;
      for (const DifferenceFacet& facet : piece.facets) {
        for (const Vec3& x : facet.polygon.corners) {
          result.extent_ = std::max(result.extent_, x.cwiseAbs().maxCoeff());
        }
      }
      result.pieces_.push_back(std::move(piece));
    }
  }
  return result;
}

}  // namespace pd::detail
