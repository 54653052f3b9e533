#include "compound/part_differences.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "shape/posed_pair.hpp"

namespace pd::detail {

namespace {

/// The plane of a facet in doubles. The normal is off by at most (how far corners lie from the plane) / (the least
/// height of the triangle of three of them); that angle times the size of the differences bounds what is wrong
/// anywhere.
RoughPlane rough_plane(const MinkowskiDifference& difference, const MinkowskiDifference::Facet& facet, double scale,
                       double extent) {
  const auto position = [&](std::int32_t k) -> Vec3 {
    const std::int32_t corner = difference.corners[static_cast<std::size_t>(facet.first + k % facet.count)];
    return difference.vertices[static_cast<std::size_t>(corner)].position * scale;
  };
  RoughPlane plane{facet.normal, -HUGE_VAL, 0};
  double lowest = HUGE_VAL;
  for (std::int32_t k = 0; k < facet.count; ++k) {
    const double height = plane.normal.dot(position(k));
    plane.offset = std::max(plane.offset, height);
    lowest = std::min(lowest, height);
  }
  const Vec3 v0 = position(0), u = position(facet.count / 3) - v0, v = position(2 * facet.count / 3) - v0;
  const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
  const double least_height = u.cross(v).norm() / longest - 0x1p-46 * extent;
  const double off = plane.offset - lowest + 0x1p-48 * extent;
  plane.slack = least_height > 0 ? 8 * off * (1 + extent / least_height) : HUGE_VAL;
  return plane;
}

/// The facets of one P_ij and how they hang together, from the built convex difference.
std::vector<DifferenceFacet> facets_of(const MinkowskiDifference& difference) {
  // Every edge, from corner to corner, and the facet to its left.
  struct Edge {
    std::int32_t from, to, left;
    bool operator<(const Edge& other) const { return from != other.from ? from < other.from : to < other.to; }
  };
  std::vector<Edge> edges;
  for (std::size_t f = 0; f < difference.facets.size(); ++f) {
    const MinkowskiDifference::Facet& facet = difference.facets[f];
    for (std::int32_t k = 0; k < facet.count; ++k) {
      edges.push_back({difference.corners[static_cast<std::size_t>(facet.first + k)],
                       difference.corners[static_cast<std::size_t>(facet.first + (k + 1) % facet.count)],
                       static_cast<std::int32_t>(f)});
    }
  }
  // In the order of facets, and sorted.
  std::vector<Edge> sorted = edges;
  std::sort(sorted.begin(), sorted.end());
  std::vector<DifferenceFacet> facets(difference.facets.size());
  for (const Edge& edge : edges) {
    DifferenceFacet& entry = facets[static_cast<std::size_t>(edge.left)];
    entry.beyond.push_back(std::lower_bound(sorted.begin(), sorted.end(), Edge{edge.to, edge.from, 0})->left);
    // Corner k lies between edge k and edge k + 1.
    const MinkowskiDifference::Vertex& v = difference.vertices[static_cast<std::size_t>(edge.to)];
    entry.corners.push_back({v.a, v.b});
  }
  for (std::size_t f = 0; f < facets.size(); ++f) {
    facets[f].on_a = difference.facets[f].on_a;
    facets[f].on_b = difference.facets[f].on_b;
  }
  return facets;
}

/// The plane of one of them.
Side exact_plane(const PosedPair& pair, const MinkowskiDifference& difference, const MinkowskiDifference::Facet& facet,
                 PlaneSet& planes) {
  const auto vertex = [&](std::int32_t k) {
    const std::int32_t corner = difference.corners[static_cast<std::size_t>(facet.first + k % facet.count)];
    return difference.vertices[static_cast<std::size_t>(corner)];
  };
  const auto v0 = vertex(0), v1 = vertex(facet.count / 3), v2 = vertex(2 * facet.count / 3);
  const Dyadic3 normal = cross(pair.exact(PairVector::difference(v0.a, v0.b, v1.a, v1.b)),
                               pair.exact(PairVector::difference(v0.a, v0.b, v2.a, v2.b)));
  const Dyadic offset = dot(pair.exact(PairVector::point(v0.a, v0.b)), normal);
  return planes.add(normal * pair.homogeneous_factor(), offset);
}

}  // namespace

PartDifferences PartDifferences::find(PosedParts a, std::span<const Box> boxes_a, PosedParts b,
                                      std::span<const Box> boxes_b, int scale_exponent, double reach,
                                      std::int64_t max_facets) {
  PartDifferences result(a, b, scale_exponent, max_facets);
  const double scale = std::ldexp(1.0, -scale_exponent);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Box& box_a = boxes_a[i];
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 low = (boxes_b[j].low - box_a.high) * scale, high = (boxes_b[j].high - box_a.low) * scale;
      const Vec3 nearest = low.cwiseMax(Vec3::Zero()) + high.cwiseMin(Vec3::Zero());
      if (nearest.norm() > reach * (1 + 0x1p-40)) continue;
      PartDifference piece;
      piece.part_a = static_cast<std::int32_t>(i);
      piece.part_b = static_cast<std::int32_t>(j);
      piece.low = low;
      piece.high = high;
      result.extent_ = std::max({result.extent_, low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()});
      result.pieces_.push_back(std::move(piece));
    }
  }
  return result;
}

