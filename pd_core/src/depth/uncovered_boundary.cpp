#include "depth/uncovered_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "numeric/root_sum.hpp"

namespace pd::detail {

namespace {

/// Squared distance of a plane from the origin as a rational.
struct Squared {
  Dyadic numerator;
  Dyadic denominator;
};
Squared squared_distance(const PlaneSet::ExactPoint& point) {
  return {dot(point.numerator, point.numerator), point.denominator * point.denominator};
}
Vec3 rounded(const PlaneSet::ExactPoint& point) {
  const auto coordinate = [&](const Dyadic& x) { return quotient(x, point.denominator); };
  return {coordinate(point.numerator.x), coordinate(point.numerator.y), coordinate(point.numerator.z)};
}
int compare(const Squared& x, const Squared& y) {
  return (x.numerator * y.denominator - y.numerator * x.denominator).sign();
}

/// Where a polygon meets the ray t d, t >= 0: the least t.
class RayMeeting {
 public:
  /// @param exact, unit  one direction.
  RayMeeting(const PlaneSet& planes, const Dyadic3& exact, const Vec3& unit)
      : planes_(planes), exact_(exact), unit_(unit) {}

  [[nodiscard]] const Dyadic3& exact() const { return exact_; }

  [[nodiscard]] std::optional<RayParameter> least(const PlanePolygon& polygon) const {
    if (!near(polygon)) return std::nullopt;
    const Dyadic slope = dot(planes_.exact_normal(polygon.plane), exact_);
    const Dyadic offset = planes_.exact_offset(polygon.plane);
    if (slope.sign() != 0) {
      const RayParameter t = slope.sign() > 0 ? RayParameter{offset, slope} : RayParameter{-offset, -slope};
      if (t.numerator.sign() < 0) return std::nullopt;
      for (const Side s : polygon.sides) {
        if (planes_.sign_on_ray(s, exact_, t) > 0) return std::nullopt;
      }
      return t;
    }
    if (offset.sign() != 0) return std::nullopt;
    // The ray runs in the plane: clipped by the sides.
    RayParameter from{Dyadic(0.0), Dyadic(1.0)};
    std::optional<RayParameter> to;
    for (const Side s : polygon.sides) {
      const Dyadic rise = dot(planes_.exact_normal(s), exact_);
      const Dyadic level = planes_.exact_offset(s);
      if (rise.sign() == 0) {
        if (level.sign() < 0) return std::nullopt;
      } else if (rise.sign() > 0) {
        const RayParameter t{level, rise};
        if (!to || t.compare(*to) < 0) to = t;
      } else {
        const RayParameter t{-level, -rise};
        if (t.compare(from) > 0) from = t;
      }
    }
    if (to && to->compare(from) < 0) return std::nullopt;
    return from;
  }

 private:
  /// False only when the ray misses the polygon for certain.
  [[nodiscard]] bool near(const PlanePolygon& polygon) const {
    Vec3 low = polygon.corners[0], high = low;
    for (const Vec3& x : polygon.corners) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const double slack = 4 * polygon.error + 0x1p-44 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    double from = 0, to = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      const double a = low[i] - slack, b = high[i] + slack;
      if (std::abs(unit_[i]) < 0x1p-40) {
        const double drift = to < HUGE_VAL ? 0x1p-40 * to : HUGE_VAL;
        if (drift < HUGE_VAL && (a > drift || b < -drift)) return false;
        continue;
      }
      double enter = a / unit_[i], leave = b / unit_[i];
      if (enter > leave) std::swap(enter, leave);
      from = std::max(from, enter - 0x1p-44 * std::abs(enter));
      to = std::min(to, leave + 0x1p-44 * std::abs(leave));
    }
    return from <= to;
  }

  const PlaneSet& planes_;
  Dyadic3 exact_;
  Vec3 unit_;
};

}  // namespace

UncoveredBoundary::UncoveredBoundary(const PartDifferences& differences)
    : differences_(differences), planes_(differences.planes()) {}

const DifferenceFacet& UncoveredBoundary::facet(const Spot& spot) const {
  return differences_.pieces()[spot.piece].facets[spot.facet];
}

UncoveredBoundary::Taken UncoveredBoundary::own(std::size_t piece) const {
  Taken taken((differences_.pieces().size() + 63) / 64, 0);
  taken[piece / 64] |= std::uint64_t{1} << (piece % 64);
  return taken;
}

