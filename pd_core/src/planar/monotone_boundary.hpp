/// @file
/// The boundary of R = P + (-Q) cut where it turns back across a direction d, and every arc stood for by its chord.
///
/// An arc's chord lies inside R, and chords cross neither each other nor the edges ([D] section 4.3): what is left is
/// straight segments that meet in ends alone. Between an arc and its chord lies an ear. Places across d are measured by
/// u(x) = cross(x, d), so that with d pointing up u grows to the right. Every sign is that of the stored numbers.
#pragma once

#include <vector>

#include "planar/boundary/sum_boundary.hpp"

namespace pd::detail {

/// Edges `first` .. `last` of a stretch, all going the same way across d. One edge is straight, more are an arc.
struct MonotonePiece {
  std::int32_t stretch, first, last;
  bool increasing = false;  ///< u grows from its start to its end; R is on its left
  [[nodiscard]] bool arc() const { return first != last; }
};

/// The points with a x + b y + c w = 0; positive on the left.
template <class N>
struct Line2 {
  N a, b, c;
};

class MonotoneBoundary {
 public:
  MonotoneBoundary(const SumBoundary& boundary, const Point2& direction);

  [[nodiscard]] const Point2& direction() const { return direction_; }
  /// Those that go across d, and the single edges along it.
  [[nodiscard]] const std::vector<MonotonePiece>& pieces() const { return pieces_; }
  [[nodiscard]] const std::vector<MonotonePiece>& along() const { return along_; }

  /// Start or end of a piece, w > 0.
  template <class N>
  [[nodiscard]] Homogeneous<N> end_of(const MonotonePiece& piece, bool end) const;
  [[nodiscard]] EdgePart part(const MonotonePiece& piece, int edge) const {
    return boundary_.part(boundary_.stretches()[static_cast<std::size_t>(piece.stretch)], edge);
  }
  /// The line through a piece's ends, from start to end.
  template <class N>
  [[nodiscard]] Line2<N> line_of(const MonotonePiece& piece) const;

  /// The edge of an arc that lies at y's place across d, and 1 where y is past it along d, 0 on it, -1 where it is
  /// ahead. Requires that the arc is there. Time O(log m).
  struct OnArc {
    int edge;
    int past;
  };
  [[nodiscard]] OnArc arc_at(const MonotonePiece& piece, const Point2& y) const;

 private:
  void add_runs(std::int32_t stretch);

  const SumBoundary& boundary_;
  Point2 direction_;
  std::vector<MonotonePiece> pieces_, along_;
};

/// The same point with w > 0; an estimate that leaves the sign of w open gets no certain sign any more.
template <class N>
Homogeneous<N> with_positive_weight(const Homogeneous<N>& x) {
  if constexpr (std::is_same_v<N, Estimate>) {
    const int sign = x.w.certain_sign();
    if (sign == 0) {
      const Estimate open(0, std::numeric_limits<double>::infinity());
      return {open, open, open};
    }
    return sign > 0 ? x : Homogeneous<N>{-x.x, -x.y, -x.w};
  } else {
    return x.w.sign() > 0 ? x : Homogeneous<N>{-x.x, -x.y, -x.w};
  }
}

template <class N>
Homogeneous<N> MonotoneBoundary::end_of(const MonotonePiece& piece, bool end) const {
  const EdgePart p = part(piece, end ? piece.last : piece.first);
  return with_positive_weight(point_at<N>(p.span, end ? p.to : p.from));
}

template <class N>
Line2<N> MonotoneBoundary::line_of(const MonotonePiece& piece) const {
  if (piece.arc()) {
    const Homogeneous<N> a = end_of<N>(piece, false), b = end_of<N>(piece, true);
    return {a.y * b.w - b.y * a.w, b.x * a.w - a.x * b.w, a.x * b.y - b.x * a.y};
  }
  const Span span = part(piece, piece.first).span;
  const Vector2<N> d = vector<N>(span.d);
  const Vector2<N> s = {N(span.s.p[0]) - N(span.s.q[0]), N(span.s.p[1]) - N(span.s.q[1])};
  return {-d.y, d.x, d.y * s.x - d.x * s.y};
}

}  // namespace pd::detail
