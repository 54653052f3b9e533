/// @file
/// The epsilon-expansion of a body by its support function ([M] section 1.1 and Lemmas 4 and 12).
///
/// K_epsilon is the intersection of all slabs of K, each expanded about its middle by 1 + epsilon. [M] observes
/// K_epsilon = K + (epsilon / 2) (K + (-K)), so h_{K_epsilon}(v) = h_K(v) + (epsilon / 2) (h_K(v) + h_K(-v)) and every
/// directional width grows by the factor 1 + epsilon.
#pragma once

#include "pd/dimension/directional_width.hpp"

namespace pd::dimension {

/// A support oracle for K_epsilon over one for K (Lemma 4 (b): extreme points of sums are sums of extreme points).
/// Errors of the oracle below are multiplied by at most 1 + epsilon.
template <int D, class Oracle>
requires SupportOracle<Oracle, D>
class ExpandedBody {
 public:
  /// @param oracle   must outlive this object.
  /// @param epsilon  >= 0.
  ExpandedBody(const Oracle& oracle, double epsilon) : oracle_(&oracle), epsilon_(epsilon) {}

  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const {
    const Vector<D> most = oracle_->support(direction, counters).point;
    const Vector<D> least = oracle_->support(-direction, counters).point;
    const Vector<D> point = most + epsilon_ / 2 * (most - least);
    return {point, direction.dot(point), -1};
  }

 private:
  const Oracle* oracle_;
  double epsilon_;
};

/// A support oracle for K + (-K), the difference body: its least support is the width of K.
template <int D, class Oracle>
requires SupportOracle<Oracle, D>
class DifferenceBody {
 public:
  explicit DifferenceBody(const Oracle& oracle) : oracle_(&oracle) {}

  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const {
    const Vector<D> point = oracle_->support(direction, counters).point - oracle_->support(-direction, counters).point;
    return {point, direction.dot(point), -1};
  }

 private:
  const Oracle* oracle_;
};

}  // namespace pd::dimension
