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

  explicit Coarsening(const Space& space) : space_(space), rings_(static_cast<std::size_t>(space.size())) {
    faces_ = space.triangles();
    creators_.assign(faces_.size(), -1);
    set_rings();
    alive_.assign(rings_.size(), 1);
    blocked_.assign(rings_.size(), 0);
    for (int v = 0; v < space.size(); ++v) present_.push_back(v);
    count_ = space.size();
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool alive(int v) const { return alive_[index(v)] != 0; }
  /// Neighbours of v, counter-clockwise, each with the triangle between it and the next.
  [[nodiscard]] const std::vector<Star>& ring(int v) const { return rings_[index(v)]; }
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
        if (!alive(v) || blocked_[index(v)] != 0 || static_cast<int>(ring(v).size()) != degree) continue;
        if (count_ <= 4 || !fill_hole(v)) continue;
        visit(v, ring(v));
        for (const Star& s : ring(v)) blocked_[index(s.neighbour)] = 1;
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

  void set_rings() {
    struct Link {
      std::int32_t from, to, face;
    };
    // Of each vertex the sides of its triangles that face it, linked to a cycle.
    std::vector<std::vector<Link>> links(rings_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Triangle& t = faces_[f];
      for (std::size_t i = 0; i < 3; ++i) {
        links[index(t[i])].push_back({t[(i + 1) % 3], t[(i + 2) % 3], static_cast<std::int32_t>(f)});
      }
    }
    const auto before = [](const Link& x, const Link& y) { return x.from < y.from; };
    for (std::size_t v = 0; v < rings_.size(); ++v) {
      auto& link = links[v];
      std::sort(link.begin(), link.end(), before);
      std::int32_t at = link.front().from;
      do {
        const Link& l = *std::lower_bound(link.begin(), link.end(), Link{at, 0, 0}, before);
        rings_[v].push_back({at, l.face});
        at = l.to;
      } while (at != link.front().from);
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

  void remove(int v) {
    const std::vector<Star>& r = ring(v);
    const int d = static_cast<int>(r.size());
    for (const auto& [i, apex, j] : filling_) {
      faces_.push_back({r[index(i)].neighbour, r[index(apex)].neighbour, r[index(j)].neighbour});
      creators_.push_back(v);
    }
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
      replace(rings_[index(r[index(i)].neighbour)], v, i, d, r);
    }
    alive_[index(v)] = 0;
    --count_;
  }

  /// In `target`, the ring of r[i], the fan takes the place of v.
  void replace(std::vector<Star>& target, int v, int i, int d, const std::vector<Star>& r) {
    const auto is_v = [&](const Star& s) { return s.neighbour == v; };
    const auto place = std::find_if(target.begin(), target.end(), is_v);
    const std::size_t at = static_cast<std::size_t>(place - target.begin());
    const std::size_t previous = (at + target.size() - 1) % target.size();
    const auto face = [&](std::size_t k) { return filling_face(i, fan_[k] % d, fan_[k + 1] % d); };
    target[previous].face = face(0);
    inserted_.clear();
    for (std::size_t k = 1; k + 1 < fan_.size(); ++k) inserted_.push_back({r[index(fan_[k] % d)].neighbour, face(k)});
    target.erase(target.begin() + static_cast<std::ptrdiff_t>(at));
    target.insert(target.begin() + static_cast<std::ptrdiff_t>(at), inserted_.begin(), inserted_.end());
  }

  const Space& space_;
  std::vector<std::vector<Star>> rings_;
  std::vector<Triangle> faces_;
  std::vector<std::int32_t> creators_;
  std::vector<char> alive_;
  std::vector<char> blocked_;
  std::vector<std::int32_t> present_;  ///< alive at the beginning of a step, ascending
  std::vector<std::array<int, 3>> filling_;
  std::vector<int> fan_;        ///< buffer of `remove`
  std::vector<Star> inserted_;  ///< the same
  int count_ = 0;
};

}  // namespace pd::detail
