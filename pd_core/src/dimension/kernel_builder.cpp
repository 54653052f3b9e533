#include "dimension/kernel_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dimension/joggle.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

constexpr std::size_t kFirstBlock = 4096;
constexpr std::size_t kLastBlock = 65536;
constexpr double kMostCells = 2e5;
/// A survey of all cells costs about as much as this many searches for a point's cone in each.
constexpr std::int64_t kSearchesACell = 4;
/// From d = 4 on a cell meets dozens of cones, and its survey costs more than it saves (measured on 1e6 points).
constexpr int kMostSurveyed = 3;

/// 1 / (1 - epsilon) with room for the roundings of gauges.
double limit_of(double epsilon) { return 1 / (1 - std::max(epsilon, kLeastEpsilon) * (1 - 1e-4)); }

/// Inside the unit ball shrunk by the limit, so that no vertex of the start is a vertex of conv(kernel): the hull of
/// both, blown up by the limit, holds the unit ball.
double start_radius(double epsilon) { return 0.5 * (1 - epsilon); }

double cells_of(double epsilon, int dimension) {
  return std::min(kMostCells, 64 + 4 * std::pow(std::max(epsilon, kLeastEpsilon), -0.5 * (dimension - 1)));
}

}  // namespace

KernelBuilder::KernelBuilder(const AnyMap& to_unit, double epsilon)
    : to_unit_(to_unit),
      centre_(-(inverse_of<kAnyDimension>(to_unit.linear) * to_unit.translation)),
      limit_(limit_of(epsilon)),
      hull_(static_cast<int>(centre_.size()), start_radius(epsilon)),
      cells_(hull_.dimension(), cells_of(epsilon, hull_.dimension())),
      hints_(static_cast<std::size_t>(cells_.size()), 0),
      reach_(cells_),
      next_block_(kFirstBlock) {}

void KernelBuilder::add(Points chunk, std::int64_t index) {
  while (!chunk.empty()) {
    const std::size_t size = std::min(next_block_, chunk.size());
    add_block(chunk.part(0, size), index);
    chunk = chunk.part(size, chunk.size() - size);
    index += static_cast<std::int64_t>(size);
    next_block_ = std::min(2 * next_block_, kLastBlock);
  }
}

/// Bounds that spare points their search, where the block or the searches so far are worth their price.
void KernelBuilder::prepare_block(std::size_t size) {
  const bool worth = located_ > patience_ * kSearchesACell * cells_.size();
  if (worth || hull_.facets().size() < size) {
    // The gauge is at most |p| over the nearest plane's distance.
    const double near = limit_ * hull_.inner_radius() * (1 - 1e-9);
    near_squared_ = near * near;
  }
  if (!worth) return;
  if (hull_.dimension() <= kMostSurveyed) {
    // Where every cell has a facet that a few points more would split, as on spheres, bounds spare next to none.
    patience_ = spared_ < located_ ? 4 * patience_ : 1;
    reach_.survey(hull_, limit_, hints_, cones_visited_);
  }
  located_ = spared_ = 0;
}

/// Cell by cell, so that neighbours walk over the same facets while the nearest cache holds them.
void KernelBuilder::sort_candidates() {
  cell_begin_.assign(static_cast<std::size_t>(cells_.size()) + 1, 0);
  for (const Candidate& c : candidates_) ++cell_begin_[static_cast<std::size_t>(c.cell) + 1];
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
  order_.resize(candidates_.size());
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    order_[static_cast<std::size_t>(cell_begin_[static_cast<std::size_t>(candidates_[k].cell)]++)] =
        static_cast<std::int32_t>(k);
  }
}

