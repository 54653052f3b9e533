// Stretches into closed curves: the end of each is the start of another, and equality of such points is decided
// exactly.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "numeric/at.hpp"
#include "numeric/quotient.hpp"
#include "planar/boundary/boundary_builder.hpp"

namespace pd::detail {

namespace {

struct Junction {
  Span span;
  Place place;
  Point2 rounded;
};

Junction junction(const SumBoundary& boundary, const Stretch& s, bool end) {
  const Candidate& c = boundary.candidate(s);
  const Position& position = end ? s.to : s.from;
  if (end && position.at.kind == Place::Kind::start) {
    return {boundary.edge(c, position.edge - 1), {Place::Kind::end, {}, {}}, {}};
  }
  return {boundary.edge(c, position.edge), position.at, {}};
}

/// Rounds the point to doubles. Where doubles lose it (nearly parallel lines) it is computed exactly first.
/// @return a bound on the error.
double round_point(Junction& j, double scale) {
  const auto e = point_at<Estimate>(j.span, j.place);
  const double w = std::abs(e.w.value) - e.w.error;
  if (w > 0) {
    j.rounded = {e.x.value / e.w.value, e.y.value / e.w.value};
    double error = 0;
    bool good = true;  // false where something overflowed to NaN, which no maximum would keep
    for (const auto& [c, value] : {std::pair{e.x, j.rounded[0]}, std::pair{e.y, j.rounded[1]}}) {
      const double bound = (c.error + std::abs(value) * e.w.error) / w + 0x1p-51 * std::abs(value);
      good = good && bound <= 0x1p-40 * scale;
      error = std::max(error, bound);
    }
    if (good) return error;
  }
  const auto x = point_at<Dyadic>(j.span, j.place);
  j.rounded = {quotient(x.x, x.w), quotient(x.y, x.w)};
  return 0x1p-50 * scale;
}

bool same_point(const Junction& a, const Junction& b) {
  if (a.place.kind != Place::Kind::line && b.place.kind != Place::Kind::line && a.place.kind != Place::Kind::point &&
      b.place.kind != Place::Kind::point) {
    return same(a.place.kind == Place::Kind::start ? a.span.s : a.span.z,
                b.place.kind == Place::Kind::start ? b.span.s : b.span.z);
  }
  const auto x = point_at<Dyadic>(a.span, a.place), y = point_at<Dyadic>(b.span, b.place);
  return x.x * y.w == y.x * x.w && x.y * y.w == y.y * x.w;
}

/// Is direction a met before b when turning counter-clockwise from `base`?
bool turns_before(const PlaneDirection& base, const PlaneDirection& a, const PlaneDirection& b) {
  const auto sector = [&](const PlaneDirection& d) {
    const int side = cross_sign(base, d);
    return side > 0 ? 0 : (side == 0 ? 1 : 2);
  };
  const int sa = sector(a), sb = sector(b);
  return sa != sb ? sa < sb : cross_sign(a, b) > 0;
}

class Linker {
 public:
  Linker(const SumBoundary& boundary, std::vector<Stretch>& stretches) : boundary_(boundary), stretches_(stretches) {}

  void run(std::int64_t& reflex_points) {
    const std::size_t n = stretches_.size();
    double scale = 0;
    for (const Stretch& s : stretches_) {
      const Box2 box = boundary_.box(s);
      for (std::size_t k = 0; k < 2; ++k) scale = std::max({scale, std::abs(box.low[k]), std::abs(box.high[k])});
    }
    double error = 0x1p-50 * scale;
    for (const Stretch& s : stretches_) {
      start_.push_back(junction(boundary_, s, false));
      end_.push_back(junction(boundary_, s, true));
      error = std::max({error, round_point(start_.back(), scale), round_point(end_.back(), scale)});
    }
    cell_ = 8 * error;
    for (std::size_t i = 0; i < n; ++i) grid_[cell_of(start_[i].rounded, 0, 0)].push_back(static_cast<std::int32_t>(i));
    next_.assign(n, -1);
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = follower(i);
      const PlaneDirection in = direction(i, true), out = direction(at(next_[i]), false);
      if (cross_sign(in, out) < 0) ++reflex_points;
    }
  }

