/// @file
/// A polytope that grows inside a composed body, the facet with the farthest support first, until every facet's support
/// is certified to be near its plane ([M] Theorem 2; `pd/dimension/approximate_minkowski_sum.hpp` says where it
/// departs).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dimension/composed/composed_node.hpp"
#include "dimension/joggle.hpp"
#include "dimension/radial_hull.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

/// Rounding in the frame, relative; far below the least epsilon.
inline constexpr double kRoom = 1e-9;

/// The largest epsilon of K's structures at which a polytope can be grown until it holds K / (1 + growth).
/// @param ratio  of the frame, as `GrowingSum` tells
[[nodiscard]] inline double allowed_error(const ComposedNode& body, double ratio, double growth) {
  return body.radial ? growth / 2 : growth / (4 * (1 + ratio));
}

/// A growth may take so many operations: a facet counts as one, and so do a thousand products of K's structures. They
/// take some four seconds and 0.6 GB in R^5.
inline constexpr std::int64_t kMostGrowthWork = 1'000'000;

/// A growth has one of these ends.
enum class Growth {
  reached,   ///< K shrunk by the limit lies inside
  spent,     ///< the budget ended; `GrowingSum::reached` tells what is certified
  rounding,  ///< no surface is left in double precision
};

/// Grows a polytope inside K until it holds K shrunk by `limit`.
class GrowingSum {
 public:
  explicit GrowingSum(Composed sum) : sum_(std::move(sum)), hull_(sum_->dimension, 0.5) {
    const int d = sum_->dimension;
    const EllipsoidBounds bounds = sum_->bounds(LiftedMatrix::Identity(d, d), 0);
    frame_ = AnySandwich{bounds.center, bounds.inner}.fattening();
    ratio_ = (frame_.linear * AnyMatrix(bounds.outer)).norm();
  }

  /// How far K reaches in the frame, in which it holds the unit ball.
  [[nodiscard]] double ratio() const { return ratio_; }

  Growth grow(double limit, std::int64_t most_work = kMostGrowthWork) {
    reached_ = limit;
    enter_facets(0);
    while (!waiting_.empty()) {
      if (work() >= most_work) return end_early();
      std::pop_heap(waiting_.begin(), waiting_.end());
      const Waiting next = waiting_.back();
      waiting_.pop_back();
      if (!hull_.alive(next.facet)) continue;
      if (certify(next) <= limit) continue;
      const std::size_t before = hull_.facets().size();
      const double nearer = joggle(hull_.dimension(), static_cast<std::int64_t>(hull_.vertices().size()), limit);
      const AnyVector point = (1 - nearer) * next.support;
      if (!hull_.insert(point, next.facet)) return Growth::rounding;
      enter_facets(before);
    }
    return Growth::reached;
  }

  /// K shrunk by this factor lies inside: the limit, or more if the budget ended first.
  [[nodiscard]] double reached() const { return reached_; }
  [[nodiscard]] const RadialHull& hull() const { return hull_; }
  [[nodiscard]] const AnyMap& frame() const { return frame_; }
  /// Bounds h_K over a living facet's normal, whose plane is at 1.
  [[nodiscard]] double upper(std::int32_t facet) const { return upper_[static_cast<std::size_t>(facet)]; }
  [[nodiscard]] const QueryCounters& counters() const { return counters_; }
  [[nodiscard]] std::int64_t supports() const { return supports_; }

 private:
  struct Waiting {
    double height;
    std::int32_t facet;
    AnyVector support;
    friend bool operator<(const Waiting& a, const Waiting& b) {
      return a.height != b.height ? a.height < b.height : a.facet > b.facet;
    }
  };

  [[nodiscard]] std::int64_t work() const {
    constexpr std::int64_t kProductsAFacet = 1000;
    return static_cast<std::int64_t>(hull_.facets().size()) + counters_.dot_products / kProductsAFacet;
  }

  /// Certifies the facets that still wait, which were not refined.
  Growth end_early() {
    for (const Waiting& facet : waiting_) {
      if (hull_.alive(facet.facet)) reached_ = std::max(reached_, certify(facet));
    }
    return Growth::spent;
  }

  AnyVector support(const AnyVector& normal) {
    ++supports_;
    return frame_.apply(sum_->support(frame_.pull_back(normal), counters_).point);
  }

  void enter_facets(std::size_t from) {
    upper_.resize(hull_.facets().size(), 0.0);
    for (std::size_t f = from; f < hull_.facets().size(); ++f) {
      const auto id = static_cast<std::int32_t>(f);
      if (!hull_.alive(id)) continue;
      const AnyVector normal = hull_.normal(id);
      const AnyVector p = support(normal);
      waiting_.push_back({normal.dot(p), id, p});
      std::push_heap(waiting_.begin(), waiting_.end());
    }
  }

  /// An upper bound of h_K over the facet's normal.
  double certify(const Waiting& facet) {
    const double error = sum_->epsilon;
    double bound = facet.height;
    if (sum_->radial) {
      bound /= 1 - error;
    } else if (error > 0) {
      const AnyVector normal = hull_.normal(facet.facet);
      bound += error / (1 - error) * (facet.height + (-normal).dot(support(-normal)));
    }
    return upper_[static_cast<std::size_t>(facet.facet)] = std::max(bound, 1.0) * (1 + kRoom);
  }

  Composed sum_;
  AnyMap frame_;
  double ratio_ = 1;
  double reached_ = 1;
  RadialHull hull_;
  std::vector<Waiting> waiting_;  ///< a heap
  std::vector<double> upper_;     ///< per facet, once certified
  QueryCounters counters_;
  std::int64_t supports_ = 0;
};

}  // namespace pd::dimension::detail
