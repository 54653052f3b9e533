#include "compound/union_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pd::detail {

UnionBoundary::UnionBoundary(PartDifferences& differences) : differences_(differences), planes_(differences.planes()) {
  for (const PartDifference& piece : differences.pieces()) boxes_.push_back({piece.low, piece.high});
}

UnionBoundary::ClippedSet UnionBoundary::own(std::size_t piece) const {
  ClippedSet clipped((differences_.pieces().size() + 63) / 64, 0);
  mark(clipped, piece);
  return clipped;
}

bool UnionBoundary::subtract(const PlanePolygon& polygon, std::size_t own, std::size_t k, bool once) {
  const PartDifference& piece = differences_.exactly(k);
  if (piece.flat) return false;
  const std::vector<RoughPlane>& rough = piece.planes;
  const double rounding = 2 * polygon.error + 0x1p-48 * differences_.extent();
  rest_.clear();
  PlanePolygon left = polygon;
  for (std::size_t f = 0; f < rough.size(); ++f) {
    // Doubles tell of most planes on which side of them the polygon lies.
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Vec3& x : left.corners) {
      const double height = rough[f].normal.dot(x) - rough[f].offset;
      low = std::min(low, height);
      high = std::max(high, height);
    }
    const double slack = rough[f].slack + std::max(rounding, 2 * left.error);
    if (high < -slack) continue;
    Cut result = Cut::outside;
    PlanePolygon inner, outer;
    if (!(low > slack)) {
      const Side side = differences_.side(k, f);
      // A P_k on the same side of the plane covers nothing.
      if (!(side == polygon.plane && !(once && k < own))) result = cut(planes_, left, side, inner, &outer);
    }
    switch (result) {
      case Cut::outside:
        rest_.clear();
        return false;
      case Cut::inside:
        break;
      case Cut::split:
        rest_.push_back(std::move(outer));
        left = std::move(inner);
        break;
    }
  }
  ++counts_.cuts;
  return true;
}

std::ptrdiff_t UnionBoundary::covering(const Vec3& x, const ClippedSet& clipped, double tolerance,
                                       std::span<const std::int32_t> among) {
  const double rounding = 0x1p-48 * differences_.extent();
  std::ptrdiff_t best = -1;
  double least = HUGE_VAL;
  for (const std::int32_t which : among) {
    const auto k = static_cast<std::size_t>(which);
    if (has(clipped, k)) continue;
    const Box& box = boxes_[k];
    if (box.low.x() - x.x() > tolerance || x.x() - box.high.x() > tolerance || box.low.y() - x.y() > tolerance ||
        x.y() - box.high.y() > tolerance || box.low.z() - x.z() > tolerance || x.z() - box.high.z() > tolerance) {
      continue;
    }
    const PartDifference& piece = differences_.roughly(k);
    if (piece.flat) continue;
    double highest = -HUGE_VAL;
    for (const RoughPlane& plane : piece.planes) {
      const double height = plane.normal.dot(x) - plane.offset;
      highest = std::max(highest, height);
      if (highest > least || height - plane.slack - rounding > tolerance) {
        highest = HUGE_VAL;
        break;
      }
    }
    if (highest < least) {
      least = highest;
      best = static_cast<std::ptrdiff_t>(k);
    }
  }
  return best;
}

bool UnionBoundary::contained_in_recent(const PlanePolygon& polygon) {
  const double rounding = 2 * polygon.error + 0x1p-44 * differences_.extent();
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&](std::size_t k) { return surely_holds(k, polygon.corners, rounding); });
  if (found == recent_.end()) return false;
  std::rotate(recent_.begin(), found, found + 1);
  return true;
}

void UnionBoundary::rough_corners(std::size_t k, std::size_t f, std::vector<Vec3>& corners) const {
  const MinkowskiDifference& built = *differences_.pieces()[k].built;
  const MinkowskiDifference::Facet& facet = built.facets[f];
  const double scale = differences_.scale();
  corners.clear();
  for (std::int32_t i = facet.first; i < facet.first + facet.count; ++i) {
    const std::int32_t corner = built.corners[static_cast<std::size_t>(i)];
    corners.push_back(built.vertices[static_cast<std::size_t>(corner)].position * scale);
  }
}

bool UnionBoundary::surely_holds(std::size_t k, const std::vector<Vec3>& points, double rounding) {
  const PartDifference& piece = differences_.roughly(k);
  return !piece.flat && std::all_of(piece.planes.begin(), piece.planes.end(), [&](const RoughPlane& plane) {
    const double limit = plane.offset - plane.slack - rounding;
    return std::all_of(points.begin(), points.end(), [&](const Vec3& x) { return plane.normal.dot(x) < limit; });
  });
}

void UnionBoundary::mark_recent(std::size_t k) {
  if (std::find(recent_.begin(), recent_.end(), k) != recent_.end()) return;
  if (recent_.size() == kRecent) recent_.pop_back();
  recent_.insert(recent_.begin(), k);
}

