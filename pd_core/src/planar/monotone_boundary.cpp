#include "planar/monotone_boundary.hpp"

namespace pd::detail {

MonotoneBoundary::MonotoneBoundary(const SumBoundary& boundary, const Point2& direction)
    : boundary_(boundary), direction_(direction) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(boundary.stretches().size()); ++i) add_runs(i);
}

/// An arc turns by less than 180 degrees: its edges go one way, perhaps one goes along d, and the rest go the other
/// way.
void MonotoneBoundary::add_runs(std::int32_t stretch) {
  const Stretch& s = boundary_.stretches()[static_cast<std::size_t>(stretch)];
  const Candidate& c = boundary_.candidate(s);
  const int first = SumBoundary::first_edge(s), last = SumBoundary::last_edge(s);
  const auto way = [&](int edge) {
    return cross_sign(boundary_.sum(c).direction(boundary_.sum_edge(c, edge)), {{0, 0}, direction_});
  };
  for (int begin = first; begin <= last;) {
    const int sign = way(begin);
    int end = begin;
    if (sign != 0) {
      int beyond = last + 1;  // the run ends in [end, beyond)
      while (beyond - end > 1) {
        const int middle = (end + beyond) / 2;
        (way(middle) == sign ? end : beyond) = middle;
      }
    }
    (sign == 0 ? along_ : pieces_).push_back({stretch, begin, end, sign > 0});
    begin = end + 1;
  }
}

MonotoneBoundary::OnArc MonotoneBoundary::arc_at(const MonotonePiece& piece, const Point2& y) const {
  const SumPoint x{y, {0, 0}};
  const Candidate& c = boundary_.candidate(boundary_.stretches()[static_cast<std::size_t>(piece.stretch)]);
  int low = piece.first, high = piece.last + 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const SumPoint v = boundary_.edge(c, middle).s;
    // Sign of u(y) - u(v).
    const int beyond = exact_sign([&]<class N>() {
      const Vector2<N> step = from_to<N>(v, x);
      return step.x * N(direction_[1]) - step.y * N(direction_[0]);
    });
    ((beyond >= 0) == piece.increasing || beyond == 0 ? low : high) = middle;
  }
  const Span span = boundary_.edge(c, low);
  const int left = side_of(span.s, span.d, x);
  return {low, piece.increasing ? left : -left};
}

}  // namespace pd::detail
