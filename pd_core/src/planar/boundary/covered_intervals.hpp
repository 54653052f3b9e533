/// @file
/// The part of a candidate that convex sums cover, as disjoint intervals in order.
#pragma once

#include <vector>

#include "planar/boundary/sum_boundary.hpp"

namespace pd::detail {

class CoveredIntervals {
 public:
  struct Interval {
    Position from, to;
  };

  CoveredIntervals(const SumBoundary& boundary, const Candidate& candidate)
      : boundary_(boundary), candidate_(candidate) {}

  void add(const Interval& interval);
  /// Nothing of positive length is left.
  [[nodiscard]] bool whole() const;
  /// What is left, in order: parts of positive length between the intervals.
  [[nodiscard]] std::vector<Interval> rest() const;
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  /// The parts of `interval` that are not covered.
  [[nodiscard]] std::vector<Interval> rest_of(const Interval& interval) const;

  /// Order along the candidate: -1, 0, 1.
  [[nodiscard]] int compare(const Position& a, const Position& b) const;

 private:
  const SumBoundary& boundary_;
  const Candidate& candidate_;
  std::vector<Interval> intervals_;
};

}  // namespace pd::detail
