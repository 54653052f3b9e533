/// @file
/// The extreme vertex of an inner hierarchy's levels in one direction, followed from coarse to fine ([D] Lemma 5.4).
///
/// Let v be extreme in level i. In the shadow along a second direction, v has two neighbours on the shadow's boundary.
/// A vertex u of level i - 1 beyond v's plane lies beyond the line of one of these two edges; the plane over that line
/// supports level i along the edge, so that u lies beyond one of the two triangles at the edge, which is therefore no
/// triangle of level i - 1: u is its creator. Four pointers tell, whatever the degree of v. Rounding may choose another
/// vertex within rounding of the best; who needs the exact one climbs on from there.
#pragma once

#include <array>
#include <cstdint>

#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::detail {

class PlaneDescent {
 public:
  /// At the coarsest level.
  PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction);
  /// At the coarsest level that has this vertex, which must be extreme there up to rounding.
  PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction, int vertex);

  [[nodiscard]] int vertex() const { return vertex_; }
  /// The coarsest level for which `vertex` is known to be extreme.
  [[nodiscard]] int level() const { return level_; }
  /// Goes on to the next finer level with another extreme vertex. False when there is none down to `finest`.
  bool next(int finest = 0);

  /// Vertices evaluated.
  [[nodiscard]] std::int64_t evaluations() const { return evaluations_; }

 private:
  /// An edge of the shadow's boundary at `vertex`.
  struct Edge {
    std::int32_t to = -1;
    std::array<std::int32_t, 2> faces{-1, -1};  ///< to its right and to its left
    double along = 0, up = 0;                   ///< of the step from `vertex` in the shadow's plane
  };
  struct Shadow {
    double along, up;
  };

  void choose_sideways();
  [[nodiscard]] Shadow shadow(int v);
  void enter(int vertex);
  /// Sees to what the removal of u hid at an edge; `side` 0: the left end of the shadow, 1: the right end.
  void refine(int side, int u);
  void set_edge(int side, std::size_t spoke, int of);

  const PolyhedralHierarchy& hierarchy_;
  Vec3 direction_;
  Vec3 sideways_;
  Vec3 at_ = Vec3::Zero();
  int vertex_ = -1;
  int level_ = 0;
  std::array<Edge, 2> edges_;
  std::int64_t evaluations_ = 0;
};

}  // namespace pd::detail
