#include "planar/straight_escape.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/at.hpp"
#include "numeric/length.hpp"
#include "numeric/root_sum.hpp"
#include "planar/monotone_boundary.hpp"

namespace pd::detail {

StraightEscape::Way StraightEscape::run() {
  collect();
  std::sort(feet_.begin(), feet_.end(), [](const Candidate& a, const Candidate& b) { return a.low < b.low; });
  for (const auto* list : {&feet_, &corners_}) {
    for (const Candidate& candidate : *list) {
      if (!(candidate.low > limit_)) attempt(candidate);
    }
  }
  return best_ ? *best_ : Way{{Dyadic(), Dyadic(), Dyadic(1.0)}, std::nullopt};
}

void StraightEscape::collect() {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(boundary_.stretches().size()); ++i) {
    const Stretch& s = boundary_.stretches()[at(i)];
    const int first = SumBoundary::first_edge(s), last = SumBoundary::last_edge(s);
    const EdgePart part = boundary_.part(s, first);
    corners_.push_back({part.span, part.from, false, 0});  // every end of a stretch is the start of another one
    int side_before = 0;
    for (int e = first; e <= last; ++e) collect_edge(i, e, side_before);
  }
}

/// The foot on an edge with R between y and it; the vertex where an arc turns its other side to y.
void StraightEscape::collect_edge(std::int32_t stretch, int edge, int& side_before) {
  const EdgePart part = boundary_.part(boundary_.stretches()[at(stretch)], edge);
  const SumPoint y = BoundaryQuery::point(y_);
  const int side = side_of(part.span.s, part.span.d, y);
  if (edge != SumBoundary::first_edge(boundary_.stretches()[at(stretch)]) && side != side_before) {
    corners_.push_back({part.span, {}, false, 0});
  }
  side_before = side;
  if (side <= 0) return;
  const Place foot{Place::Kind::point, y, {}};  // its fraction along the edge is that of the foot
  if (compare_places(part.span, part.from, foot) >= 0 || compare_places(part.span, foot, part.to) >= 0) return;
  const Vector2<Estimate> d = vector<Estimate>(part.span.d);
  const Estimate area = cross(d, from_to<Estimate>(part.span.s, y)), squared = dot(d, d);
  const double low = (area.value - area.error) / std::sqrt(squared.value + squared.error) * (1 - 0x1p-40);
  feet_.push_back({part.span, {}, true, low > 0 ? low : 0});
}

template <class N>
Vector2<N> StraightEscape::direction(const Candidate& candidate) const {
  if (candidate.foot) {
    const Vector2<N> e = vector<N>(candidate.span.d);
    return {e.y, -e.x};
  }
  const Homogeneous<N> x = with_positive_weight(point_at<N>(candidate.span, candidate.place));
  return {x.x - N(y_[0]) * x.w, x.y - N(y_[1]) * x.w};
}

/// Of length 1, within 2^-44; nothing for no direction at all.
std::optional<Point2> StraightEscape::rounded_direction(const Candidate& candidate) const {
  const Vector2<Estimate> d = direction<Estimate>(candidate);
  const double length = pd::detail::length(d.x.value, d.y.value);
  if (d.x.error + d.y.error <= 0x1p-46 * length && std::isfinite(length)) {
    return Point2{d.x.value / length, d.y.value / length};
  }
  const Vector2<Dyadic> exact = direction<Dyadic>(candidate);
  if (exact.x.sign() == 0 && exact.y.sign() == 0) return std::nullopt;
  const Vec3DD u = unit_double_double({exact.x, exact.y, Dyadic()});
  return Point2{to_double(u.x), to_double(u.y)};
}

/// cross(d, x - y) times x's weight, which is positive: its side of the line along d.
template <class N>
N StraightEscape::beside(const Vector2<N>& d, const Span& span, const Place& place) const {
  const Homogeneous<N> x = with_positive_weight(point_at<N>(span, place));
  return d.x * (x.y - N(y_[1]) * x.w) - d.y * (x.x - N(y_[0]) * x.w);
}

