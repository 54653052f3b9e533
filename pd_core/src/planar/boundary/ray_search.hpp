/// @file
/// The first meeting of a ray with parts of the boundary: compared in doubles with bounds, exactly where those overlap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "planar/boundary/boundary_query.hpp"

namespace pd::detail {

/// A meeting of the ray with an edge part: at a place on the edge, at a place along the ray.
struct RayHit {
  BoundaryPoint point;
  bool crossing;         ///< of the ray with the edge's line; otherwise a point of an edge that lies along the ray
  bool certain = false;  ///< a crossing inside the part, its ends on different sides of the ray's line
  bool leaves = false;   ///< where certain: the ray goes from the edge's left to its right
  /// Bounds of its parameter along the ray.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

class RaySearch {
 public:
  RaySearch(const SumBoundary& boundary, const Point2& y, const Point2& d)
      : boundary_(boundary), ray_{BoundaryQuery::point(y), {{0, 0}, d}, {}} {}

  [[nodiscard]] const Span& ray() const { return ray_; }
  [[nodiscard]] const std::optional<RayHit>& best() const { return best_; }
  /// Nothing farther along the ray than this can be the first.
  [[nodiscard]] const double& limit() const { return limit_; }
  /// The best one's parameter is met by no other stretch.
  [[nodiscard]] bool unique() const { return unique_; }
  /// Boxes of the tree that were looked into.
  std::int64_t boxes = 0;
  [[nodiscard]] int sign(const RayHit& hit) const {
    if (hit.low > 0) return 1;
    if (hit.high < 0) return -1;
    return exact_sign([&]<class N>() { return along<N>(hit).numerator; }) *
           exact_sign([&]<class N>() { return along<N>(hit).denominator; });
  }

  /// A hit whose parameter is bounded, or left open for this to bound.
  void offer(RayHit hit) {
    if (!std::isfinite(hit.low)) bound(hit);
    if (hit.high < 0 || hit.low > limit_ || sign(hit) < 0) return;
    if (best_) {
      const int order = hit.high < best_->low ? -1 : compare(hit, *best_);
      if (order == 0 && hit.point.stretch != best_->point.stretch) unique_ = false;
      if (order >= 0) return;
    }
    unique_ = true;
    best_ = hit;
    limit_ = std::min(limit_, hit.high);
  }
  void meet(std::int32_t index, int edge, const EdgePart& part) {
    const Place crossing{Place::Kind::line, ray_.s, ray_.d};
    if (cross_sign(part.span.d, ray_.d) != 0) {
      if (compare_places(part.span, part.from, crossing) <= 0 && compare_places(part.span, crossing, part.to) <= 0) {
        offer({{index, edge, crossing}, true});
      }
      return;
    }
    if (side_of(part.span.s, part.span.d, ray_.s) != 0) return;
    const Place here{Place::Kind::point, ray_.s, {}};
    if (compare_places(part.span, part.from, here) <= 0 && compare_places(part.span, here, part.to) <= 0) {
      offer({{index, edge, here}, false});
    }
    offer({{index, edge, part.from}, false});
    offer({{index, edge, part.to}, false});
  }

 private:
  template <class N>
  [[nodiscard]] Fraction<N> along(const RayHit& hit) const {
    const Stretch& stretch = boundary_.stretches()[static_cast<std::size_t>(hit.point.stretch)];
    const Span span = boundary_.edge(boundary_.candidate(stretch), hit.point.edge);
    if (hit.crossing) return fraction<N>(ray_, Place{Place::Kind::line, span.s, span.d});
    const Homogeneous<N> x = point_at<N>(span, hit.point.at);
    const Vector2<N> d = vector<N>(ray_.d);
    const Vector2<N> y = {N(ray_.s.p[0]), N(ray_.s.p[1])};
    return {(x.x - y.x * x.w) * d.x + (x.y - y.y * x.w) * d.y, x.w * dot(d, d)};
  }
  [[nodiscard]] int compare(const RayHit& a, const RayHit& b) const {
    const auto evaluate = [&]<class N>() {
      const Fraction<N> f = along<N>(a), g = along<N>(b);
      return std::array<N, 3>{f.numerator * g.denominator - g.numerator * f.denominator, f.denominator, g.denominator};
    };
    const auto estimate = evaluate.template operator()<Estimate>();
    const int s = estimate[0].certain_sign() * estimate[1].certain_sign() * estimate[2].certain_sign();
    if (s != 0) return s;
    const auto exact = evaluate.template operator()<Dyadic>();
    return exact[0].sign() * exact[1].sign() * exact[2].sign();
  }
  void bound(RayHit& hit) const {
    const Fraction<Estimate> f = along<Estimate>(hit);
    const double w = std::abs(f.denominator.value) - f.denominator.error;
    const double w_high = std::abs(f.denominator.value) + f.denominator.error;
    if (!(w > 0)) return;
    const double n = f.denominator.value > 0 ? f.numerator.value : -f.numerator.value;
    const double n_low = n - f.numerator.error, n_high = n + f.numerator.error;
    double low = n_low / (n_low > 0 ? w_high : w), high = n_high / (n_high > 0 ? w : w_high);
    low -= 0x1p-45 * std::abs(low) + 0x1p-1060;
    high += 0x1p-45 * std::abs(high) + 0x1p-1060;
    if (std::isfinite(low) && std::isfinite(high)) {
      hit.low = low;
      hit.high = high;
    }
  }

  const SumBoundary& boundary_;
  Span ray_;
  std::optional<RayHit> best_;
  double limit_ = std::numeric_limits<double>::infinity();
  bool unique_ = true;
};

}  // namespace pd::detail
