#include "planar/direction_slabs.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/at.hpp"
#include "planar/slab_sweep.hpp"

namespace pd::detail {

namespace {

template <class N>
N across(const Homogeneous<N>& x, const Point2& d) {
  return x.x * N(d[1]) - x.y * N(d[0]);
}
template <class N>
N value_at(const Line2<N>& line, const Homogeneous<N>& x) {
  return line.a * x.x + line.b * x.y + line.c * x.w;
}
/// Certainly not zero, with that sign; or 0.
template <class Exact>
int sign_of(const Estimate& estimate, const Exact& exact) {
  const int sign = estimate.certain_sign();
  return sign != 0 ? sign : exact().sign();
}

}  // namespace

DirectionSlabs::DirectionSlabs(MonotoneBoundary boundary) : boundary_(std::move(boundary)) {
  for (const MonotonePiece& piece : boundary_.pieces()) line_.push_back(boundary_.line_of<Estimate>(piece));
  find_events();
  SlabSweep(*this).run();
}

const MonotonePiece& DirectionSlabs::piece_of(const End& e) const {
  return e.piece >= 0 ? boundary_.pieces()[at(e.piece)] : boundary_.along()[at(-1 - e.piece)];
}

template <class N>
Homogeneous<N> DirectionSlabs::point(const End& e) const {
  if constexpr (std::is_same_v<N, Estimate>) {
    return e.x;
  } else {
    return boundary_.end_of<N>(piece_of(e), e.end);
  }
}

int DirectionSlabs::compare(const End& a, const End& b) const {
  const auto difference = [&]<class N>() {
    const Homogeneous<N> x = point<N>(a), z = point<N>(b);
    return across(x, boundary_.direction()) * z.w - across(z, boundary_.direction()) * x.w;
  };
  return sign_of(difference.template operator()<Estimate>(), [&] { return difference.template operator()<Dyadic>(); });
}

int DirectionSlabs::compare(const Point2& y, const End& e) const {
  const auto difference = [&]<class N>() {
    const Homogeneous<N> x = point<N>(e);
    return across(Homogeneous<N>{N(y[0]), N(y[1]), N(1.0)}, boundary_.direction()) * x.w -
           across(x, boundary_.direction());
  };
  return sign_of(difference.template operator()<Estimate>(), [&] { return difference.template operator()<Dyadic>(); });
}

int DirectionSlabs::past(const Point2& y, std::int32_t piece) const {
  const int left =
      sign_of(value_at(line_[at(piece)], Homogeneous<Estimate>{Estimate(y[0]), Estimate(y[1]), Estimate(1.0)}), [&] {
        return value_at(boundary_.line_of<Dyadic>(this->piece(piece)),
                        Homogeneous<Dyadic>{Dyadic(y[0]), Dyadic(y[1]), Dyadic(1.0)});
      });
  return this->piece(piece).increasing ? left : -left;
}

int DirectionSlabs::past(const End& e, std::int32_t piece) const {
  const int left = sign_of(value_at(line_[at(piece)], e.x),
                           [&] { return value_at(boundary_.line_of<Dyadic>(this->piece(piece)), point<Dyadic>(e)); });
  return this->piece(piece).increasing ? left : -left;
}

/// The places across d at which pieces end, in order, each once.
void DirectionSlabs::find_events() {
  std::vector<End> ends;
  const auto add = [&](const MonotonePiece& piece, std::int32_t index, bool end) {
    ends.push_back({boundary_.end_of<Estimate>(piece, end), index, end});
  };
  const auto pieces = static_cast<std::int32_t>(boundary_.pieces().size());
  const auto edges = static_cast<std::int32_t>(boundary_.along().size());
  for (std::int32_t i = 0; i < pieces; ++i) {
    add(boundary_.pieces()[at(i)], i, false);
    add(boundary_.pieces()[at(i)], i, true);
  }
  for (std::int32_t i = 0; i < edges; ++i) add(boundary_.along()[at(i)], -1 - i, false);
  std::sort(ends.begin(), ends.end(), [&](const End& a, const End& b) {
    const int order = compare(a, b);
    if (order != 0) return order < 0;
    return a.piece != b.piece ? a.piece < b.piece : a.end < b.end;
  });
  extent_.resize(at(pieces));
  std::vector<std::vector<std::int32_t>> along;
  for (const End& e : ends) {
    if (event_.empty() || compare(event_.back(), e) != 0) {
      event_.push_back(e);
      along.emplace_back();
    }
    const auto event = static_cast<std::int32_t>(event_.size()) - 1;
    if (e.piece < 0) {
      along.back().push_back(-1 - e.piece);
    } else {
      (e.end == boundary_.pieces()[at(e.piece)].increasing ? extent_[at(e.piece)].high : extent_[at(e.piece)].low) =
          event;
    }
  }
  // Along d, edges on one line follow each other: by their starts, for they do not overlap.
  const Point2& d = boundary_.direction();
  for (auto& list : along) {
    std::sort(list.begin(), list.end(), [&](std::int32_t i, std::int32_t j) {
      return exact_sign([&]<class N>() {
               const auto x = boundary_.end_of<N>(boundary_.along()[at(i)], false);
               const auto z = boundary_.end_of<N>(boundary_.along()[at(j)], false);
               return (x.x * N(d[0]) + x.y * N(d[1])) * z.w - (z.x * N(d[0]) + z.y * N(d[1])) * x.w;
             }) < 0;
    });
    along_begin_.push_back(static_cast<std::int32_t>(along_.size()));
    along_.insert(along_.end(), list.begin(), list.end());
  }
  along_begin_.push_back(static_cast<std::int32_t>(along_.size()));
}

DirectionSlabs::Column DirectionSlabs::column(const Point2& y, std::int64_t& probes) const {
  std::int32_t low = -1, high = static_cast<std::int32_t>(event_.size());  // the wanted event is in [low, high)
  while (high - low > 1) {
    const std::int32_t middle = low + (high - low) / 2;
    ++probes;
    const int order = compare(y, event_[at(middle)]);
    if (order == 0) return {middle, true};
    (order > 0 ? low : high) = middle;
  }
  return {low, false};
}

DirectionSlabs::Neighbours DirectionSlabs::neighbours(const Point2& y, const Column& column, bool closed,
                                                      std::int64_t& probes) const {
  Neighbours r;
  if (column.event < 0) return r;
  std::int32_t i = root_[at(column.event)][closed && column.on_event ? 0 : 1];
  if (i < 0) return r;
  int sign = 0;
  // Is y strictly past the last piece below that node?
  const auto beyond = [&](std::int32_t node) {
    ++probes;
    sign = past(y, piece_numbered_[at(node_[at(node)].last)]);
    return sign > 0;
  };
  if (beyond(i)) {
    r.behind = piece_numbered_[at(node_[at(i)].last)];
    return r;
  }
  int sign_ahead = sign;
  for (std::int32_t width = width_; width > 1; width /= 2) {
    const Node& node = node_[at(i)];
    if (node.left < 0) {
      i = node.right;
    } else if (node.right < 0) {
      i = node.left;
    } else if (beyond(node.left)) {
      r.behind = piece_numbered_[at(node_[at(node.left)].last)];
      i = node.right;
    } else {
      sign_ahead = sign;
      i = node.left;
    }
  }
  r.ahead = piece_numbered_[at(node_[at(i)].last)];
  r.on = sign_ahead == 0;
  return r;
}

std::int32_t DirectionSlabs::next(std::int32_t piece, const Column& column) const {
  const std::int32_t wanted = number_[at(piece)] + 1;
  std::int32_t i = root_[at(column.event)][column.on_event ? 0 : 1];
  if (i < 0 || node_[at(i)].last < wanted) return -1;
  for (std::int32_t width = width_; width > 1; width /= 2) {
    const Node& node = node_[at(i)];
    i = node.left >= 0 && node_[at(node.left)].last >= wanted ? node.left : node.right;
  }
  return piece_numbered_[at(node_[at(i)].last)];
}

bool DirectionSlabs::starts_at(std::int32_t piece, const Column& column) const {
  const Extent& e = extent_[at(piece)];
  return column.on_event && column.event == (this->piece(piece).increasing ? e.low : e.high);
}
bool DirectionSlabs::ends_at(std::int32_t piece, const Column& column) const {
  const Extent& e = extent_[at(piece)];
  return column.on_event && column.event == (this->piece(piece).increasing ? e.high : e.low);
}

std::int32_t DirectionSlabs::along_at(const Point2& y, const Column& column, std::int64_t& probes) const {
  if (!column.on_event) return -1;
  const Point2& d = boundary_.direction();
  // Sign of y's place along d less that of an end.
  const auto order = [&](std::int32_t edge, bool end) {
    ++probes;
    return exact_sign([&]<class N>() {
      const auto x = boundary_.end_of<N>(boundary_.along()[at(edge)], end);
      return (N(y[0]) * N(d[0]) + N(y[1]) * N(d[1])) * x.w - (x.x * N(d[0]) + x.y * N(d[1]));
    });
  };
  std::int32_t low = along_begin_[at(column.event)], high = along_begin_[at(column.event) + 1];
  while (low < high) {
    const std::int32_t middle = low + (high - low) / 2, edge = along_[at(middle)];
    const int a = order(edge, false), b = order(edge, true);
    if (a == 0 || b == 0 || a != b) return edge;
    (a > 0 ? low : high) = a > 0 ? middle + 1 : middle;
  }
  return -1;
}

/// A copy of the path to a number, with or without it. @return the new root, -1 for an empty tree.
std::int32_t DirectionSlabs::with(std::int32_t root, std::int32_t number, bool present) {
  std::array<std::int32_t, 32> path;  // the nodes passed, -1 below an empty one
  std::size_t depth = 0;
  for (std::int32_t i = root, width = width_; width > 1; width /= 2) {
    path[depth++] = i;
    const bool right = (number & (width / 2)) != 0;
    i = i < 0 ? -1 : (right ? node_[at(i)].right : node_[at(i)].left);
  }
  std::int32_t below = -1;
  if (present) {
    below = static_cast<std::int32_t>(node_.size());
    node_.push_back({-1, -1, number});
  }
  for (std::int32_t width = 2; depth > 0; width *= 2) {
    const std::int32_t old = path[--depth];
    Node node = old < 0 ? Node{-1, -1, -1} : node_[at(old)];
    ((number & (width / 2)) != 0 ? node.right : node.left) = below;
    if (node.left < 0 && node.right < 0) {
      below = -1;
      continue;
    }
    node.last = node_[at(node.right >= 0 ? node.right : node.left)].last;
    below = static_cast<std::int32_t>(node_.size());
    node_.push_back(node);
  }
  return below;
}

std::size_t DirectionSlabs::memory_bytes() const {
  return event_.capacity() * sizeof(End) + extent_.capacity() * sizeof(Extent) +
         line_.capacity() * sizeof(Line2<Estimate>) + node_.capacity() * sizeof(Node) +
         root_.capacity() * sizeof(root_[0]) + boundary_.pieces().capacity() * sizeof(MonotonePiece) +
         (number_.capacity() + piece_numbered_.capacity() + along_begin_.capacity() + along_.capacity()) *
             sizeof(std::int32_t);
}

}  // namespace pd::detail