void StraightEscape::attempt(const Candidate& candidate) {
  const std::optional<Point2> rounded = rounded_direction(candidate);
  if (!rounded) return;
  const Vector2<Estimate> d = direction<Estimate>(candidate);
  std::vector<Piece> pieces;
  if (blocked(d, *rounded) || !gather(d, *rounded, pieces)) return;
  const Vector2<Dyadic> exact = direction<Dyadic>(candidate);
  std::vector<Hit> hits;
  for (const Piece& piece : pieces) {
    if (auto hit = meet(piece, exact)) hits.push_back(std::move(*hit));
  }
  finish(hits, exact);
}

double StraightEscape::certain_crossing(const EdgePart& part, const Vector2<Estimate>& d, const Point2& u) const {
  const Estimate from = beside(d, part.span, part.from), to = beside(d, part.span, part.to);
  if (from.certain_sign() * to.certain_sign() >= 0) return 0;
  const SumPoint y = BoundaryQuery::point(y_);
  const Vector2<Estimate> edge = vector<Estimate>(part.span.d);
  const Estimate n = cross(from_to<Estimate>(y, part.span.s), edge);
  const Estimate w = edge.y * Estimate(u[0]) - edge.x * Estimate(u[1]);
  // u is within 2^-44 of the direction, so that w is within so much of the edge's length.
  const double off = 0x1p-43 * (std::abs(edge.x.value) + std::abs(edge.y.value)) + w.error;
  const double least = (std::abs(n.value) - n.error) / (std::abs(w.value) + off);
  return least > 0 && n.value * w.value > 0 ? least * (1 - 0x1p-40) : 0;
}

bool StraightEscape::blocked(const Vector2<Estimate>& d, const Point2& u) const {
  if (!std::isfinite(limit_)) return false;
  bool found = false;
  double reach = std::numeric_limits<double>::infinity();
  const RoundedRay beyond({y_[0] + limit_ * u[0], y_[1] + limit_ * u[1]}, u);
  rays_.visit(beyond, reach, [&](std::int32_t i) {
    const Stretch& s = boundary_.stretches()[at(i)];
    const int edge = SumBoundary::first_edge(s);
    if (found || edge != SumBoundary::last_edge(s)) return;
    found = certain_crossing(boundary_.part(s, edge), d, u) > limit_;
    if (found) reach = -1;
  });
  return found;
}

bool StraightEscape::gather(const Vector2<Estimate>& d, const Point2& u, std::vector<Piece>& pieces) const {
  double nearest = 0;  // a crossing at least so far out is certain: what is nearer does not matter
  bool more = true;
  struct Reach {
    bool meets;
    double farthest;
  };
  const auto reach = [&](const Box2& box) {
    double low = std::numeric_limits<double>::infinity(), high = -low, farthest = -low, size = 0;
    for (int k = 0; k < 4; ++k) {
      const double x = (k % 2 == 0 ? box.low : box.high)[0], z = (k / 2 == 0 ? box.low : box.high)[1];
      const double beside = u[0] * (z - y_[1]) - u[1] * (x - y_[0]);
      low = std::min(low, beside);
      high = std::max(high, beside);
      farthest = std::max(farthest, u[0] * (x - y_[0]) + u[1] * (z - y_[1]));
      size = std::max({size, std::abs(x), std::abs(z)});
    }
    // The direction within 2^-44, and roundings.
    const double air = 0x1p-42 * (size + std::abs(y_[0]) + std::abs(y_[1]));
    return Reach{!(low > air || high < -air), farthest + air};
  };
  const auto enter = [&](const Box2& box) {
    if (!more) return false;
    const Reach r = reach(box);
    return r.meets && !(r.farthest < nearest);
  };
  const auto look = [&](std::int32_t i, int e) {
    pieces.push_back({i, e});
    nearest = std::max(nearest, certain_crossing(boundary_.part(boundary_.stretches()[at(i)], e), d, u));
    if (nearest > limit_) more = false;
  };
  tree_.visit(
      enter, [&](const Box2& box) { return -reach(box).farthest; },
      [&](std::int32_t i) {
        if (!more) return;
        const Stretch& s = boundary_.stretches()[at(i)];
        const auto halves = [&](const auto& self, int begin, int end) -> void {
          if (!enter(boundary_.box(boundary_.candidate(s), begin, end))) return;
          if (end - begin == 1) return look(i, begin);
          const int middle = (begin + end) / 2;
          self(self, begin, middle);
          self(self, middle, end);
        };
        halves(halves, SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1);
      });
  return more;
}