bool UncoveredBoundary::cut_away(const PlanePolygon& polygon, std::size_t own, std::size_t k, bool once) {
  const PartDifference& piece = differences_.pieces()[k];
  rest_.clear();
  for (const DifferenceFacet& f : piece.facets) {
    const Side side = f.polygon.plane;
    // A P_k on the same side of the plane covers nothing.
    if (side == polygon.plane && !(once && k < own)) return false;
  }
  PlanePolygon left = polygon;
  for (const DifferenceFacet& f : piece.facets) {
    PlanePolygon inner, outer;
    switch (cut(planes_, left, f.polygon.plane, inner, outer)) {
      case Cut::outside:
        rest_.clear();
        return false;
      case Cut::inside:
        break;
      case Cut::parted:
        rest_.push_back(std::move(outer));
        left = std::move(inner);
        break;
    }
  }
  ++counts_.cuts;
  return true;
}

std::ptrdiff_t UncoveredBoundary::covering(const Vec3& x, const Taken& taken, double tolerance) const {
  const std::vector<PartDifference>& pieces = differences_.pieces();
  std::ptrdiff_t best = -1;
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (has(taken, k)) continue;
    const PartDifference& piece = pieces[k];
    if ((piece.low - x).maxCoeff() > tolerance || (x - piece.high).maxCoeff() > tolerance) continue;
    double highest = -HUGE_VAL;
    const double limit = std::min(tolerance, least);
    for (const DifferenceFacet& f : piece.facets) {
      highest = std::max(highest, planes_.height(f.polygon.plane, x));
      if (highest > limit) break;
    }
    if (highest <= tolerance && highest < least) {
      least = highest;
      best = static_cast<std::ptrdiff_t>(k);
    }
  }
  return best;
}

UncoveredBoundary::Nearest UncoveredBoundary::nearest(double known_lower) {
  struct Waiting {
    double key;  ///< no point of the polygon is nearer
    std::int64_t order;
    Cell cell;
  };
  const auto later = [](const Waiting& x, const Waiting& y) {
    return x.key != y.key ? x.key > y.key : x.order > y.order;
  };
  std::priority_queue<Waiting, std::vector<Waiting>, decltype(later)> queue(later);
  const double scale = differences_.extent();
  std::int64_t order = 0;

  std::optional<Nearest> best;
  Squared best_squared;
  double best_key = HUGE_VAL;  // distance of the best spot, at most this

  const auto wait = [&](Cell cell) {
    PlanePolygon& polygon = cell.spot.polygon;
    double farthest = 0;
    for (const Vec3& x : polygon.corners) farthest = std::max(farthest, x.squaredNorm());
    if (std::sqrt(farthest) < known_lower - 4 * polygon.error - 0x1p-48 * scale) return;
    cell.spot.x = nearest_point(planes_, polygon);
    const double distance = cell.spot.x.norm();
    const double key = std::max(known_lower, distance - 4 * polygon.error - 0x1p-50 * scale);
    if (key >= best_key) return;
    queue.push({key, order++, std::move(cell)});
  };
  const std::vector<PartDifference>& pieces = differences_.pieces();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (std::size_t f = 0; f < pieces[k].facets.size(); ++f) wait({{k, f, pieces[k].facets[f].polygon, {}}, own(k)});
  }

  while (!queue.empty()) {
    Waiting top = queue.top();
    queue.pop();
    if (best && top.key >= best_key) break;
    ++counts_.polygons;
    Cell& cell = top.cell;
    const double distance = cell.spot.x.norm();
    // Ties are told apart exactly, so that the lower bound is the depth itself.
    std::optional<ExactNearestPoint> exact;
    if (best && best->exact) {
      exact = exact_nearest_point(planes_, cell.spot.polygon);
      if (exact && compare(squared_distance(exact->point), best_squared) >= 0) continue;
    }
    const double tolerance = 8 * cell.spot.polygon.error + 0x1p-44 * scale;
    const std::ptrdiff_t k = covering(cell.spot.x, cell.taken, tolerance);
    if (k >= 0) {
      const auto index = static_cast<std::size_t>(k);
      cell.taken[index / 64] |= std::uint64_t{1} << (index % 64);
      if (!cut_away(cell.spot.polygon, cell.spot.piece, index, false)) {
        queue.push(std::move(top));
        continue;
      }
      std::vector<PlanePolygon> rest = std::move(rest_);
      for (PlanePolygon& part : rest) wait({{cell.spot.piece, cell.spot.facet, std::move(part), {}}, cell.taken});
      continue;
    }
    if (!exact) exact = exact_nearest_point(planes_, cell.spot.polygon);
    Nearest found;
    found.spot = std::move(cell.spot);
    found.exact = exact.has_value();
    if (!exact) {
      // Every key to come is at least this one.
      found.lower = best ? std::min(top.key, best->lower) : top.key;
      if (!best || distance < best_key) {
        best = std::move(found);
      } else {
        best->lower = found.lower;
      }
      break;
    }
    Squared squared = squared_distance(exact->point);
    if (best && compare(squared, best_squared) >= 0) continue;
    found.foot = exact->foot;
    found.spot.x = rounded(exact->point);
    found.lower = RootSum(Dyadic(0.0), 1, squared.numerator, squared.denominator).round_down();
    best_key = found.lower;
    best_squared = std::move(squared);
    best = std::move(found);
  }
  best->lower = std::max(known_lower, best->lower);
  return *std::move(best);
}