const PartDifference& PartDifferences::roughly(std::size_t k) {
  PartDifference& piece = pieces_[k];
  if (piece.made != PartDifference::Made::nothing) return piece;
  piece.made = PartDifference::Made::roughly;
  const PosedShape &a = a_[static_cast<std::size_t>(piece.part_a)], &b = b_[static_cast<std::size_t>(piece.part_b)];
  auto difference = minkowski_difference(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose,
                                         std::max<std::int64_t>(max_facets_ - num_facets_, 0));
  limit_exceeded_ = limit_exceeded_ || !difference;
  piece.flat = !difference || difference->affine_dimension < 3;
  if (piece.flat) return piece;
  num_facets_ += difference->num_facets();
  const double scale = std::ldexp(1.0, -scale_exponent_);
  piece.planes.reserve(difference->facets.size());
  for (const MinkowskiDifference::Facet& facet : difference->facets) {
    piece.planes.push_back(rough_plane(*difference, facet, scale, extent_));
  }
  piece.built = std::make_shared<const MinkowskiDifference>(*std::move(difference));
  return piece;
}

const PartDifference& PartDifferences::exactly(std::size_t k) {
  roughly(k);
  PartDifference& piece = pieces_[k];
  if (piece.made == PartDifference::Made::exactly) return piece;
  piece.made = PartDifference::Made::exactly;
  if (piece.flat) return piece;
  piece.facets = facets_of(*piece.built);
  const PosedShape &a = a_[static_cast<std::size_t>(piece.part_a)], &b = b_[static_cast<std::size_t>(piece.part_b)];
  piece.pair = std::make_shared<const PosedPair>(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose);
  return piece;
}

Side PartDifferences::side(std::size_t k, std::size_t f) {
  exactly(k);
  PartDifference& piece = pieces_[k];
  DifferenceFacet& facet = piece.facets[f];
  if (!facet.plane_known) {
    facet.polygon.plane = exact_plane(*piece.pair, *piece.built, piece.built->facets[f], planes_);
    facet.plane_known = true;
  }
  return facet.polygon.plane;
}

const PlanePolygon& PartDifferences::polygon(std::size_t k, std::size_t f) {
  side(k, f);
  DifferenceFacet& facet = pieces_[k].facets[f];
  if (!facet.polygon.corners.empty()) return facet.polygon;
  for (const std::int32_t g : facet.beyond) facet.polygon.sides.push_back(side(k, static_cast<std::size_t>(g)));
  facet.polygon.update(planes_);
  return facet.polygon;
}

Side PartDifferences::across_axis(int axis, int orientation, double at) {
  const Dyadic sign(static_cast<double>(orientation)), zero(0.0);
  const Dyadic3 normal{axis == 0 ? sign : zero, axis == 1 ? sign : zero, axis == 2 ? sign : zero};
  return planes_.add(normal, (Dyadic(at) * sign).scaled(scale_exponent_));
}

Expected<PartDifferences> PartDifferences::build(PosedParts a, std::span<const Box> boxes_a, PosedParts b,
                                                 std::span<const Box> boxes_b, int scale_exponent, double reach,
                                                 std::int64_t max_facets) {
  PartDifferences result = find(a, boxes_a, b, boxes_b, scale_exponent, reach, max_facets);
  for (std::size_t k = 0; k < result.pieces_.size(); ++k) {
    for (std::size_t f = 0; f < result.exactly(k).facets.size(); ++f) result.polygon(k, f);
    if (result.limit_exceeded_) return Error{ErrorCode::limit_exceeded, "more facets than max_facets", "max_facets"};
  }
  std::erase_if(result.pieces_, [](const PartDifference& piece) { return piece.flat; });
  return result;
}

}  // namespace pd::detail
