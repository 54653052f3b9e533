// Where the boundary touches itself in a point inside a stretch, the stretch is split there: the faces on both sides of
// such a point are two, and a loop turns off at it.
#include <algorithm>
#include <cmath>

#include "planar/boundary_builder.hpp"
#include "planar/covered_intervals.hpp"

namespace pd::detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

class Touches {
 public:
  Touches(const SumBoundary& boundary, const std::vector<Stretch>& stretches)
      : boundary_(boundary), stretches_(stretches), cuts_(stretches.size()) {
    std::vector<Box2> pieces;
    for (int i = 0; i < static_cast<int>(stretches_.size()); ++i) {
      boxes_.push_back(boundary_.box(stretches_[at(i)]));
      add_pieces(i, pieces);
    }
    tree_ = BoxTree(std::move(pieces));
  }

  [[nodiscard]] std::vector<Stretch> split() {
    for (int i = 0; i < static_cast<int>(stretches_.size()); ++i) {
      const Stretch& s = stretches_[at(i)];
      visit(i, SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1);
    }
    std::vector<Stretch> parts;
    for (std::size_t i = 0; i < stretches_.size(); ++i) split_one(stretches_[i], cuts_[i], parts);
    return parts;
  }

 private:
  /// A straight stretch gives a row of small boxes along it: of long edges side by side, as a star has them, whole
  /// boxes would all overlap.
  void add_pieces(int i, std::vector<Box2>& pieces) {
    constexpr int kPieces = 16;
    const Stretch& s = stretches_[at(i)];
    const int first = SumBoundary::first_edge(s), count = SumBoundary::last_edge(s) - first + 1;
    const Span e = boundary_.edge(boundary_.candidate(s), first);
    const Point2 from = {e.s.p[0] - e.s.q[0], e.s.p[1] - e.s.q[1]}, to = {e.z.p[0] - e.z.q[0], e.z.p[1] - e.z.q[1]};
    const auto between = [&](int k) {
      const double t = static_cast<double>(k) / kPieces;
      return Point2{(1 - t) * from[0] + t * to[0], (1 - t) * from[1] + t * to[1]};
    };
    for (int k = 0; k < (count == 1 ? kPieces : 1); ++k) {
      Box2 piece = boxes_[at(i)];
      if (count == 1) {
        piece = {};
        piece.add(between(k));
        piece.add(between(k + 1));
        // What interpolation rounds is relative to the ends, not to a piece near zero between them.
        for (std::size_t a = 0; a < 2; ++a) {
          const double air = 0x1p-48 * std::max(std::abs(from[a]), std::abs(to[a]));
          piece.low[a] -= air;
          piece.high[a] += air;
        }
      }
      pieces.push_back(piece);
      owner_.push_back(i);
    }
  }

  /// Others that may be near the box; one of them may come more than once. `other` returns whether to go on.
  template <class Visit>
  void visit_others(const Box2& box, int self, const Visit& other) const {
    bool more = true;
    tree_.visit([&](const Box2& b) { return more && b.meets(box); },
                [&](std::int32_t piece) {
                  const std::int32_t j = owner_[at(piece)];
                  if (more && j != self && boxes_[at(j)].meets(box)) more = other(j);
                });
  }

  /// Halves the range of edges until no other stretch is near, or one edge is left.
  void visit(int i, int begin, int end) {
    const Box2 box = boundary_.box(boundary_.candidate(stretches_[at(i)]), begin, end);
    bool near = false;
    visit_others(box, i, [&](int) {
      near = true;
      return false;
    });
    if (!near) return;
    if (end - begin > 1) {
      visit(i, begin, (begin + end) / 2);
      visit(i, (begin + end) / 2, end);
      return;
    }
    const Box2 start = box_of_start(i, begin, box);
    visit_others(start, i, [&](int j) {
      const Stretch& s = stretches_[at(j)];
      compare(i, begin, j, start, SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1);
      return true;
    });
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
  std::vector<std::int32_t> owner_;  ///< of every box of the tree
  BoxTree tree_;
};

}  // namespace

std::vector<Stretch> split_where_touched(const SumBoundary& boundary, const std::vector<Stretch>& stretches) {
  return Touches(boundary, stretches).split();
}

}  // namespace pd::detail