void KernelBuilder::add_block(const Points& block, std::int64_t index) {
  prepare_block(block.size());
  lists_.resize(hull_.facets().size());
  candidates_.clear();
  for (std::size_t i = 0; i < block.size(); ++i) {
    const AnyVector unit = in_frame(to_unit_.linear, centre_, block.data(i));
    if (unit.squaredNorm() <= near_squared_) continue;
    const DirectionCells::Place place = cells_.place(unit);
    if (reach_.holds(place, unit)) {
      ++spared_;
      continue;
    }
    candidates_.push_back({unit, place.cell, static_cast<std::int32_t>(i)});
  }
  sort_candidates();
  located_ += static_cast<std::int64_t>(candidates_.size());
  // The order jumps about in the block: what comes is fetched while what is there is searched.
  constexpr std::size_t kAhead = 8;
  const auto candidate = [&](std::size_t n) -> const Candidate& {
    return candidates_[static_cast<std::size_t>(order_[n])];
  };
  for (std::size_t n = 0; n < order_.size(); ++n) {
    if (n + kAhead < order_.size()) {
      __builtin_prefetch(&candidate(n + kAhead));
      hull_.prefetch(hints_[static_cast<std::size_t>(candidate(n + kAhead / 2).cell)]);
    }
    const Candidate& c = candidate(n);
    std::int32_t& hint = hints_[static_cast<std::size_t>(c.cell)];
    hint = hull_.locate(c.unit, hint, cones_visited_);
    if (hull_.gauge(hint, c.unit) <= limit_) continue;
    waiting_.push_back({block[static_cast<std::size_t>(c.place)], c.unit, index + c.place});
    next_.push_back(-1);
    assign(static_cast<std::int32_t>(waiting_.size()) - 1, hint);
  }
  drain();
  waiting_.clear();
  next_.clear();
  if (static_cast<std::int64_t>(hull_.facets().size()) > 2 * hull_.num_facets()) {
    const std::vector<std::int32_t> renumbered = hull_.compact();
    for (std::int32_t& hint : hints_) hint = renumbered[static_cast<std::size_t>(hint)];
    lists_.clear();
  }
}

/// Puts waiting point i into the list of its cone, or drops it.
void KernelBuilder::assign(std::int32_t i, std::int32_t start) {
  const AnyVector& unit = waiting_[i].unit;
  const std::int32_t f = hull_.locate(unit, start, cones_visited_);
  const double gauge = hull_.gauge(f, unit);
  if (gauge <= limit_) return;
  List& list = lists_[f];
  next_[i] = list.head;
  list.head = i;
  if (list.farthest < 0 || gauge > list.gauge ||
      (gauge == list.gauge && waiting_[i].index < waiting_[list.farthest].index)) {
    list.farthest = i;
    list.gauge = gauge;
    // A point on a ridge may go to a facet beside those that an insertion made: every list is queued where it grows.
    heap_.push_back({gauge, f});
    std::push_heap(heap_.begin(), heap_.end());
  }
}

/// Inserts the farthest point of all, again and again, until no list is left.
void KernelBuilder::drain() {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Waiting top = heap_.back();
    heap_.pop_back();
    if (!hull_.alive(top.facet) || lists_[top.facet].head < 0) continue;
    const std::int32_t chosen = lists_[top.facet].farthest;
    const bool entered = enter(waiting_[chosen], top.facet);
    lists_.resize(hull_.facets().size());
    if (!entered) {
      // It joins the kernel without a place in the hull; the rest of its list tries on.
      List list;
      std::swap(list, lists_[static_cast<std::size_t>(top.facet)]);
      for (std::int32_t i = list.head; i >= 0;) {
        const std::int32_t after = next_[i];
        if (i != chosen) assign(i, top.facet);
        i = after;
      }
      continue;
    }
    for (const std::int32_t f : hull_.removed()) {
      const std::int32_t head = lists_[f].head;
      lists_[f] = {};
      for (std::int32_t i = head; i >= 0;) {
        const std::int32_t after = next_[i];
        if (i != chosen) assign(i, f);
        i = after;
      }
    }
  }
}

/// A point that rounding keeps out of the hull enters a little nearer to the origin, which is a point of conv(kernel),
/// too. False when even that fails.
bool KernelBuilder::enter(const Point& p, std::int32_t f) {
  const auto id = static_cast<std::int32_t>(kernel_.size());
  kernel_.push_back(p);
  const double nearer = joggle(hull_.dimension(), p.index, limit_);
  for (const double shrink : {0.0, 0x1p-36, 0x1p-30}) {
    const AnyVector at = (1 - shrink - nearer) * p.unit;
    if (!hull_.insert(at, f)) continue;
    vertex_owner_.push_back(id);
    return true;
  }
  unplaced_.push_back(id);
  return false;
}

std::vector<KernelBuilder::Point> KernelBuilder::chosen() const {
  std::vector<char> used(kernel_.size(), 0);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(hull_.facets().size()); ++f) {
    if (!hull_.alive(f)) continue;
    for (const std::int32_t v : hull_.vertices_of(f)) {
      if (kernel_of_vertex(v) >= 0) used[static_cast<std::size_t>(kernel_of_vertex(v))] = 1;
    }
  }
  for (const std::int32_t i : unplaced_) used[i] = 1;
  std::vector<Point> r;
  for (std::size_t i = 0; i < kernel_.size(); ++i) {
    if (used[i] != 0) r.push_back(kernel_[i]);
  }
  std::sort(r.begin(), r.end(), [](const Point& a, const Point& b) { return a.index < b.index; });
  return r;
}

}  // namespace pd::dimension::detail
