/// @file
/// The steps that make a SumBoundary.
#pragma once

#include "planar/boundary/arc_cover.hpp"
#include "planar/boundary/box_tree.hpp"
#include "planar/boundary/rough_sums.hpp"
#include "planar/boundary/sum_boundary.hpp"

namespace pd::detail {

/// A candidate and another sum that may have a point in common.
struct NearSum {
  std::int32_t candidate, sum;
};

class BoundaryBuilder {
 public:
  BoundaryBuilder(SumBoundary& boundary, const Polygon& p, const Polygon& q, bool with_seats)
      : r_(boundary), p_(p), q_(q), with_seats_(with_seats) {}

  void build_implicit();
  /// Gives up where it takes more comparisons of a candidate with a sum. An exact one counts as kExactComparison.
  void build_explicit(std::int64_t max_comparisons);

 private:
  /// Consecutive edges of -B, modulo their number.
  struct ChainRange {
    int first, count;
    [[nodiscard]] ChainRange in_common(const ChainRange& other, int size) const;
  };
  [[nodiscard]] ChainRange arc_at(const NegatedChain& chain, int vertex) const;
  void add_arc_candidates(int vertex);
  void find_different_sums();
  void add_edge_candidates();
  /// The sums of `different_`, to be searched for those near a candidate.
  struct SumSearch {
    const std::vector<Box2>& boxes;
    const BoxTree& tree;
    const RoughSums& rough;
  };
  void cut_edge_candidate(const Candidate& candidate, const SumSearch& search, std::vector<std::int32_t>& recent);
  [[nodiscard]] int candidate_at(int sum, int edge) const;
  void flood(const Candidate& candidate, int triangle, ArcCover& cutter, CandidateCover& cover);
  [[nodiscard]] bool may_meet(const Triangle& triangle) const;
  [[nodiscard]] std::int32_t index_of(const Candidate& candidate) const;
  void reach_of(const Candidate& candidate);
  void keep(const Candidate& candidate, const CandidateCover& cover);
  void count_crossings(int sum, std::int64_t crossings);
  void next_sum();
  void compact();

  SumBoundary& r_;
  const Polygon& p_;
  const Polygon& q_;
  bool with_seats_;
  Triangulation triangulation_;
  std::vector<std::int32_t> seen_;  ///< per triangle: the candidate that met it last
  std::vector<std::int32_t> queue_;
  std::vector<std::int32_t> crossings_;  ///< per triangle: with the sum at hand
  std::vector<std::int32_t> crossed_;    ///< those with any
  std::vector<NearSum> near_;            ///< of candidates of which something is left
  RoughUnion rough_union_;
  std::int64_t comparisons_ = 0;
  std::vector<std::int32_t> different_;  ///< sums of which no earlier sum is the same set
  std::vector<std::int32_t> needed_;     ///< sums that are cut from the candidate at hand exactly
  Box2 q_box_;

  /// Where Q lies while it slides along a candidate: within an interval along each of three directions.
  struct Reach {
    std::array<Point2, 3> direction;
    std::array<double, 3> low, high;
  };
  Reach reach_;
};

/// The stretches, split where a point of one lies inside another. Stretches are in the order of their candidates;
/// `near` holds every pair of a candidate and another sum that touch, and few others: they were met when the candidate
/// was cut.
[[nodiscard]] std::vector<Stretch> split_where_touched(const SumBoundary& boundary,
                                                       const std::vector<Stretch>& stretches,
                                                       const std::vector<NearSum>& near);

/// Links the stretches of a boundary into loops, numbers them, the outer one 0, and puts them in this order, each
/// behind the one that it continues. @return how many there are.
int link_loops(const SumBoundary& boundary, std::vector<Stretch>& stretches, std::int64_t& reflex_points);

}  // namespace pd::detail
