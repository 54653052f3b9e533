#include "planar/skeleton.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pd::detail {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool negative(const DoubleDouble& a) { return a.hi < 0 || (a.hi == 0 && a.lo < 0); }

/// Which of a node's faces is neither of the two.
std::size_t third(const Skeleton::Node& node, int a, int b) {
  std::size_t k = 0;
  while (node.faces[k] == a || node.faces[k] == b) ++k;
  return k;
}

/// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

}  // namespace

Skeleton::Skeleton(std::vector<EdgeLine> lines, const std::vector<std::int32_t>& start) : lines_(std::move(lines)) {
  const int n = static_cast<int>(lines_.size());
  corner_.assign(lines_.size(), -1);
  for (int i = 0; i < n; ++i) {
    previous_.push_back(i == 0 ? n - 1 : i - 1);
    next_.push_back(i + 1 == n ? 0 : i + 1);
  }
  std::vector<std::int32_t> order;
  for (int i = 0; i < n; ++i) {
    if (!std::binary_search(start.begin(), start.end(), i)) order.push_back(i);
  }
  std::uint64_t state = 1990;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[next_random(state) % i]);
  // Off they come, each remembering its neighbours; and back in the reverse order.
  for (const std::int32_t i : order) {
    next_[index(previous_[index(i)])] = next_[index(i)];
    previous_[index(next_[index(i)])] = previous_[index(i)];
  }
  begin(start);
  for (std::size_t k = order.size(); k-- > 0;) insert(order[k]);
  compact();
}

Skeleton::Node Skeleton::centre(int a, int b, int c) const {
  // <n_k, x> + offset_k = r for the three: differences leave two equations for x.
  const EdgeLine &p = lines_[index(a)], &q = lines_[index(b)], &s = lines_[index(c)];
  const DoubleDouble ux = q.x - p.x, uy = q.y - p.y, u = p.offset - q.offset;
  const DoubleDouble vx = s.x - p.x, vy = s.y - p.y, v = p.offset - s.offset;
  const DoubleDouble determinant = ux * vy - uy * vx;
  Node node;
  node.x = (u * vy - uy * v) / determinant;
  node.y = (ux * v - u * vx) / determinant;
  node.radius = p.x * node.x + p.y * node.y + p.offset;
  node.faces = {a, b, c};
  node.links = {-1, -1, -1};
  return node;
}

bool Skeleton::hides(int edge, const Node& node) const {
  const EdgeLine& l = lines_[index(edge)];
  return negative(l.x * node.x + l.y * node.y + l.offset - node.radius);
}

int Skeleton::add(const Node& node) {
  ++work_;
  if (!free_.empty()) {
    const int at = free_.back();
    free_.pop_back();
    nodes_[index(at)] = node;
    dropped_[index(at)] = 0;
    return at;
  }
  nodes_.push_back(node);
  dropped_.push_back(0);
  return static_cast<int>(nodes_.size()) - 1;
}

void Skeleton::begin(const std::vector<std::int32_t>& start) {
  if (start.size() == 3) {
    const int node = add(centre(start[0], start[1], start[2]));
    for (const std::int32_t f : start) corner_[index(f)] = node;
    return;
  }
  // Of four, two opposite ones meet in the middle.
  const std::size_t shift = hides(start[3], centre(start[0], start[1], start[2])) ? 1 : 0;
  const auto edge = [&](std::size_t k) { return start[(k + shift) % 4]; };
  const int first = add(centre(edge(0), edge(1), edge(2))), second = add(centre(edge(2), edge(3), edge(0)));
  nodes_[index(first)].links[1] = second;
  nodes_[index(second)].links[1] = first;
  corner_[index(edge(0))] = corner_[index(edge(1))] = first;
  corner_[index(edge(2))] = corner_[index(edge(3))] = second;
}

/// The edge takes a cell off the corner between its neighbours: the nodes nearer to it than to their own edges go, a
/// connected part of the tree at that corner; where a bisector leaves the part a new node stands, and these in order
/// are the boundary of the cell.
void Skeleton::insert(int edge) {
  const int before = previous_[index(edge)], after = next_[index(edge)];
  struct Bisector {
    int left, right;  ///< its two edges, as seen from the new cell
    int node;         ///< beyond; -1: a corner
  };
  std::vector<Bisector> open{{before, after, corner_[index(before)]}};
  std::vector<std::int32_t> boundary, gone;
  while (!open.empty()) {
    const Bisector b = open.back();
    open.pop_back();
    if (b.node >= 0 && hides(edge, nodes_[index(b.node)])) {
      const Node& node = nodes_[index(b.node)];
      const std::size_t opposite = third(node, b.left, b.right);
      const int top = node.faces[opposite];
      ++work_;
      gone.push_back(b.node);
      open.push_back({top, b.right, node.links[third(node, top, b.right)]});
      open.push_back({b.left, top, node.links[third(node, b.left, top)]});
      continue;
    }
    Node node = centre(b.left, edge, b.right);
    node.links[1] = b.node;
    const int at = add(node);
    if (b.node >= 0) {
      Node& beyond = nodes_[index(b.node)];
      beyond.links[third(beyond, b.left, b.right)] = at;
    } else if (!boundary.empty() || b.left != before || b.right != after) {
      corner_[index(next_[index(b.left)] == b.right ? b.left : b.right)] = at;
    }
    if (!boundary.empty()) {
      nodes_[index(boundary.back())].links[0] = at;
      nodes_[index(at)].links[2] = boundary.back();
    }
    boundary.push_back(at);
  }
  next_[index(before)] = previous_[index(after)] = edge;
  corner_[index(before)] = boundary.front();
  corner_[index(edge)] = boundary.back();
  for (const std::int32_t g : gone) {
    dropped_[index(g)] = 1;
    free_.push_back(g);
  }
}

/// Closes the gaps that dropped nodes left.
void Skeleton::compact() {
  std::vector<std::int32_t> place(nodes_.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (!dropped_[i]) place[i] = count++;
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (dropped_[i]) continue;
    Node node = nodes_[i];
    for (std::int32_t& link : node.links) link = link < 0 ? -1 : place[index(link)];
    nodes_[index(place[i])] = node;
  }
  nodes_.resize(index(count));
  for (std::int32_t& c : corner_) c = place[index(c)];
}

}  // namespace pd::detail
