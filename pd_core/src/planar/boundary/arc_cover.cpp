#include "planar/boundary/arc_cover.hpp"

namespace pd::detail {

namespace {

/// The end of an edge is the start of the next one.
Position normalised(int edge, const Place& at) {
  if (at.kind == Place::Kind::end) return {edge + 1, {}};
  return {edge, at};
}

}  // namespace

std::int64_t ArcCover::cut(int sum, CandidateCover& cover) {
  sum_ = sum;
  crossings_ = 0;
  ++counts_.pairs;
  if (candidate_.count == 1) {
    cut_edge(0, cover);
  } else {
    cut_arc(cover);
  }
  return crossings_;
}

void ArcCover::cut_edge(int edge, CandidateCover& cover) {
  ++counts_.edges_covered;
  const auto part = other().cover(boundary_.edge(candidate_, edge));
  if (!part) return;
  const CoveredIntervals::Interval interval{normalised(edge, part->from), normalised(edge, part->to)};
  switch (part->kind) {
    case ConvexSum::Cover::Kind::inside:
      crossings_ += part->from.kind == Place::Kind::line ? 1 : 0;
      crossings_ += part->to.kind == Place::Kind::line ? 1 : 0;
      cover.add(interval);
      break;
    case ConvexSum::Cover::Kind::same_edge:
      if (gives_way_(sum_, part->edge)) cover.add(interval);
      break;
    case ConvexSum::Cover::Kind::opposite_edge:
      cover.abutting.push_back(interval);
      break;
  }
}

// The candidate's edges have one corner c of the own triangle T. Along the normal n of an edge T reaches as far as c,
// and the other triangle U farther than T exactly when some corner u of U has <u - c, n> > 0. Where none has, the edge
// is not inside U + (-B), for -B adds the same to both. Per corner this holds for a prefix or a suffix of the arc,
// which turns by less than 180 degrees.
void ArcCover::cut_arc(CandidateCover& cover) {
  const int count = candidate_.count;
  const Point2 corner = vertex(0).p;
  int low = 0, high = count;  // the edges along which U reaches no farther
  bool tie = false;
  for (int k = 0; k < other().num_corners(); ++k) {
    const PlaneDirection to_other{corner, other().corner(k)};
    if (to_other.from == to_other.to) continue;
    const auto sign = [&](int e) { return cross_sign(to_other, direction(e)); };
    const int first = sign(0), last = sign(count - 1);
    tie = tie || first == 0 || last == 0;
    if (first > 0 && last > 0) high = 0;
    if ((first > 0) == (last > 0)) continue;
    int a = 0, b = count - 1;  // the sign changes between edges a and b
    while (b - a > 1) {
      const int middle = (a + b) / 2;
      const int s = sign(middle);
      tie = tie || s == 0;
      ((s > 0) == (first > 0) ? a : b) = middle;
    }
    if (first > 0) {
      low = std::max(low, b);
    } else {
      high = std::min(high, b);
    }
  }
  if (low > high || high == 0 || low == count) return search(0, count, cover);
  // Where low == high the directions along which U reaches no farther lie in the cone of one vertex, between two edges.
  if (low > 0) search(0, low, cover);
  if (high < count) search(high, count, cover);
  if (tie && low < high) {  // edges on one line with an edge of the other sum are the outermost of these
    cut_edge(low, cover);
    if (high - 1 > low) cut_edge(high - 1, cover);
  }
}

bool ArcCover::vertex_inside(int v) const {
  ++counts_.locations;
  return other().locate(vertex(v)).inside;
}

// At a vertex x with normal n outside U + (-B) some edge of that with normal m has x on it or beyond it. Every vertex
// of the arc with a normal between n and m lies beyond it as well, and so on to where T reaches farther than U: the
// covered part lies on the other side of x. [n and -n are no such m: along n the other sum reaches farther; along -n
// the two would be apart.]
int ArcCover::classify(int v, int high) const {
  ++counts_.locations;
  const ConvexSum::Location found = other().locate(vertex(v));
  if (found.inside) return 0;
  const int turn = cross_sign(direction(v < high ? v : v - 1), other().direction(found.edge));
  return turn == 0 ? 2 : -turn;
}

void ArcCover::search(int low, int high, CandidateCover& cover) {
  int a = low, b = high;
  for (const int end : {low, high}) {
    const int where = classify(end, high);
    if (where == 0) return grow(low, end, high, cover);
    if (where == 2) return cut_edge(end < high ? end : end - 1, cover);
    if (where == (end == low ? -1 : 1)) return;
  }
  while (b - a > 1) {
    const int middle = (a + b) / 2;
    const int where = classify(middle, high);
    if (where == 0) return grow(low, middle, high, cover);
    if (where == 2) return cut_edge(middle, cover);
    (where > 0 ? a : b) = middle;
  }
  cut_edge(a, cover);
}

void ArcCover::grow(int low, int seed, int high, CandidateCover& cover) {
  int outside = low - 1, inside = seed;
  while (inside - outside > 1) {
    const int middle = (outside + inside) / 2;
    (vertex_inside(middle) ? inside : outside) = middle;
  }
  const int first = inside;
  inside = seed;
  outside = high + 1;
  while (outside - inside > 1) {
    const int middle = (outside + inside) / 2;
    (vertex_inside(middle) ? inside : outside) = middle;
  }
  const int last = inside;
  if (first < last) cover.add({{first, {}}, {last, {}}});
  if (first > low) cut_edge(first - 1, cover);
  if (last < high) cut_edge(last, cover);
}

}  // namespace pd::detail