std::optional<UncoveredBoundary::Spot> UncoveredBoundary::at(const Vec3& x, bool& held) {
  const std::vector<PartDifference>& pieces = differences_.pieces();
  std::vector<std::size_t> holding;  // the closed P_k that hold x: all that matter near it
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& facets = pieces[k].facets;
    if (std::all_of(facets.begin(), facets.end(),
                    [&](const DifferenceFacet& f) { return planes_.sign_at_point(f.polygon.plane, x) <= 0; })) {
      holding.push_back(k);
    }
  }
  held = !holding.empty();
  for (const std::size_t own : holding) {
    for (std::size_t f = 0; f < pieces[own].facets.size(); ++f) {
      std::vector<PlanePolygon> polygons;
      if (contains_point(planes_, pieces[own].facets[f].polygon, x)) polygons.push_back(pieces[own].facets[f].polygon);
      for (const std::size_t k : holding) {
        if (k == own) continue;
        std::vector<PlanePolygon> next;
        for (PlanePolygon& polygon : polygons) {
          ++counts_.polygons;
          if (!cut_away(polygon, own, k, false)) {
            next.push_back(std::move(polygon));
            continue;
          }
          for (PlanePolygon& part : rest_) {
            if (contains_point(planes_, part, x)) next.push_back(std::move(part));
          }
        }
        polygons = std::move(next);
      }
      if (!polygons.empty()) return Spot{own, f, std::move(polygons.front()), x};
    }
  }
  return std::nullopt;
}

std::optional<UncoveredBoundary::Hit> UncoveredBoundary::along(const Vec3& direction, const Dyadic3& exact) {
  struct Waiting {
    RayParameter t;
    std::int64_t order;
    Cell cell;
  };
  const auto later = [](const Waiting& x, const Waiting& y) {
    const int sign = x.t.compare(y.t);
    return sign != 0 ? sign > 0 : x.order > y.order;
  };
  std::priority_queue<Waiting, std::vector<Waiting>, decltype(later)> queue(later);
  const RayMeeting ray(planes_, exact, direction.normalized());
  std::int64_t order = 0;
  const auto wait = [&](Cell cell) {
    if (auto t = ray.least(cell.spot.polygon)) queue.push({*std::move(t), order++, std::move(cell)});
  };
  const std::vector<PartDifference>& pieces = differences_.pieces();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (std::size_t f = 0; f < pieces[k].facets.size(); ++f) wait({{k, f, pieces[k].facets[f].polygon, {}}, own(k)});
  }
  const auto holds = [&](const PartDifference& piece, const RayParameter& t, const Vec3& x) {
    const double slack = 0x1p-40 * (differences_.extent() + x.cwiseAbs().maxCoeff());
    for (const DifferenceFacet& f : piece.facets) {
      const double height = planes_.height(f.polygon.plane, x);
      if (height > slack) return false;
      if (height > -slack && planes_.sign_on_ray(f.polygon.plane, ray.exact(), t) > 0) return false;
    }
    return true;
  };
  while (!queue.empty()) {
    Waiting top = queue.top();
    queue.pop();
    ++counts_.polygons;
    const double t = quotient(top.t.numerator, top.t.denominator);
    const Vec3 x = t * direction;
    bool again = false;
    for (std::size_t k = 0; k < pieces.size() && !again; ++k) {
      if (has(top.cell.taken, k) || !holds(pieces[k], top.t, x)) continue;
      top.cell.taken[k / 64] |= std::uint64_t{1} << (k % 64);
      if (!cut_away(top.cell.spot.polygon, top.cell.spot.piece, k, false)) continue;
      again = true;
      std::vector<PlanePolygon> rest = std::move(rest_);
      for (PlanePolygon& part : rest) {
        wait({{top.cell.spot.piece, top.cell.spot.facet, std::move(part), {}}, top.cell.taken});
      }
    }
    if (again) continue;
    top.cell.spot.x = x;
    return Hit{std::move(top.cell.spot), std::move(top.t)};
  }
  return std::nullopt;
}