std::optional<StraightEscape::Hit> StraightEscape::meet(const Piece& piece, const Vector2<Dyadic>& d) const {
  const EdgePart part = boundary_.part(boundary_.stretches()[at(piece.stretch)], piece.edge);
  const int from = beside(d, part.span, part.from).sign(), to = beside(d, part.span, part.to).sign();
  const int way = to > from ? 1 : -1;  // from the ray's right to its left: R lies behind the edge
  Hit hit{piece, {}, {}, 0, 0};
  if (std::min(from, to) < 0 && std::max(from, to) >= 0) hit.right = way;
  if (std::min(from, to) <= 0 && std::max(from, to) > 0) hit.left = way;
  if (hit.right == 0 && hit.left == 0) return std::nullopt;
  const Vector2<Dyadic> edge = vector<Dyadic>(part.span.d);
  hit.numerator = cross(from_to<Dyadic>(BoundaryQuery::point(y_), part.span.s), edge);
  hit.denominator = cross(d, edge);
  if (hit.denominator.sign() < 0) {
    hit.numerator = -hit.numerator;
    hit.denominator = -hit.denominator;
  }
  if (hit.numerator.sign() <= 0) return std::nullopt;
  return hit;
}

/// From infinity inwards: the last point of R is where both sides of the ray are first in R. What only one side meets
/// is touched by the ray from outside or from inside.
void StraightEscape::finish(std::vector<Hit>& hits, const Vector2<Dyadic>& d) {
  const auto order = [](const Hit& a, const Hit& b) {
    return (a.numerator * b.denominator - b.numerator * a.denominator).sign();
  };
  std::sort(hits.begin(), hits.end(), [&](const Hit& a, const Hit& b) {
    const int sign = order(a, b);
    if (sign != 0) return sign > 0;
    return a.piece.stretch != b.piece.stretch ? a.piece.stretch < b.piece.stretch : a.piece.edge < b.piece.edge;
  });
  int right = 0, left = 0;
  for (std::size_t i = 0; i < hits.size();) {
    const Hit& here = hits[i];
    std::optional<BoundaryPoint> exit;
    for (; i < hits.size() && order(hits[i], here) == 0; ++i) {
      right += hits[i].right;
      left += hits[i].left;
      if (!exit && (hits[i].right > 0 || hits[i].left > 0)) exit = {hits[i].piece.stretch, hits[i].piece.edge, {}};
    }
    if (right <= 0 || left <= 0) continue;
    return offer({d.x * here.numerator, d.y * here.numerator, here.denominator}, exit);
  }
  offer({Dyadic(), Dyadic(), Dyadic(1.0)}, std::nullopt);
}

void StraightEscape::offer(const ExactVector& move, const std::optional<BoundaryPoint>& exit) {
  const Dyadic squared = move.x * move.x + move.y * move.y, weight = move.w * move.w;
  if (best_) {
    int order = (squared * best_weight_ - best_squared_ * weight).sign();
    if (order == 0) order = (move.x * best_->move.w - best_->move.x * move.w).sign();
    if (order == 0) order = (move.y * best_->move.w - best_->move.y * move.w).sign();
    if (order >= 0) return;
  }
  best_ = Way{move, exit};
  best_squared_ = squared;
  best_weight_ = weight;
  if (squared.sign() == 0) {
    limit_ = 0;
    return;
  }
  const RootSum length(Dyadic(), 1, squared, weight);
  limit_ = length.round_up(length.round_down());
}

}  // namespace pd::detail
