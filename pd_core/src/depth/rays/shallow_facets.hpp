/// @file
/// The facets of P = B + (-A) that can be reached inside a ball about the origin, walked over the overlay of the two
/// normal diagrams from facet to facet, without building it ([A] section 3.2, step 5).
///
/// A facet of P is a vertex of the overlay and an edge of P one of its arcs: the arc of an edge of one body inside the
/// cell of a vertex of the other. From a facet the walk leaves along each of its arcs; an arc ends where it crosses the
/// boundary of that cell (an edge-edge facet) or at the normal of its own edge's other facet, whichever comes first.
#pragma once

#include <array>
#include <optional>
#include <unordered_set>
#include <vector>

#include "depth/rays/ray_shooting.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

class ShallowSearch {
 public:
  /// Requires two bodies of affine dimension 2 or 3.
  /// @param radius  of the ball, in the pair's scaled lengths.
  ShallowSearch(const OverlayWalk& walk, double radius);

  /// Starts at the facet that holds the triangle of a portal, with all pieces that the symbolic rotation cuts it into.
  void add_seed(const std::array<VertexPair, 3>& corners);
  /// Visits what can be reached inside the ball.
  void run();

  [[nodiscard]] const std::vector<OverlayPiece>& visited() const { return queue_; }
  /// Different facets that a walk started from.
  [[nodiscard]] std::int64_t seeds() const { return seeds_; }
  /// Edges of P crossed or found to lie outside the ball.
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// Arcs tried in those steps.
  [[nodiscard]] std::int64_t degrees() const { return degrees_; }

 private:
  struct Edge {  ///< of P: an edge (of A or B) with a vertex of the other body
    VertexPair from;
    VertexPair to;
  };
  struct Neighbour {
    OverlayPiece piece;
    Edge across;
  };

  template <class Visit>
  void for_each_neighbour(const OverlayPiece& piece, Visit&& visit);
  OverlayPiece follow(bool moves_a, int half_edge, int cell);
  int side(bool edge_of_a, int half_edge, int facet) const;
  std::optional<OverlayPiece> piece_of(const std::array<VertexPair, 3>& corners) const;
  int facet_in_plane(bool of_a, int vertex, const PairVector& u, const PairVector& w) const;
  int edge_in_plane(bool of_a, int vertex, const PairVector& u, const PairVector& w) const;
  bool lies_in(const OverlayPiece& piece, const FacetOfDifference& plane) const;
  bool meets_ball(const Edge& edge) const;
  bool enqueue(const OverlayPiece& piece);

  const OverlayWalk& walk_;
  const PosedPair& pair_;
  double radius_;
  std::vector<OverlayPiece> queue_;
  std::unordered_set<std::uint64_t> seen_;
  std::size_t next_ = 0;
  std::int64_t seeds_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t degrees_ = 0;
};

/// The visited piece whose plane is nearest to the origin, exactly; of several the first in the order of the overlay
/// engine. Nothing where none of them is a whole facet with an area.
[[nodiscard]] std::optional<FacetOfDifference> nearest_piece(const OverlayWalk& walk,
                                                             const std::vector<OverlayPiece>& pieces);

}  // namespace pd::detail
