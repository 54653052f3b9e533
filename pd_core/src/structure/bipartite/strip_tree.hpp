/// @file
/// The segment trees of [A] section 2.2: one chart's arcs of one body, stored by the vertical strips that they cross,
/// and asked for the stacks that another arc cuts.
///
/// A node is a strip between two of the sorted x-coordinates (those of both bodies: the trees T_A and T_B of a chart
/// share their strips). A segment is stored at the canonical nodes of its x-interval, each node's stack sorted by
/// height. A query reports a crossed stretch of a stack as O(log) canonical subsets, aligned blocks of 2^k.
///
/// Coordinates are doubles that err by kChartError, so the tree tells three cases apart: stretches that are crossed for
/// certain, elements that are missed for certain, and the few between, which the caller decides exactly. A segment's
/// ends, and segments too short or too steep to be ordered, are such elements throughout: stored as "loose", and tried
/// one by one.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "structure/bipartite/cube_charts.hpp"

namespace pd::detail {

/// A chart segment as a line over an interval.
struct ChartLine {
  static constexpr double kMargin = 4 * kChartError;
  static constexpr double kSteepest = 0x1p20;

  explicit ChartLine(const ChartSegment& s)
      : segment(s),
        orderly(s.x1 - s.x0 > 16 * kMargin && std::abs(s.y1 - s.y0) < kSteepest * (s.x1 - s.x0)),
        slope(orderly ? (s.y1 - s.y0) / (s.x1 - s.x0) : 0),
        error(16 * kChartError * (1 + std::abs(slope))) {}

  /// The true arc lies inside [low(), high()], and covers [inner_low(), inner_high()].
  [[nodiscard]] double low() const { return segment.x0 - kMargin; }
  [[nodiscard]] double high() const { return segment.x1 + kMargin; }
  [[nodiscard]] double inner_low() const { return segment.x0 + kMargin; }
  [[nodiscard]] double inner_high() const { return segment.x1 - kMargin; }
  /// Height of the line, within `error` of the true one from low() to high(). Requires `orderly`.
  [[nodiscard]] double height(double x) const { return segment.y0 + (x - segment.x0) * slope; }
  [[nodiscard]] double bottom() const { return std::min(segment.y0, segment.y1) - kMargin; }
  [[nodiscard]] double top() const { return std::max(segment.y0, segment.y1) + kMargin; }

  ChartSegment segment;
  bool orderly;  ///< long and flat enough to be ordered by height
  double slope;
  double error;
};

class StripTree {
 public:
  /// A canonical subset: `count` consecutive lines of the list `entries()`.
  struct Block {
    std::int32_t first;
    std::int32_t count;
  };

  /// Every line's low, high and inner ends must be among `xs` (sorted, no two equal).
  StripTree(const std::vector<ChartLine>& lines, const std::vector<double>& xs);

  /// Line numbers, node by node; stacks in the order of height.
  [[nodiscard]] const std::vector<std::int32_t>& entries() const { return entries_; }

  /// Visits the nodes of which the parent's strip holds an end of `query` (its own subtree is searched in the other
  /// role elsewhere), and reports the crossed blocks. `crosses(line)` decides an uncertain element exactly.
  template <class Crosses, class Report>
  void find_crossed(const ChartLine& query, Crosses&& crosses, Report&& report) const {
    if (size_ > 0) visit(1, 0, size_, query, crosses, report);
  }

 private:
  struct Node {
    std::int32_t first = 0;    ///< of the stack in `entries_`
    std::int32_t loose = 0;    ///< end of the stack, begin of the loose elements
    std::int32_t end = 0;      ///< of those
    double error = 0;          ///< largest of the stack
    bool has_content = false;  ///< in the subtree
  };

  [[nodiscard]] double x(int rank) const {
    return (*xs_)[static_cast<std::size_t>(std::min(rank, static_cast<int>(xs_->size()) - 1))];
  }
  [[nodiscard]] const ChartLine& line(int entry) const {
    return (*lines_)[static_cast<std::size_t>(entries_[static_cast<std::size_t>(entry)])];
  }

  template <class Crosses, class Report>
  void visit(int node, int low, int high, const ChartLine& query, Crosses& crosses, Report& report) const {
    const Node& here = nodes_[static_cast<std::size_t>(node)];
    if (!here.has_content || low + 1 >= static_cast<int>(xs_->size())) return;
    const double left = x(low);
    const double right = x(high);
    if (query.high() < left || query.low() > right) return;
    if (here.first < here.loose) search_stack(here, left, right, query, crosses, report);
    for (int k = here.loose; k < here.end; ++k) {
      if (may_meet(query, line(k), left, right) && crosses(entries_[static_cast<std::size_t>(k)])) report(Block{k, 1});
    }
    if (high - low == 1 || (query.inner_low() <= left && query.inner_high() >= right)) return;
    const int middle = (low + high) / 2;
    visit(2 * node, low, middle, query, crosses, report);
    visit(2 * node + 1, middle, high, query, crosses, report);
  }

