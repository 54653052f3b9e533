#include "planar/boundary/convex_sum.hpp"

#include <algorithm>

namespace pd::detail {

NegatedChain::NegatedChain(std::vector<Point2> points)
    : points_(std::move(points)), size_(points_.size() == 1 ? 0 : static_cast<int>(points_.size())) {
  // -B's least vertex is B's greatest.
  const auto greatest = std::max_element(points_.begin(), points_.end());
  first_ = static_cast<int>(greatest - points_.begin());
  std::rotate(points_.begin(), greatest, points_.end());
  for (std::size_t k = 0; k < 4; ++k) {
    const auto by_coordinate = [k](const Point2& a, const Point2& b) { return a[k / 2] < b[k / 2]; };
    const auto found = k % 2 == 0 ? std::min_element(points_.begin(), points_.end(), by_coordinate)
                                  : std::max_element(points_.begin(), points_.end(), by_coordinate);
    extreme_[k] = static_cast<std::int32_t>(found - points_.begin());
  }
  points_.push_back(points_.front());
}

Box2 NegatedChain::box(int first, int count) const {
  Box2 box;
  if (size_ == 0) {
    box.add(point(0));
    return box;
  }
  box.add(point(first % size_));
  box.add(point((first + count) % size_));
  for (const std::int32_t k : extreme_) {
    if ((k - first % size_ + size_) % size_ <= count) box.add(point(k));
  }
  return box;
}

int NegatedChain::edges_before(const PlaneDirection& d) const {
  int low = 0, high = size_;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (compare_angles(edge(middle), d) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

ConvexSum::ConvexSum(const ConvexPart& part, const NegatedChain& chain) : part_(&part), chain_(&chain) {
  place_.reserve(static_cast<std::size_t>(part.size()));
  int fused = 0;
  for (int a = 0; a < part.size(); ++a) {
    const PlaneDirection d = part.edge(a);
    int before = chain.edges_before(d);
    bool parallel = before < chain.size() && compare_angles(chain.edge(before), d) == 0;
    if (parallel && a > 0 && compare_angles(part.edge(a - 1), d) == 0) {
      // The first edge of a straight side took the chain's edge, and this one follows.
      parallel = false;
      ++before;
    }
    place_.push_back({before + a - fused, fused, parallel});
    fused += parallel ? 1 : 0;
  }
  size_ = part.size() + chain.size() - fused;
}

ConvexSum::Parts ConvexSum::parts(int t) const {
  const auto found = std::lower_bound(place_.begin(), place_.end(), t,
                                      [](const InsertedEdge& e, int number) { return e.edge < number; });
  const auto a = static_cast<std::size_t>(found - place_.begin());
  const int b = t - static_cast<int>(a) + fused_before(a);
  const bool of_triangle = a < place_.size() && place_[a].edge == t;
  const bool of_chain = !of_triangle || place_[a].parallel;
  return {a == place_.size() ? 0 : static_cast<int>(a), b, of_triangle, of_chain};
}

SumPoint ConvexSum::vertex(int t) const {
  const Parts p = parts(t);
  return {corner(p.a), chain_->point(p.b)};
}

PlaneDirection ConvexSum::direction(int t) const {
  const Parts p = parts(t);
  return p.of_triangle ? part_->edge(p.a) : chain_->edge(p.b);
}

int ConvexSum::edges_before(const PlaneDirection& d) const {
  int low = 0, high = part_->size();
  while (low < high) {
    const int middle = (low + high) / 2;
    if (compare_angles(part_->edge(middle), d) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low + chain_->edges_before(d) - fused_before(static_cast<std::size_t>(low));
}

ConvexSum::Location ConvexSum::locate(const SumPoint& x) const {
  const SumPoint hub = vertex(0);
  if (side_of(hub, direction(0), x) <= 0) return {false, 0};
  if (side_of(vertex(size_ - 1), direction(size_ - 1), x) <= 0) return {false, size_ - 1};
  // x lies in the wedge at the hub: find the fan's triangle.
  int low = 1, high = size_ - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const SumPoint v = vertex(middle);
    const int side = exact_sign([&]<class N>() { return cross(from_to<N>(hub, v), from_to<N>(hub, x)); });
    (side >= 0 ? low : high) = middle;
  }
  return {side_of(vertex(low), direction(low), x) > 0, low};
}

bool ConvexSum::contains(const SumPoint& x) const {
  const SumPoint hub = vertex(0);
  if (side_of(hub, direction(0), x) < 0 || side_of(vertex(size_ - 1), direction(size_ - 1), x) < 0) return false;
  int low = 1, high = size_ - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const SumPoint v = vertex(middle);
    const int side = exact_sign([&]<class N>() { return cross(from_to<N>(hub, v), from_to<N>(hub, x)); });
    (side >= 0 ? low : high) = middle;
  }
  if (side_of(vertex(low), direction(low), x) < 0) return false;
  if (low > 1 || side_of(hub, direction(0), x) > 0) return true;
  // On the line of the first edge: between its ends, or on the ray past them. The wedge leaves the side behind the hub
  // out.
  return exact_sign([&]<class N>() { return dot(from_to<N>(hub, x), vector<N>(direction(0))); }) >= 0;
}

std::optional<ConvexSum::Cover> ConvexSum::cover_of_line(const Span& e) const {
  const auto wrap = [&](int t) { return t >= size_ ? t - size_ : t; };
  const int right = wrap(edges_before(e.d)), left = wrap(edges_before(e.d.reversed()));
  // The end of the straight side that begins with an edge.
  const auto end_of_side = [&](int first) {
    int t = wrap(first + 1);
    while (compare_angles(direction(t), direction(first)) == 0) t = wrap(t + 1);
    return t;
  };
  Cover r{Cover::Kind::inside, {}, {}, -1};
  const int right_side = side_of(e.s, e.d, vertex(right)), left_side = side_of(e.s, e.d, vertex(left));
  if (right_side >= 0) {
    if (right_side > 0 || compare_angles(direction(right), e.d) != 0) return std::nullopt;
    r = {Cover::Kind::same_edge,
         {Place::Kind::point, vertex(right), {}},
         {Place::Kind::point, vertex(end_of_side(right)), {}},
         right};
  } else if (left_side <= 0) {
    if (left_side < 0 || compare_angles(direction(left), e.d.reversed()) != 0) return std::nullopt;
    r = {Cover::Kind::opposite_edge,
         {Place::Kind::point, vertex(end_of_side(left)), {}},
         {Place::Kind::point, vertex(left), {}},
         left};
  } else {
    // The chain from the rightmost vertex to the leftmost one leaves the line's right side once: there the span goes
    // out.
    const auto last_where = [&](int first, int count, auto holds) {
      int low = 0, high = count;
      while (high - low > 1) {
        const int middle = (low + high) / 2;
        (holds(side_of(e.s, e.d, vertex(wrap(first + middle)))) ? low : high) = middle;
      }
      return wrap(first + low);
    };
    const int ahead = wrap(left - right + size_);
    const int out = last_where(right, ahead, [](int side) { return side <= 0; });
    const int in = last_where(left, size_ - ahead, [](int side) { return side > 0; });
    r.from = {Place::Kind::line, vertex(in), direction(in)};
    r.to = {Place::Kind::line, vertex(out), direction(out)};
  }
  return r;
}

std::optional<ConvexSum::Cover> ConvexSum::cover(const Span& e) const {
  std::optional<Cover> found = cover_of_line(e);
  if (!found) return std::nullopt;
  Cover& r = *found;
  const Place start{Place::Kind::start, {}, {}}, end{Place::Kind::end, {}, {}};
  if (compare_places(e, r.to, start) <= 0 || compare_places(e, r.from, end) >= 0) return std::nullopt;
  if (compare_places(e, r.from, start) <= 0) r.from = start;
  if (compare_places(e, r.to, end) >= 0) r.to = end;
  return found;
}

}  // namespace pd::detail
