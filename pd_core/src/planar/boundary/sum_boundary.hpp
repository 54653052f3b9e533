/// @file
/// The boundary of R = P + (-Q) in implicit form ([D] section 4.1): what is left of the edges and arcs of convolved
/// triangles when every other one is cut away.
///
/// R is regularised: the interior of the closure of the union of open convex sums. So a slot of zero width between two
/// sums is no boundary, nor is an isolated point.
///
/// Candidates are edges of P displaced by a vertex of Q, and at every convex vertex of P an arc of -Q (an index range):
/// all that can lie on the boundary, since a diagonal or a reflex vertex has P on all its sides. From each the part
/// inside every convolved triangle near it is cut away: one interval each (Fact 4.1), found in O(log^2 m) for an arc.
/// [D] merges unions by a plane sweep instead, in O(n log^2(n + m)); here the cost is O((n + k) log^2 m) for k pairs of
/// a candidate and a triangle that Q, slid along the candidate, meets: fewer for small Q, up to n^2 for a large one,
/// but every decision is one about a single edge.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "planar/boundary/convex_sum.hpp"
#include "planar/boundary/triangulation.hpp"

namespace pd::detail {

/// Consecutive edges of one convex sum: `first` + i, modulo its size.
struct Candidate {
  std::int32_t sum;
  std::int32_t first;
  std::int32_t count;
  std::int32_t id;  ///< the order in which coinciding edges give way to each other
};

/// A place on a candidate: `at` is never an end; edge == count with a start is the candidate's end.
struct Position {
  std::int32_t edge;
  Place at;
};

/// A part of the boundary, R on its left.
struct Stretch {
  std::int32_t candidate;
  Position from, to;
  std::int32_t loop = -1;  ///< which closed curve of the boundary; 0 is the outer one
};

/// A place on a candidate where parts meet that sums cover, and that lies inside none of these sums.
struct SeatPlace {
  std::int32_t candidate;
  Position at;
};

/// An edge of a stretch, whole or cut.
struct EdgePart {
  Span span;
  Place from, to;
};

struct BoundaryCounts {
  std::int64_t pairs = 0;           ///< of a candidate and a convolved triangle that were intersected
  std::int64_t locations = 0;       ///< points located in a convex sum for it
  std::int64_t edges_covered = 0;   ///< single edges cut
  std::int64_t reflex_points = 0;   ///< of the boundary
  std::int64_t sums = 0;            ///< s
  std::int64_t crossings = 0;       ///< of displaced edges and arcs with sums of other triangles, inside edges
  std::int64_t most_crossings = 0;  ///< of one sum's displaced edges and arcs with the boundary of one other sum

  /// [D] Fact 4.1: the boundaries of two convolved triangles meet in at most two points, common stretches aside.
  static constexpr std::int64_t kCrossingBound = 2;
  /// [D] Fact 4.2: at most 6 s - 12 points of local nonconvexity for s >= 3 sums; 0 of one, 2 of two (Fact 4.1).
  [[nodiscard]] std::int64_t reflex_bound() const { return sums >= 3 ? 6 * sums - 12 : (sums == 2 ? 2 : 0); }
  [[nodiscard]] bool facts_hold() const { return most_crossings <= kCrossingBound && reflex_points <= reflex_bound(); }
};

class SumBoundary {
 public:
  /// Implicit: q convex, candidates are arcs. Explicit: every edge of every sum of two convex parts is one, within a
  /// budget of comparisons. `with_seats`: places that may be seats are kept as well.
  SumBoundary(const Polygon& p, const Polygon& q, bool implicit, std::int64_t max_comparisons, bool with_seats = false);
  SumBoundary(const SumBoundary&) = delete;  // sums point into its lists
  SumBoundary& operator=(const SumBoundary&) = delete;

  [[nodiscard]] const std::vector<ConvexSum>& sums() const { return sums_; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  /// Where two sums abut and no third lies over it.
  [[nodiscard]] const std::vector<Stretch>& slots() const { return slots_; }
  [[nodiscard]] const std::vector<SeatPlace>& seat_places() const { return seat_places_; }
  /// The place, as `from` on its edge.
  [[nodiscard]] EdgePart place(const SeatPlace& m) const;
  [[nodiscard]] const BoundaryCounts& counts() const { return counts_; }
  [[nodiscard]] int num_loops() const { return num_loops_; }
  /// False if the budget ended first: then there are sums and no stretches.
  [[nodiscard]] bool complete() const { return complete_; }

  [[nodiscard]] const Candidate& candidate(const Stretch& s) const {
    return candidates_[static_cast<std::size_t>(s.candidate)];
  }
  [[nodiscard]] const ConvexSum& sum(const Candidate& c) const { return sums_[static_cast<std::size_t>(c.sum)]; }
  [[nodiscard]] int sum_edge(const Candidate& c, int edge) const { return (c.first + edge) % sum(c).size(); }
  [[nodiscard]] Span edge(const Candidate& c, int edge) const { return sum(c).edge(sum_edge(c, edge)); }
  /// The edges that a stretch touches are first_edge .. last_edge.
  [[nodiscard]] static int first_edge(const Stretch& s) { return s.from.edge; }
  [[nodiscard]] static int last_edge(const Stretch& s) {
    return s.to.at.kind == Place::Kind::start ? s.to.edge - 1 : s.to.edge;
  }
  /// A box of the candidate's edges [begin, end), rounded outwards.
  [[nodiscard]] Box2 box(const Candidate& c, int begin, int end) const;
  [[nodiscard]] Box2 box(const Stretch& s) const { return box(candidate(s), first_edge(s), last_edge(s) + 1); }
  [[nodiscard]] EdgePart part(const Stretch& s, int edge) const;
  /// Vertices of P (and of a non-convex Q) by index into the polygon.
  struct Contact {
    std::int32_t p, q;
    bool p_edge, q_edge;  ///< the edge from there on, else the vertex
  };
  [[nodiscard]] Contact contact(const Stretch& s, int edge) const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  friend class BoundaryBuilder;
  std::vector<Point2> p_points_, q_points_;
  std::vector<std::unique_ptr<NegatedChain>> chains_;
  std::vector<std::vector<std::int32_t>> chain_vertices_;  ///< per chain: Q's vertex of each
  std::vector<ConvexPart> parts_;                          ///< of P
  std::vector<ConvexSum> sums_;
  std::vector<Candidate> candidates_;
  std::vector<Stretch> stretches_, slots_;
  std::vector<SeatPlace> seat_places_;
  BoundaryCounts counts_;
  int num_loops_ = 0;
  bool complete_ = true;
};

}  // namespace pd::detail