std::optional<UnionBoundary::BoundaryPoint> UnionBoundary::at(const Vec3& x, bool& held) {
  const std::vector<PartDifference>& pieces = differences_.pieces();
  std::vector<std::size_t> holding;  // the closed P_k that hold x: all that matter near it
  const double rounding = 0x1p-48 * differences_.extent();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if ((boxes_[k].low - x).maxCoeff() > 0 || (x - boxes_[k].high).maxCoeff() > 0) continue;
    const auto& planes = differences_.roughly(k).planes;
    if (pieces[k].flat) continue;
    bool holds = std::none_of(planes.begin(), planes.end(),
                              [&](const RoughPlane& p) { return p.normal.dot(x) - p.offset > p.slack + rounding; });
    for (std::size_t f = 0; f < planes.size() && holds; ++f) {
      if (planes[f].normal.dot(x) - planes[f].offset < -planes[f].slack - rounding) continue;
      holds = planes_.sign_at_point(differences_.side(k, f), x) <= 0;
    }
    if (holds) holding.push_back(k);
  }
  held = !holding.empty();
  for (const std::size_t own : holding) {
    const auto& own_planes = pieces[own].planes;
    for (std::size_t f = 0; f < own_planes.size(); ++f) {
      // Most facets of a closed P_k that holds x do not.
      if (own_planes[f].normal.dot(x) - own_planes[f].offset < -own_planes[f].slack - rounding) continue;
      std::vector<PlanePolygon> polygons;
      if (contains_point(planes_, differences_.polygon(own, f), x)) polygons.push_back(differences_.polygon(own, f));
      for (const std::size_t k : holding) {
        if (k == own) continue;
        std::vector<PlanePolygon> next;
        for (PlanePolygon& polygon : polygons) {
          ++counts_.polygons;
          if (!subtract(polygon, own, k, false)) {
            next.push_back(std::move(polygon));
            continue;
          }
          for (PlanePolygon& part : rest_) {
            if (contains_point(planes_, part, x)) next.push_back(std::move(part));
          }
        }
        polygons = std::move(next);
      }
      if (!polygons.empty()) return BoundaryPoint{own, f, std::move(polygons.front()), x};
    }
  }
  return std::nullopt;
}

bool UnionBoundary::free_piece_near(const Vec3& low, const Vec3& high, const std::vector<std::size_t>& among) {
  const auto meets = [&](const PlanePolygon& polygon) {
    Vec3 least = polygon.corners[0], most = least;
    for (const Vec3& x : polygon.corners) {
      least = least.cwiseMin(x);
      most = most.cwiseMax(x);
    }
    return (least - high).maxCoeff() <= 2 * polygon.error && (low - most).maxCoeff() <= 2 * polygon.error;
  };
  const std::vector<PartDifference>& pieces = differences_.pieces();
  for (const std::size_t own : among) {
    for (const DifferenceFacet& f : pieces[own].facets) {
      if (!meets(f.polygon)) continue;
      std::vector<PlanePolygon> polygons{f.polygon};
      for (const std::size_t k : among) {
        if (k == own) continue;
        std::vector<PlanePolygon> next;
        for (PlanePolygon& polygon : polygons) {
          if (!subtract(polygon, own, k, false)) {
            next.push_back(std::move(polygon));
            continue;
          }
          for (PlanePolygon& part : rest_) {
            if (meets(part)) next.push_back(std::move(part));
          }
        }
        polygons = std::move(next);
      }
      if (!polygons.empty()) return true;
    }
  }
  return false;
}

bool UnionBoundary::outside_all(const Vec3& x) const {
  const double rounding = 0x1p-48 * differences_.extent();
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    if ((boxes_[k].low - x).maxCoeff() > 0 || (x - boxes_[k].high).maxCoeff() > 0) continue;
    const auto& planes = differences_.roughly(k).planes;
    if (std::any_of(planes.begin(), planes.end(),
                    [&](const RoughPlane& p) { return p.normal.dot(x) - p.offset > p.slack + rounding; })) {
      continue;
    }
    if (differences_.exactly(k).flat) continue;
    bool outside = false;
    for (std::size_t f = 0; f < planes.size() && !outside; ++f) {
      if (planes[f].normal.dot(x) - planes[f].offset < -planes[f].slack - rounding) continue;
      outside = planes_.sign_at_point(differences_.side(k, f), x) > 0;
    }
    if (!outside) return false;
  }
  return true;
}

Vec3 UnionBoundary::free_placement(const BoundaryPoint& where) const {
  const Vec3& x = where.x;
  // The polygon is uncovered about x, so that its points there are boundary points.
  if (contains_point(planes_, where.polygon, x) || outside_all(x)) return x;
  const Vec3 normal = planes_.normal(where.polygon.plane) * planes_.inverse_length(where.polygon.plane);
  Vec3 centre = Vec3::Zero();
  for (const Vec3& corner : where.polygon.corners) centre += corner;
  centre /= static_cast<double>(where.polygon.corners.size());
  const Vec3 inwards = centre - x;
  const double length = inwards.norm();
  const Vec3 along = length > 0 ? Vec3(inwards / length) : Vec3::Zero();
  // Outside the polygon there is free space: straight out of its plane, and near its rim also towards its middle. In a
  // gap as narrow as a blade that space is flat, so that a way towards the middle may rise by a small part of itself
  // only. Steps grow until they leave the bounded union at the latest.
  const double least = 0x1p-54 * std::max(x.cwiseAbs().maxCoeff(), 0x1p-900);
  for (double step = least;; step *= 2) {
    const Vec3 straight = x + step * normal;
    if (outside_all(straight)) return straight;
    const Vec3 slid = x + std::min(step, length) * along;
    for (double rise = step; rise >= std::max(least, 0x1p-40 * step); rise *= 0.125) {
      const Vec3 candidate = slid + rise * normal;
      if (outside_all(candidate)) return candidate;
    }
  }
}

}  // namespace pd::detail
