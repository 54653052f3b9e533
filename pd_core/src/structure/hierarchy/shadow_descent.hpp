/// @file
/// The descent of a hierarchy from coarse to fine that both kinds share: an extreme element and two edges at it.
///
/// Let v be extreme in level i. In a shadow of the surface, v has two neighbours on the shadow's boundary. An element u
/// of level i - 1 beyond v lies beyond the line of one of these two edges; the plane over that line supports level i
/// along the edge, so that u lies beyond one of the two triangles at the edge, which is therefore no triangle of level
/// i - 1: u is its creator. Four pointers tell, whatever the degree of v.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::detail {

/// A step from the extreme element in the plane of the shadow; `up` > 0: beyond it.
struct ShadowStep {
  double along, up;
};

/// `View` knows where elements stand: `stand_at(element)`, `step_to(element)` and `blocked()`, which ends the descent.
template <class View>
class ShadowDescent {
 public:
  ShadowDescent(const PolyhedralHierarchy& hierarchy, View view) : hierarchy_(hierarchy), view_(std::move(view)) {}

  [[nodiscard]] const View& view() const { return view_; }
  [[nodiscard]] int element() const { return element_; }
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::int64_t evaluations() const { return evaluations_; }
  void count_evaluation() { ++evaluations_; }

  /// To the coarsest level that has this element, which must be extreme there up to rounding.
  void enter(int element) {
    element_ = element;
    view_.stand_at(element);
    level_ = hierarchy_.last_level(element);
    const auto star = hierarchy_.star(element);
    // Every step points down in the shadow, or is level: its boundary leaves along the first and the last by angle.
    // What rises does so by rounding only: neighbours in one contact plane.
    std::array<std::size_t, 2> spokes{0, 0};
    std::array<ShadowStep, 2> best{};
    for (std::size_t k = 0; k < star.size(); ++k) {
      ShadowStep s = step_to(star[k].neighbour);
      s.up = std::min(s.up, 0.0);
      const auto turn = [&](const ShadowStep& other) { return s.along * other.up - s.up * other.along; };
      if (k == 0 || turn(best[0]) > 0 || (turn(best[0]) == 0 && s.along < best[0].along)) {
        best[0] = s;
        spokes[0] = k;
      }
      if (k == 0 || turn(best[1]) < 0 || (turn(best[1]) == 0 && s.along > best[1].along)) {
        best[1] = s;
        spokes[1] = k;
      }
    }
    for (const int side : {0, 1}) {
      set_edge(side, spokes[static_cast<std::size_t>(side)]);
      edges_[static_cast<std::size_t>(side)].step = best[static_cast<std::size_t>(side)];
    }
  }

  /// Goes on to the next finer level with another extreme element. False when there is none down to `finest`.
  bool next(int finest) {
    while (!view_.blocked()) {
      // The next step back that changes a triangle at the two edges.
      int u = -1, step = finest - 1;
      for (const Edge& edge : edges_) {
        for (const std::int32_t f : edge.faces) {
          const int creator = hierarchy_.creator(f);
          if (creator < 0) continue;
          const int last = hierarchy_.last_level(creator);
          if (last <= step) continue;
          step = last;
          u = creator;
        }
      }
      if (u < 0) return false;
      if (step_to(u).up > 0) {
        if (view_.blocked()) return false;
        enter(u);
        return true;
      }
      level_ = step;
      refine(0, u);
      refine(1, u);
    }
    return false;
  }

 private:
  /// An edge of the shadow's boundary at the extreme element.
  struct Edge {
    std::int32_t to = -1;
    std::array<std::int32_t, 2> faces{-1, -1};  ///< to its right and to its left
    ShadowStep step{};
  };

  ShadowStep step_to(int element) {
    ++evaluations_;
    return view_.step_to(element);
  }

  void set_edge(int side, std::size_t spoke) {
    const auto star = hierarchy_.star(element_);
    Edge& edge = edges_[static_cast<std::size_t>(side)];
    edge.to = star[spoke].neighbour;
    edge.faces = {star[(spoke + star.size() - 1) % star.size()].face, star[spoke].face};
  }

  /// Sees to what the removal of u hid at an edge; `side` 0: the left end of the shadow, 1: the right end.
  void refine(int side, int u) {
    Edge& edge = edges_[static_cast<std::size_t>(side)];
    std::array<bool, 2> hidden{};
    for (std::size_t i = 0; i < 2; ++i) hidden[i] = hierarchy_.creator(edge.faces[i]) == u;
    if (!hidden[0] && !hidden[1]) return;
    const auto star = hierarchy_.star(u);
    const std::size_t d = star.size();
    std::size_t mine = 0;
    while (star[mine].neighbour != element_) ++mine;
    const ShadowStep s = step_to(u);
    const double turn = s.along * edge.step.up - s.up * edge.step.along;
    if ((hidden[0] && hidden[1]) || (side == 0 ? turn > 0 : turn < 0)) {
      // The edge to u: to its right, seen from the extreme element, the triangle of u with the neighbour before, to its
      // left after.
      edge.to = u;
      edge.faces = {star[mine].face, star[(mine + d - 1) % d].face};
      edge.step = s;
      return;
    }
    const bool after = star[(mine + 1) % d].neighbour == edge.to;
    edge.faces[hidden[0] ? 0 : 1] = after ? star[mine].face : star[(mine + d - 1) % d].face;
  }

  const PolyhedralHierarchy& hierarchy_;
  View view_;
  int element_ = -1;
  int level_ = 0;
  std::array<Edge, 2> edges_;
  std::int64_t evaluations_ = 0;
};

}  // namespace pd::detail