bool UncoveredBoundary::visit_all(const Visitor& visitor) {
  const std::vector<PartDifference>& pieces = differences_.pieces();
  for (std::size_t own = 0; own < pieces.size(); ++own) {
    for (std::size_t f = 0; f < pieces[own].facets.size(); ++f) {
      std::vector<PlanePolygon> polygons{pieces[own].facets[f].polygon};
      for (std::size_t k = 0; k < pieces.size() && !polygons.empty(); ++k) {
        if (k == own) continue;
        if ((pieces[k].low - pieces[own].high).maxCoeff() > 0 || (pieces[own].low - pieces[k].high).maxCoeff() > 0) {
          continue;
        }
        std::vector<PlanePolygon> next;
        for (PlanePolygon& polygon : polygons) {
          if (!cut_away(polygon, own, k, true)) {
            next.push_back(std::move(polygon));
          } else {
            for (PlanePolygon& part : rest_) next.push_back(std::move(part));
          }
        }
        polygons = std::move(next);
      }
      for (PlanePolygon& polygon : polygons) {
        ++counts_.polygons;
        if (!visitor(Spot{own, f, std::move(polygon), Vec3::Zero()})) return false;
      }
    }
  }
  return true;
}

bool UncoveredBoundary::free_piece_near(const Vec3& low, const Vec3& high, const std::vector<std::size_t>& among) {
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
          if (!cut_away(polygon, own, k, false)) {
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

bool UncoveredBoundary::outside_all(const Vec3& x) const {
  for (const PartDifference& piece : differences_.pieces()) {
    if ((piece.low - x).maxCoeff() > 0 || (x - piece.high).maxCoeff() > 0) continue;
    if (std::all_of(piece.facets.begin(), piece.facets.end(),
                    [&](const DifferenceFacet& f) { return planes_.sign_at_point(f.polygon.plane, x) <= 0; })) {
      return false;
    }
  }
  return true;
}

Vec3 UncoveredBoundary::free_placement(const Spot& spot) const {
  const Vec3& x = spot.x;
  // The polygon is uncovered about x, so that its points there are boundary points.
  if (contains_point(planes_, spot.polygon, x) || outside_all(x)) return x;
  const Vec3 normal = planes_.normal(spot.polygon.plane) * planes_.inverse_length(spot.polygon.plane);
  Vec3 centre = Vec3::Zero();
  for (const Vec3& corner : spot.polygon.corners) centre += corner;
  centre /= static_cast<double>(spot.polygon.corners.size());
  const Vec3 inwards = centre - x;
  const double length = inwards.norm();
  const Vec3 along = length > 0 ? Vec3(inwards / length) : Vec3::Zero();
  // Outside the polygon there is free space: straight out of its plane, and near its rim also towards its middle. Steps
  // grow until they leave the bounded union at the latest.
  for (double step = 0x1p-54 * std::max(x.cwiseAbs().maxCoeff(), 0x1p-900);; step *= 2) {
    for (const double slide : {0.0, 1.0, 8.0}) {
      const Vec3 candidate = x + step * normal + std::min(slide * step, length) * along;
      if (outside_all(candidate)) return candidate;
    }
  }
}

}  // namespace pd::detail