  /// Numbers the loops, and puts the stretches in the order in which they follow each other along them.
  int number_loops(int outer) {
    int loops = 0;
    std::vector<Stretch> ordered;
    ordered.reserve(stretches_.size());
    const auto walk = [&](int first) {
      for (int s = first; stretches_[at(s)].loop < 0; s = next_[at(s)]) {
        stretches_[at(s)].loop = loops;
        ordered.push_back(stretches_[at(s)]);
      }
      ++loops;
    };
    walk(outer);
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s) {
      if (stretches_[at(s)].loop < 0) walk(s);
    }
    stretches_ = std::move(ordered);
    return loops;
  }

 private:
  using Cell = std::uint64_t;
  [[nodiscard]] Cell cell_of(const Point2& p, int dx, int dy) const {
    // Shifted by half a cell each way: two points within the error share one of the four cells tried.
    const auto x = static_cast<std::int64_t>(std::floor(p[0] / cell_)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(p[1] / cell_)) + dy;
    return static_cast<Cell>(x) * 0x9E3779B97F4A7C15u ^ (static_cast<Cell>(y) * 0xC2B2AE3D27D4EB4Fu);
  }
  [[nodiscard]] PlaneDirection direction(std::size_t i, bool end) const {
    return end ? end_[i].span.d : start_[i].span.d;
  }

  [[nodiscard]] std::int32_t follower(std::size_t i) const {
    const Junction& here = end_[i];
    const PlaneDirection back = direction(i, true).reversed();
    const double fx = here.rounded[0] / cell_ - std::floor(here.rounded[0] / cell_);
    const double fy = here.rounded[1] / cell_ - std::floor(here.rounded[1] / cell_);
    std::int32_t best = -1;
    for (const int dx : {0, fx < 0.5 ? -1 : 1}) {
      for (const int dy : {0, fy < 0.5 ? -1 : 1}) {
        const auto found = grid_.find(cell_of(here.rounded, dx, dy));
        if (found == grid_.end()) continue;
        for (const std::int32_t j : found->second) {
          if (j == best || !same_point(here, start_[at(j)])) continue;
          if (best < 0 || turns_before(back, direction(at(j), false), direction(at(best), false))) best = j;
        }
      }
    }
    assert(best >= 0);
    return best;
  }

  const SumBoundary& boundary_;
  std::vector<Stretch>& stretches_;
  std::vector<Junction> start_, end_;
  std::vector<std::int32_t> next_;
  std::unordered_map<Cell, std::vector<std::int32_t>> grid_;
  double cell_ = 0;
};

/// The stretch with an edge that starts at the least point of R, which is P's least vertex less Q's greatest. If
/// rings touch there, several may start at it: the lowest one has the unbounded face on its right.
int outer_stretch(const SumBoundary& boundary, const std::vector<Stretch>& stretches) {
  const SumPoint* least = nullptr;
  std::vector<SumPoint> zeroth;
  for (const ConvexSum& sum : boundary.sums()) zeroth.push_back(sum.vertex(0));
  for (const SumPoint& x : zeroth) {
    if (least == nullptr || x.p < least->p || (x.p == least->p && least->q < x.q)) least = &x;
  }
  int best = -1;
  PlaneDirection lowest;
  for (int i = 0; i < static_cast<int>(stretches.size()); ++i) {
    const Stretch& s = stretches[at(i)];
    const Candidate& c = boundary.candidate(s);
    for (int e = SumBoundary::first_edge(s); e <= SumBoundary::last_edge(s); ++e) {
      if (e == s.from.edge && s.from.at.kind != Place::Kind::start) continue;
      // Vertex 0 of a convex sum is its least: no other vertex can be the least of all.
      if (boundary.sum_edge(c, e) != 0) {
        if (e + 1 <= SumBoundary::last_edge(s)) {  // go straight to where edge 0 would be
          const int to_zero = boundary.sum(c).size() - boundary.sum_edge(c, e);
          e += to_zero - 1;
        }
        continue;
      }
      const SumPoint x = boundary.sum(c).vertex(0);
      if (x.p != least->p || x.q != least->q) continue;
      const PlaneDirection d = boundary.sum(c).direction(0);
      if (best >= 0 && compare_angles(d, lowest) >= 0) continue;
      best = i;
      lowest = d;
    }
  }
  assert(best >= 0);
  return std::max(best, 0);
}

}  // namespace

int link_loops(const SumBoundary& boundary, std::vector<Stretch>& stretches, std::int64_t& reflex_points) {
  Linker linker(boundary, stretches);
  linker.run(reflex_points);
  return linker.number_loops(outer_stretch(boundary, stretches));
}

}  // namespace pd::detail
