/// @file
/// The exact convex hull of some points of P, grown one point at a time: where doubles have failed.
///
/// Sides are exact, so that the faces strictly below a point outside always form one disc. No new triangle is
/// degenerate: the point would have to lie on the line of an edge of a face visible from it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "depth/expansion/tetrahedron.hpp"

namespace pd::detail {

/// @tparam Hull  derived: `side(f, v)` is the exact side of vertex v against the plane of face f, +1 outside.
/// @tparam Face  has corners `v`, counter-clockwise from outside, faces `adj` across the edges v[i] -> v[i + 1], and
///               `alive`.
template <class Hull, class Face>
class GrowingHull {
 public:
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] Face& face(int f) { return faces_[static_cast<std::size_t>(f)]; }
  [[nodiscard]] const Face& face(int f) const { return faces_[static_cast<std::size_t>(f)]; }
  /// Number of places for faces, those no longer alive among them.
  [[nodiscard]] int slots() const { return static_cast<int>(faces_.size()); }

 protected:
  void clear_faces() {
    faces_.clear();
    free_.clear();
  }

  /// The tetrahedron of vertices 0 to 3, the last of which lies behind the first three.
  /// @param measure  of a new face: sets its distance.
  template <class Measure>
  void start_tetrahedron(Measure&& measure) {
    for (int f = 0; f < 4; ++f) {
      add_face(kTetrahedronFaces[f][0], kTetrahedronFaces[f][1], kTetrahedronFaces[f][2], measure);
      for (int e = 0; e < 3; ++e) face(f).adj[e] = kTetrahedronBeyond[f][e].face;
    }
  }

  /// Replaces the faces strictly below vertex v, `from` among them, by a fan around it.
  template <class Measure>
  void replace_below(int from, int v, Measure&& measure) {
    remove_below(from, v);
    fan_.clear();
    for (const Horizon& h : horizon_) {
      const int f = add_face(h.from, h.to, v, measure);
      face(f).adj[0] = h.face;
      face(h.face).adj[h.edge] = f;
      fan_.push_back(f);
    }
    for (std::size_t i = 0; i < fan_.size(); ++i) {
      const std::size_t j = i + 1 == fan_.size() ? 0 : i + 1;
      face(fan_[i]).adj[1] = fan_[j];
      face(fan_[j]).adj[2] = fan_[i];
    }
  }

 private:
  struct Horizon {
    int face, edge, from, to;
  };

  template <class Measure>
  int add_face(int a, int b, int c, Measure&& measure) {
    Face f;
    std::copy_n(std::array{a, b, c}.begin(), 3, f.v);
    measure(f);
    if (free_.empty()) {
      faces_.push_back(f);
      return slots() - 1;
    }
    const int slot = free_.back();
    free_.pop_back();
    face(slot) = f;
    static_cast<Hull*>(this)->forget(slot);
    return slot;
  }

  /// Frees the faces strictly below vertex v and lists the edges around them in their order.
  void remove_below(int from, int v) {
    struct Visit {
      int face, edge, left;
    };
    std::vector<Visit> visits{{from, 0, 3}};
    std::vector<int> removed{from};
    horizon_.clear();
    face(from).alive = false;
    while (!visits.empty()) {
      Visit& visit = visits.back();
      if (visit.left == 0) {
        visits.pop_back();
        continue;
      }
      const int f = visit.face;
      const int e = visit.edge;
      visit.edge = (e + 1) % 3;
      --visit.left;
      const int g = face(f).adj[e];
      if (!face(g).alive) continue;
      int entered = 0;
      while (face(g).adj[entered] != f || face(g).v[(entered + 1) % 3] != face(f).v[e]) ++entered;
      if (static_cast<Hull*>(this)->side(g, v) > 0) {
        face(g).alive = false;
        removed.push_back(g);
        visits.push_back({g, (entered + 1) % 3, 2});
      } else {
        horizon_.push_back({g, entered, face(f).v[e], face(f).v[(e + 1) % 3]});
      }
    }
    free_.insert(free_.end(), removed.begin(), removed.end());
  }

  std::vector<Face> faces_;
  std::vector<int> free_;
  std::vector<Horizon> horizon_;
  std::vector<int> fan_;
};

}  // namespace pd::detail
