/// @file
/// The part of a candidate that lies inside one convex sum: of an arc by binary search, since it is one interval for
/// convex parts of disjoint interiors ([D] Fact 4.1).
#pragma once

#include <functional>

#include "planar/boundary/covered_intervals.hpp"

namespace pd::detail {

/// Covered and abutting parts of one candidate, gathered over the sums near it.
struct CandidateCover {
  CoveredIntervals covered;                          ///< inside, or along an edge that it gives way to
  std::vector<CoveredIntervals::Interval> abutting;  ///< along an edge in the opposite direction
  bool keep_parts = false;
  std::vector<CoveredIntervals::Interval> parts;  ///< covered ones as they came, if they are kept

  void add(const CoveredIntervals::Interval& interval) {
    covered.add(interval);
    if (keep_parts) parts.push_back(interval);
  }
};

class ArcCover {
 public:
  /// `gives_way(sum, edge)`: does the candidate leave a common stretch to that edge of the sum?
  using GivesWay = std::function<bool(int, int)>;

  ArcCover(const SumBoundary& boundary, const Candidate& candidate, GivesWay gives_way, BoundaryCounts& counts)
      : boundary_(boundary), candidate_(candidate), gives_way_(std::move(gives_way)), counts_(counts) {}

  /// Cuts away what lies in that sum. @return how often the candidate crosses its boundary inside an edge of its own;
  /// at a vertex of it, which takes a special position, is not counted.
  std::int64_t cut(int sum, CandidateCover& cover);

 private:
  void cut_edge(int edge, CandidateCover& cover);
  void cut_arc(CandidateCover& cover);
  /// Edges [low, high) have the other sum reaching farther than the candidate's own along their normals.
  void search(int low, int high, CandidateCover& cover);
  void grow(int low, int seed, int high, CandidateCover& cover);
  /// Where the covered part lies, seen from a vertex: 0 here, -1 before, 1 behind, 2 nowhere but on the edge beside.
  [[nodiscard]] int classify(int vertex, int high) const;
  [[nodiscard]] bool vertex_inside(int vertex) const;
  [[nodiscard]] SumPoint vertex(int v) const { return own().vertex((candidate_.first + v) % own().size()); }
  [[nodiscard]] PlaneDirection direction(int e) const { return own().direction(boundary_.sum_edge(candidate_, e)); }
  [[nodiscard]] const ConvexSum& own() const { return boundary_.sum(candidate_); }
  [[nodiscard]] const ConvexSum& other() const { return boundary_.sums()[static_cast<std::size_t>(sum_)]; }

  const SumBoundary& boundary_;
  const Candidate& candidate_;
  GivesWay gives_way_;
  BoundaryCounts& counts_;
  int sum_ = -1;
  std::int64_t crossings_ = 0;
};

}  // namespace pd::detail
