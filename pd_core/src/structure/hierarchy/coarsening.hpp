/// @file
/// A triangulated convex surface that loses independent vertices of small degree, one step after another: the machine
/// behind both kinds of polyhedral hierarchies.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "pd/structure/polyhedral_hierarchy.hpp"
#include "structure/hierarchy/surface_spaces.hpp"

namespace pd::detail {

template <class Space>
class Coarsening {
 public:
  using Star = PolyhedralHierarchy::Star;

  struct Step {
    int removed = 0;
    std::int32_t max_degree = 0;
  };

  explicit Coarsening(const Space& space)
      : space_(space),
        first_(static_cast<std::size_t>(space.size()), -1),
        degree_(static_cast<std::size_t>(space.size()), 0) {
    faces_ = space.triangles();
    creators_.assign(faces_.size(), -1);
    set_rings();
    alive_.assign(first_.size(), 1);
    blocked_.assign(first_.size(), 0);
    for (int v = 0; v < space.size(); ++v) present_.push_back(v);
    count_ = space.size();
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool alive(int v) const { return alive_[index(v)] != 0; }
  /// Neighbours of v, counter-clockwise, each with the triangle between it and the next; until the next call.
  [[nodiscard]] const std::vector<Star>& ring(int v) const {
    ring_.clear();
    ring_nodes_.clear();
    for (std::int32_t n = first_[index(v)]; static_cast<int>(ring_.size()) < degree_[index(v)]; n = node(n).next) {
      ring_.push_back(node(n).star);
      ring_nodes_.push_back(n);
    }
    return ring_;
  }
  /// Every triangle that was ever there, and the vertex whose removal created it (-1: none).
  [[nodiscard]] std::vector<Triangle>& faces() { return faces_; }
  [[nodiscard]] std::vector<std::int32_t>& creators() { return creators_; }

  /// Facets with coplanar triangles united.
  [[nodiscard]] int count_facets() const {
    int edges = 0;
    for (const std::int32_t v : present_) {
      const auto& r = ring(v);
      for (std::size_t i = 0; i < r.size(); ++i) {
        // The edge v r[i] with its two triangles' other corners.
        const std::size_t next = (i + 1) % r.size(), previous = (i + r.size() - 1) % r.size();
        if (v < r[i].neighbour && space_.side(v, r[i].neighbour, r[next].neighbour, r[previous].neighbour) != 0) {
          ++edges;
        }
      }
    }
    return edges + 2 - count_;  // Euler
  }

  /// Takes out an independent set of vertices of degree up to kMaxDegree, small degrees first; an empty one at the end.
  /// `visit(v, ring)` sees each before it goes.
  template <class Visit>
  Step step(Visit&& visit) {
    Step step;
    for (const std::int32_t v : present_) blocked_[index(v)] = 0;
    for (int degree = 3; degree <= PolyhedralHierarchy::kMaxDegree; ++degree) {
      for (const std::int32_t v : present_) {
        if (!alive(v) || blocked_[index(v)] != 0 || degree_[index(v)] != degree) continue;
        if (count_ <= 4 || !fill_hole(v)) continue;
        visit(v, ring_);
        for (const Star& s : ring_) blocked_[index(s.neighbour)] = 1;
        remove(v);
        ++step.removed;
        step.max_degree = std::max(step.max_degree, degree);
      }
    }
    std::erase_if(present_, [&](std::int32_t v) { return !alive(v); });
    return step;
  }

 private:
  static std::size_t index(int v) { return static_cast<std::size_t>(v); }

  /// A neighbour in a ring. Rings are linked, so that one of very many neighbours (a prism's floor) loses one in O(1).
  struct Node {
    Star star;
    std::int32_t next, previous;
    std::int32_t twin;  ///< the vertex in its neighbour's ring
  };

  [[nodiscard]] const Node& node(std::int32_t n) const { return nodes_[index(n)]; }
  [[nodiscard]] Node& node(std::int32_t n) { return nodes_[index(n)]; }

  void set_rings() {
    struct Link {
      std::int32_t from, to, face, node;
    };
    // Of each vertex the sides of its triangles that face it, linked to a cycle.
    std::vector<std::vector<Link>> links(first_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Triangle& t = faces_[f];
      for (std::size_t i = 0; i < 3; ++i) {
        links[index(t[i])].push_back({t[(i + 1) % 3], t[(i + 2) % 3], static_cast<std::int32_t>(f), -1});
      }
    }
    nodes_.reserve(3 * faces_.size());
    const auto before = [](const Link& x, const Link& y) { return x.from < y.from; };
    const auto find = [&](std::size_t v, std::int32_t neighbour) -> Link& {
      return *std::lower_bound(links[v].begin(), links[v].end(), Link{neighbour, 0, 0, 0}, before);
    };
    for (std::size_t v = 0; v < first_.size(); ++v) {
      auto& link = links[v];
      std::sort(link.begin(), link.end(), before);
      std::int32_t at = link.front().from;
      first_[v] = static_cast<std::int32_t>(nodes_.size());
      do {
        Link& l = find(v, at);
        l.node = static_cast<std::int32_t>(nodes_.size());
        nodes_.push_back({{at, l.face}, l.node + 1, l.node - 1, -1});
        ++degree_[v];
        at = l.to;
      } while (at != link.front().from);
      nodes_.back().next = first_[v];
      node(first_[v]).previous = static_cast<std::int32_t>(nodes_.size()) - 1;
    }
    for (std::size_t v = 0; v < first_.size(); ++v) {
      for (const Link& l : links[v]) node(l.node).twin = find(index(l.from), static_cast<std::int32_t>(v)).node;
    }
  }

  /// The triangles that close the hole of v, by indices into its ring; false where the rest would be flat or unbounded.
  bool fill_hole(int v) {
    const auto& r = ring(v);
    const int d = static_cast<int>(r.size());
    filling_.clear();
    // Only the apex of a pyramid is joined to all others, and leaves a polygon behind.
    if (d == count_ - 1) {
      bool flat = true;
      for (int i = 3; i < d; ++i) {
        flat = flat && space_.side(r[0].neighbour, r[1].neighbour, r[2].neighbour, r[index(i)].neighbour) == 0;
      }
      if (flat) return false;
    }
    return fill(r, 0, d - 1);
  }

  /// Fills the polygon of ring vertices i..j over the edge that joins its ends: the triangle on that edge is the one
  /// with no other corner above it.
  bool fill(const std::vector<Star>& r, int i, int j) {
    if (j - i < 2) return true;
    const auto at = [&](int k) { return r[index(k)].neighbour; };
    int apex = i + 1;
    for (int k = i + 2; k < j; ++k) {
      if (space_.side(at(i), at(apex), at(j), at(k)) > 0) apex = k;
    }
    if (!space_.faces_centre(at(i), at(apex), at(j))) return false;
    filling_.push_back({i, apex, j});
    return fill(r, i, apex) && fill(r, apex, j);
  }

  /// The filling triangle with these three corners (indices into the ring, any order).
  [[nodiscard]] std::int32_t filling_face(int i, int j, int k) const {
    std::array<int, 3> corners{i, j, k};
    std::sort(corners.begin(), corners.end());
    const auto found = std::find(filling_.begin(), filling_.end(), corners);
    assert(found != filling_.end());
    return static_cast<std::int32_t>(faces_.size() - filling_.size()) +
           static_cast<std::int32_t>(found - filling_.begin());
  }

  /// Takes v out, whose ring was asked for last. O(1) for its bounded degree, whatever those of its neighbours are.
  void remove(int v) {
    const std::vector<Star>& r = ring_;
    const int d = static_cast<int>(r.size());
    for (const auto& [i, apex, j] : filling_) {
      faces_.push_back({r[index(i)].neighbour, r[index(apex)].neighbour, r[index(j)].neighbour});
      creators_.push_back(v);
    }
    for (auto& row : diagonals_) row.fill(-1);
    for (int i = 0; i < d; ++i) {
      // In the ring of r[i] stand r[i + 1], v, r[i - 1]: v gives way to the diagonals from r[i], in the order of r.
      fan_.assign(1, i + 1);
      for (const auto& t : filling_) {
        for (const int corner : t) {
          const int other = corner > i ? corner : corner + d;
          const bool mine = t[0] == i || t[1] == i || t[2] == i;
          if (mine && corner != i && other != i + 1 && other != i + d - 1) fan_.push_back(other);
        }
      }
      fan_.push_back(i + d - 1);
      std::sort(fan_.begin(), fan_.end());
      fan_.erase(std::unique(fan_.begin(), fan_.end()), fan_.end());
      replace(node(ring_nodes_[index(i)]).twin, i);
    }
    free_.insert(free_.end(), ring_nodes_.begin(), ring_nodes_.end());
    alive_[index(v)] = 0;
    --count_;
  }

  /// In the ring of r[i], for r the ring asked for last, the fan takes the place of `gone`.
  void replace(std::int32_t gone, int i) {
    const int d = static_cast<int>(ring_.size());
    const auto face = [&](std::size_t k) { return filling_face(i, fan_[k] % d, fan_[k + 1] % d); };
    const std::int32_t after = node(gone).next;
    std::int32_t last = node(gone).previous, first = after;
    node(last).star.face = face(0);
    for (std::size_t k = 1; k + 1 < fan_.size(); ++k) {
      const int other = fan_[k] % d;
      const std::int32_t added = new_node();
      const std::int32_t twin = diagonals_[index(other)][index(i)];
      node(added) = {{ring_[index(other)].neighbour, face(k)}, after, last, twin};
      diagonals_[index(i)][index(other)] = added;
      if (twin >= 0) node(twin).twin = added;
      node(last).next = added;
      if (k == 1) first = added;
      last = added;
    }
    node(last).next = after;
    node(after).previous = last;
    const std::size_t vertex = index(ring_[index(i)].neighbour);
    if (first_[vertex] == gone) first_[vertex] = first;
    degree_[vertex] += static_cast<int>(fan_.size()) - 3;
    free_.push_back(gone);
  }

  std::int32_t new_node() {
    if (free_.empty()) {
      nodes_.emplace_back();
      return static_cast<std::int32_t>(nodes_.size()) - 1;
    }
    const std::int32_t n = free_.back();
    free_.pop_back();
    return n;
  }

  const Space& space_;
  std::vector<std::int32_t> first_;  ///< by vertex: a node of its ring
  std::vector<int> degree_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> free_;  ///< nodes to use again
  std::vector<Triangle> faces_;
  std::vector<std::int32_t> creators_;
  std::vector<char> alive_;
  std::vector<char> blocked_;
  std::vector<std::int32_t> present_;  ///< alive at the beginning of a step, ascending
  std::vector<std::array<int, 3>> filling_;
  std::vector<int> fan_;                          ///< buffer of `remove`
  mutable std::vector<Star> ring_;                ///< the ring asked for last
  mutable std::vector<std::int32_t> ring_nodes_;  ///< and its nodes
  /// By two corners of the ring: the first one's node of the diagonal between them.
  std::array<std::array<std::int32_t, PolyhedralHierarchy::kMaxDegree>, PolyhedralHierarchy::kMaxDegree> diagonals_{};
  int count_ = 0;
};

}  // namespace pd::detail