  /// Whether two lines come within their errors of each other inside a strip.
  static bool may_meet(const ChartLine& p, const ChartLine& q, double left, double right) {
    const double from = std::max({left, p.low(), q.low()});
    const double to = std::min({right, p.high(), q.high()});
    if (from > to) return false;
    const double slack = p.error + q.error;
    if (p.orderly && q.orderly) {
      const double a = p.height(from) - q.height(from);
      const double b = p.height(to) - q.height(to);
      return !(std::min(a, b) > slack || std::max(a, b) < -slack);
    }
    const auto low = [&](const ChartLine& l) {
      return l.orderly ? std::min(l.height(from), l.height(to)) : l.bottom();
    };
    const auto high = [&](const ChartLine& l) { return l.orderly ? std::max(l.height(from), l.height(to)) : l.top(); };
    return low(p) <= high(q) + slack && low(q) <= high(p) + slack;
  }

  /// First element of the stack at or above a height.
  [[nodiscard]] int rank(const Node& node, double at, double height) const {
    const auto begin = entries_.begin() + node.first;
    const auto end = entries_.begin() + node.loose;
    return static_cast<int>(
        std::partition_point(
            begin, end, [&](std::int32_t e) { return (*lines_)[static_cast<std::size_t>(e)].height(at) < height; }) -
        entries_.begin());
  }

  template <class Crosses, class Report>
  void search_stack(const Node& node, double left, double right, const ChartLine& query, Crosses& crosses,
                    Report& report) const {
    // Stacks are in true order up to their elements' error, and lines of one diagram do not cross: between two
    // neighbours out of order the gap is below two errors all over the strip.
    const double slack = 4 * node.error + 2 * query.error;
    const double from = std::max(left, query.low());
    const double to = std::min(right, query.high());
    int first = 0;
    int last = 0;
    int sure_first = 0;
    int sure_last = 0;
    if (!query.orderly) {
      first = std::min(rank(node, from, query.bottom() - slack), rank(node, to, query.bottom() - slack));
      last = std::max(rank(node, from, query.top() + slack), rank(node, to, query.top() + slack));
      sure_first = sure_last = last;
    } else {
      const double height_from = query.height(from);
      const double height_to = query.height(to);
      first = std::min(rank(node, from, height_from - slack), rank(node, to, height_to - slack));
      last = std::max(rank(node, from, height_from + slack), rank(node, to, height_to + slack));
      if (first >= last) return;
      sure_first = sure_last = last;
      const double inner_from = std::max(left, query.inner_low());
      const double inner_to = std::min(right, query.inner_high());
      if (inner_from < inner_to) {
        const double a = query.height(inner_from);
        const double b = query.height(inner_to);
        // Above at one end, below at the other.
        const int above_a = rank(node, inner_from, a + slack);
        const int below_b = rank(node, inner_to, b - slack);
        const int above_b = rank(node, inner_to, b + slack);
        const int below_a = rank(node, inner_from, a - slack);
        if (above_a < below_b) {
          sure_first = above_a;
          sure_last = below_b;
        } else if (above_b < below_a) {
          sure_first = above_b;
          sure_last = below_a;
        }
      }
    }
    for (int k = first; k < last; ++k) {
      if (k == sure_first && sure_first < sure_last) {
        report_canonical(node, sure_first, sure_last, report);
        k = sure_last - 1;
        continue;
      }
      if (crosses(entries_[static_cast<std::size_t>(k)])) report(Block{k, 1});
    }
  }

  /// Aligned blocks of 2^k, counted from the stack's beginning: the nodes of a balanced tree over it.
  template <class Report>
  static void report_canonical(const Node& node, int first, int last, Report& report) {
    auto at = static_cast<std::uint32_t>(first - node.first);
    const auto end = static_cast<std::uint32_t>(last - node.first);
    while (at < end) {
      const std::uint32_t aligned = at == 0 ? std::numeric_limits<std::uint32_t>::max() : at & (~at + 1);
      const std::uint32_t count = std::min(aligned, std::bit_floor(end - at));
      report(Block{node.first + static_cast<std::int32_t>(at), static_cast<std::int32_t>(count)});
      at += count;
    }
  }

  const std::vector<ChartLine>* lines_;
  const std::vector<double>* xs_;
  int size_ = 0;  ///< leaves, a power of two; 0 when the tree is empty
  std::vector<Node> nodes_;
  std::vector<std::int32_t> entries_;
};

}  // namespace pd::detail
