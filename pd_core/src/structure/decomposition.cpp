#include "pd/structure/decomposition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "structure/bipartite/cube_charts.hpp"
#include "structure/bipartite/strip_tree.hpp"
#include "structure/overlay/arc_crossing.hpp"

namespace pd {

namespace {

using detail::ChartLine;
using detail::StripTree;

std::vector<ChartLine> lines_of(const std::vector<detail::ChartSegment>& chart) { return {chart.begin(), chart.end()}; }

std::vector<double> strip_borders(const std::vector<ChartLine>& a, const std::vector<ChartLine>& b) {
  std::vector<double> xs;
  xs.reserve(4 * (a.size() + b.size()));
  for (const std::vector<ChartLine>* lines : {&a, &b}) {
    for (const ChartLine& l : *lines) {
      xs.push_back(l.low());
      xs.push_back(l.high());
      if (!l.orderly) continue;
      xs.push_back(l.inner_low());
      xs.push_back(l.inner_high());
    }
  }
  std::sort(xs.begin(), xs.end());
  xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
  return xs;
}

/// Where two lines cross, for the order of the opposite set.
double crossing_abscissa(const ChartLine& line, const ChartLine& middle) {
  const double relative = line.slope - middle.slope;
  if (!line.orderly || !middle.orderly || relative == 0) return line.segment.x0;
  return line.segment.x0 + (middle.height(line.segment.x0) - line.segment.y0) / relative;
}

/// A canonical subset of one tree (entries first .. first + count) met by one line of the other body.
struct Meeting {
  std::int32_t first;
  std::int32_t count;
  std::int32_t query;
};

/// The arcs of one diagram that cross blocks of stored arcs of the other: block and arc, blocks together, in
/// `meetings`.
/// @param tried_by  memory
void find_meetings(const detail::OverlayWalk& walk, const StripTree& tree, const std::vector<ChartLine>& stored,
                   const std::vector<ChartLine>& asked, bool of_a, std::vector<Meeting>& meetings,
                   std::vector<std::int32_t>& tried_by) {
  meetings.clear();
  tried_by.assign(stored.size(), -1);
  for (std::size_t q = 0; q < asked.size(); ++q) {
    const std::int32_t edge = asked[q].segment.edge;
    const auto query = static_cast<std::int32_t>(q);
    tree.find_crossed(
        asked[q],
        [&](std::int32_t line) {
          // Where arcs run within rounding of each other, one answer serves every strip.
          if (std::exchange(tried_by[static_cast<std::size_t>(line)], query) == query) return false;
          const std::int32_t other = stored[static_cast<std::size_t>(line)].segment.edge;
          return detail::edge_crossing(walk, of_a ? other : edge, of_a ? edge : other).has_value();
        },
        [&](const StripTree::Block& block) {
          meetings.push_back({block.first, block.count, query});
        });
  }
  std::sort(meetings.begin(), meetings.end(), [](const Meeting& x, const Meeting& y) {
    return x.first != y.first ? x.first < y.first : x.count != y.count ? x.count < y.count : x.query < y.query;
  });
}

}  // namespace

Decomposition Decomposition::of(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                const Pose& pose_b) {
  const detail::FloatingPointGuard guard;
  Decomposition result;
  if (a.affine_dimension() < 2 && b.affine_dimension() < 2) return result;  // P is flat
  const detail::PosedPair pair(a, pose_a, b, pose_b);
  detail::OverlayBuffers buffers;
  const detail::OverlayWalk walk(pair, buffers);
  std::array<std::vector<detail::ChartSegment>, detail::kCharts> charts_a, charts_b;
  detail::clip_to_charts(pair, true, charts_a);
  detail::clip_to_charts(pair, false, charts_b);

  std::vector<Meeting> meetings;
  std::vector<std::int32_t> tried_by;
  std::vector<std::pair<double, std::int32_t>> opposite;
  for (std::size_t chart = 0; chart < detail::kCharts; ++chart) {
    const std::vector<ChartLine> lines_a = lines_of(charts_a[chart]);
    const std::vector<ChartLine> lines_b = lines_of(charts_b[chart]);
    if (lines_a.empty() || lines_b.empty()) continue;
    const std::vector<double> xs = strip_borders(lines_a, lines_b);
    for (const Family family : {Family::a, Family::b}) {
      const bool of_a = family == Family::a;
      const std::vector<ChartLine>& stored = of_a ? lines_a : lines_b;
      const std::vector<ChartLine>& asked = of_a ? lines_b : lines_a;
      const StripTree tree(stored, xs);
      find_meetings(walk, tree, stored, asked, of_a, meetings, tried_by);
      for (std::size_t begin = 0, end = 0; begin < meetings.size(); begin = end) {
        const Meeting block = meetings[begin];
        const auto edge_of = [&](std::int32_t entry) -> const ChartLine& {
          return stored[static_cast<std::size_t>(tree.entries()[static_cast<std::size_t>(entry)])];
        };
        const ChartLine& middle = edge_of(block.first + block.count / 2);
        opposite.clear();
        for (end = begin;
             end < meetings.size() && meetings[end].first == block.first && meetings[end].count == block.count; ++end) {
          const ChartLine& line = asked[static_cast<std::size_t>(meetings[end].query)];
          opposite.emplace_back(crossing_abscissa(line, middle), line.segment.edge);
        }
        std::sort(opposite.begin(), opposite.end());
        const auto put_canonical = [&] {
          for (std::int32_t k = 0; k < block.count; ++k) {
            result.edges_.push_back(edge_of(block.first + k).segment.edge);
          }
        };
        const auto count = static_cast<std::int32_t>(opposite.size());
        result.pairs_.push_back({static_cast<std::int64_t>(result.edges_.size()), of_a ? block.count : count,
                                 of_a ? count : block.count, family});
        if (of_a) put_canonical();
        for (const auto& [x, edge] : opposite) result.edges_.push_back(edge);
        if (!of_a) put_canonical();
      }
    }
  }
  return result;
}

Decomposition::Pair Decomposition::pair(int i) const {
  const StoredPair& p = pairs_[static_cast<std::size_t>(i)];
  const std::int32_t* const edges = edges_.data() + p.first;
  return {
      {edges, static_cast<std::size_t>(p.count_a)}, {edges + p.count_a, static_cast<std::size_t>(p.count_b)}, p.family};
}

std::int64_t Decomposition::sum_sizes() const { return static_cast<std::int64_t>(edges_.size()); }

std::int64_t Decomposition::sum_products() const {
  std::int64_t sum = 0;
  for (const StoredPair& p : pairs_) sum += static_cast<std::int64_t>(p.count_a) * p.count_b;
  return sum;
}

double Decomposition::closest_lines_work() const {
  double sum = 0;
  for (const StoredPair& p : pairs_) sum += std::pow(static_cast<double>(p.count_a) * p.count_b, 0.75);
  return sum;
}

std::vector<Decomposition::SizeClass> Decomposition::size_classes() const {
  std::array<std::array<SizeClass, 32>, 2> table{};
  for (const StoredPair& p : pairs_) {
    const bool of_a = p.family == Family::a;
    const auto canonical = static_cast<std::uint32_t>(of_a ? p.count_a : p.count_b);
    SizeClass& c = table[of_a ? 0 : 1][static_cast<std::size_t>(std::bit_width(canonical) - 1)];
    ++c.pairs;
    c.opposite_sum += of_a ? p.count_b : p.count_a;
  }
  std::vector<SizeClass> classes;
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t i = 0; i < table[side].size(); ++i) {
      if (table[side][i].pairs == 0) continue;
      classes.push_back({side == 0 ? Family::a : Family::b, static_cast<std::int32_t>(i), table[side][i].pairs,
                         table[side][i].opposite_sum});
    }
  }
  return classes;
}

}  // namespace pd
