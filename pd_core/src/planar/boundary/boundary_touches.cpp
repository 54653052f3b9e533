// Where the boundary touches itself in a point inside a stretch, the stretch is split there: the faces on both sides of
// such a point are two, and a loop turns off at it.
#include <algorithm>
#include <cmath>

#include "numeric/at.hpp"
#include "planar/boundary/boundary_builder.hpp"
#include "planar/boundary/covered_intervals.hpp"

namespace pd::detail {

namespace {

/// A point of a stretch inside another one belongs to the sums of both, and the other sum was met when the stretch's
/// candidate was cut: only its stretches are looked at. (A tree of boxes over all of them had a star's long edges side
/// by side in the same boxes, n^1.4 pairs and four fifths of the time at n = 10^4.)
class Touches {
 public:
  Touches(const SumBoundary& boundary, const std::vector<Stretch>& stretches)
      : boundary_(boundary), stretches_(stretches), cuts_(stretches.size()) {
    by_sum_.resize(stretches.size());
    first_.assign(boundary.sums().size() + 1, 0);
    for (const Stretch& s : stretches_) {
      boxes_.push_back(boundary_.box(s));
      ++first_[at(boundary_.candidate(s).sum) + 1];
    }
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (int i = 0; i < static_cast<int>(stretches_.size()); ++i) {
      by_sum_[at(next[at(boundary_.candidate(stretches_[at(i)]).sum)]++)] = i;
    }
  }

  [[nodiscard]] std::vector<Stretch> split(const std::vector<NearSum>& near) {
    std::size_t begin = 0;
    for (const NearSum& pair : near) {
      while (stretches_[begin].candidate < pair.candidate) ++begin;
      for (std::size_t i = begin; i < stretches_.size() && stretches_[i].candidate == pair.candidate; ++i) {
        const Stretch& s = stretches_[i];
        for (int k = first_[at(pair.sum)]; k < first_[at(pair.sum) + 1]; ++k) {
          visit(static_cast<int>(i), by_sum_[at(k)], SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1);
        }
      }
    }
    std::vector<Stretch> parts;
    for (std::size_t i = 0; i < stretches_.size(); ++i) split_one(stretches_[i], cuts_[i], parts);
    return parts;
  }

 private:
  /// Halves the range of i's edges until stretch j is not near, or one edge is left.
  void visit(int i, int j, int begin, int end) {
    const Box2 box = boundary_.box(boundary_.candidate(stretches_[at(i)]), begin, end);
    if (!boxes_[at(j)].meets(box)) return;
    if (end - begin > 1) {
      visit(i, j, begin, (begin + end) / 2);
      visit(i, j, (begin + end) / 2, end);
      return;
    }
    const Stretch& s = stretches_[at(j)];
    const Box2 start = box_of_start(i, begin, box);
    if (boxes_[at(j)].meets(start)) {
      compare(i, begin, j, start, SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1);
    }
  }

  /// Round the start of an edge of a stretch; the edge's whole box where rounding leaves the start open.
  [[nodiscard]] Box2 box_of_start(int i, int e, const Box2& whole) const {
    const EdgePart part = boundary_.part(stretches_[at(i)], e);
    const auto x = point_at<Estimate>(part.span, part.from);
    const double w = std::abs(x.w.value) - x.w.error;
    if (!(w > 0)) return whole;
    Box2 box;
    const Point2 middle = {x.x.value / x.w.value, x.y.value / x.w.value};
    const Point2 air = {(x.x.error + std::abs(middle[0]) * x.w.error) / w * 1.01,
                        (x.y.error + std::abs(middle[1]) * x.w.error) / w * 1.01};
    if (!std::isfinite(middle[0] + middle[1] + air[0] + air[1])) return whole;
    box.add(Point2{middle[0] - air[0], middle[1] - air[1]});
    box.add(Point2{middle[0] + air[0], middle[1] + air[1]});
    return box.widened();
  }

  /// Does edge e of stretch i start on an edge of stretch j, inside the latter?
  void compare(int i, int e, int j, const Box2& box, int begin, int end) {
    const Candidate& c = boundary_.candidate(stretches_[at(j)]);
    if (!boundary_.box(c, begin, end).meets(box)) return;
    if (end - begin > 1) {
      compare(i, e, j, box, begin, (begin + end) / 2);
      compare(i, e, j, box, (begin + end) / 2, end);
      return;
    }
    const EdgePart mine = boundary_.part(stretches_[at(i)], e), other = boundary_.part(stretches_[at(j)], begin);
    const int side = exact_sign([&]<class N>() {
      const Homogeneous<N> x = point_at<N>(mine.span, mine.from);
      const Vector2<N> d = vector<N>(other.span.d);
      const Vector2<N> s = {N(other.span.s.p[0]) - N(other.span.s.q[0]), N(other.span.s.p[1]) - N(other.span.s.q[1])};
      return d.x * (x.y - s.y * x.w) - d.y * (x.x - s.x * x.w);
    });
    if (side != 0) return;
    const std::optional<Place> place = place_on(other, mine);
    if (!place) return;
    const int from = compare_places(other.span, other.from, *place);
    const bool first = begin == SumBoundary::first_edge(stretches_[at(j)]);
    if (from > 0 || (from == 0 && first) || compare_places(other.span, *place, other.to) >= 0) return;
    cuts_[at(j)].push_back(from == 0 ? Position{begin, {}} : Position{begin, *place});
    if (e != SumBoundary::first_edge(stretches_[at(i)])) cuts_[at(i)].push_back({e, {}});
  }

  /// The start of `mine`, known to lie on the other edge's line, as a place there.
  static std::optional<Place> place_on(const EdgePart& other, const EdgePart& mine) {
    if (mine.from.kind == Place::Kind::start) return Place{Place::Kind::point, mine.span.s, {}};
    if (mine.from.kind == Place::Kind::point) return mine.from;
    if (cross_sign(mine.span.d, other.span.d) != 0) return Place{Place::Kind::line, mine.span.s, mine.span.d};
    if (cross_sign(mine.from.direction, other.span.d) != 0) return mine.from;
    return std::nullopt;
  }

  void split_one(const Stretch& s, std::vector<Position>& cuts, std::vector<Stretch>& parts) const {
    const Candidate& c = boundary_.candidate(s);
    const CoveredIntervals order(boundary_, c);
    std::sort(cuts.begin(), cuts.end(), [&](const Position& a, const Position& b) { return order.compare(a, b) < 0; });
    Stretch rest = s;
    for (const Position& cut : cuts) {
      if (order.compare(rest.from, cut) >= 0) continue;
      parts.push_back({s.candidate, rest.from, cut});
      rest.from = cut;
    }
    parts.push_back(rest);
  }

  const SumBoundary& boundary_;
  const std::vector<Stretch>& stretches_;
  std::vector<std::vector<Position>> cuts_;
  std::vector<Box2> boxes_;
  std::vector<std::int32_t> by_sum_;  ///< stretches, those of one sum together
  std::vector<std::int32_t> first_;   ///< by sum, one more at the end: into `by_sum_`
};

}  // namespace

std::vector<Stretch> split_where_touched(const SumBoundary& boundary, const std::vector<Stretch>& stretches,
                                         const std::vector<NearSum>& near) {
  return Touches(boundary, stretches).split(near);
}

}  // namespace pd::detail
