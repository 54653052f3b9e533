#include "pd/compound/compound_difference.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "compound/part_pairs.hpp"
#include "compound/union_boundary.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd {

namespace {

bool before(const Vec3& x, const Vec3& y) {
  return std::lexicographical_compare(x.data(), x.data() + 3, y.data(), y.data() + 3);
}

Error too_many(std::int64_t max_facets) {
  return Error{ErrorCode::limit_exceeded,
               "the Minkowski difference has more than " + std::to_string(max_facets) +
                   " facets; depth queries answer without building it",
               "max_facets"};
}

Error too_much_work(std::int64_t max_work) {
  return Error{ErrorCode::limit_exceeded,
               "building the Minkowski difference takes more than " + std::to_string(max_work) +
                   " polygons and cuts: depth queries answer without building it, max_work allows more",
               "max_work"};
}

}  // namespace

Expected<UnionDifference> minkowski_difference(const PosedCompound& a, const PosedCompound& b, std::int64_t max_facets,
                                               std::int64_t max_work) {
  const detail::FloatingPointGuard guard;
  const Expected<detail::UnionPair> pair = detail::UnionPair::pose(a, b);
  if (!pair) return pair.error();
  if (!pair->polytopes) {
    return Error{ErrorCode::unsupported, "a Minkowski difference is built for polytopes without a margin", ""};
  }
  const int exponent = pair->scale_exponent();
  detail::PartDifferences differences =
      detail::PartDifferences::find(pair->a, pair->boxes_a, pair->b, pair->boxes_b, exponent, HUGE_VAL, max_facets);
  UnionDifference result;
  detail::UnionBoundary boundary(differences);
  std::vector<Vec3> corners;
  const auto add = [&](const detail::UnionBoundary::BoundaryPoint& where) {
    if (static_cast<std::int64_t>(result.facets.size()) == max_facets) return false;
    const detail::PartDifference& piece = differences.pieces()[where.piece];
    const detail::DifferenceFacet& facet = piece.facets[where.facet];
    std::int32_t part_a = piece.part_a, part_b = piece.part_b;
    pair->name_parts(part_a, part_b);
    result.facets.push_back({differences.planes().normal(where.polygon.plane).normalized(), part_a, part_b, facet.on_a,
                             facet.on_b, static_cast<std::int32_t>(corners.size()),
                             static_cast<std::int32_t>(where.polygon.corners.size())});
    for (const Vec3& x : where.polygon.corners) {
      Vec3 y;
      for (int i = 0; i < 3; ++i) y[i] = std::ldexp(x[i], exponent) + 0.0;
      corners.push_back(y);
    }
    return true;
  };
  const bool complete = boundary.visit_all(add, max_work);
  for (const detail::PartDifference& piece : differences.pieces()) {
    if (!piece.planes.empty()) ++result.work.pairs;
  }
  result.work.facets = differences.num_facets();
  result.work.polygons = boundary.counts().polygons;
  result.work.cuts = boundary.counts().cuts;
  if (boundary.counts().work() > max_work) return too_much_work(max_work);
  if (!complete) return too_many(max_facets);

  result.vertices = corners;
  std::sort(result.vertices.begin(), result.vertices.end(), before);
  result.vertices.erase(std::unique(result.vertices.begin(), result.vertices.end()), result.vertices.end());
  result.corners.reserve(corners.size());
  for (const Vec3& x : corners) {
    const auto found = std::lower_bound(result.vertices.begin(), result.vertices.end(), x, before);
    result.corners.push_back(static_cast<std::int32_t>(found - result.vertices.begin()));
  }
  return result;
}

}  // namespace pd
