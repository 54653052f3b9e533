#include "structure/bipartite/strip_tree.hpp"

#include <tuple>

namespace pd::detail {

namespace {

/// Of the leaves below a node of a complete tree with `size` leaves, the first and the last.
int first_leaf(int node, int size) {
  while (node < size) node *= 2;
  return node;
}
int last_leaf(int node, int size) {
  while (node < size) node = 2 * node + 1;
  return node;
}

}  // namespace

StripTree::StripTree(const std::vector<ChartLine>& lines, const std::vector<double>& xs) : lines_(&lines), xs_(&xs) {
  if (lines.empty() || xs.size() < 2) return;
  size_ = static_cast<int>(std::bit_ceil(static_cast<std::uint32_t>(xs.size() - 1)));
  nodes_.resize(2 * static_cast<std::size_t>(size_));

  struct Placed {
    std::int32_t node;
    bool loose;
    double height;
    std::int32_t line;
  };
  std::vector<Placed> placed;
  const auto rank_of = [&](double at) {
    return static_cast<int>(std::lower_bound(xs.begin(), xs.end(), at) - xs.begin());
  };
  const auto place = [&](std::int32_t number, double from, double to, bool loose) {
    int low = rank_of(from) + size_;
    int high = rank_of(to) + size_;
    const auto put = [&](int node) {
      const double middle = 0.5 * (x(first_leaf(node, size_) - size_) + x(last_leaf(node, size_) + 1 - size_));
      placed.push_back({node, loose, loose ? 0 : lines[static_cast<std::size_t>(number)].height(middle), number});
    };
    for (; low < high; low /= 2, high /= 2) {
      if (low & 1) put(low++);
      if (high & 1) put(--high);
    }
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const ChartLine& l = lines[i];
    const auto number = static_cast<std::int32_t>(i);
    if (l.orderly) {
      place(number, l.low(), l.inner_low(), true);
      place(number, l.inner_low(), l.inner_high(), false);
      place(number, l.inner_high(), l.high(), true);
    } else {
      place(number, l.low(), l.high(), true);
    }
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::tie(a.node, a.loose, a.height, a.line) < std::tie(b.node, b.loose, b.height, b.line);
  });
  entries_.reserve(placed.size());
  for (const Placed& p : placed) {
    Node& node = nodes_[static_cast<std::size_t>(p.node)];
    const auto at = static_cast<std::int32_t>(entries_.size());
    if (!node.has_content) node.first = node.loose = at;
    node.has_content = true;
    entries_.push_back(p.line);
    node.end = at + 1;
    if (p.loose) continue;
    node.loose = at + 1;
    node.error = std::max(node.error, lines[static_cast<std::size_t>(p.line)].error);
  }
  for (std::size_t node = nodes_.size() - 1; node > 1; --node) {
    if (nodes_[node].has_content) nodes_[node / 2].has_content = true;
  }
}

}  // namespace pd::detail
