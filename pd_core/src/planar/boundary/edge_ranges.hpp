/// @file
/// Ranges of a candidate's edges, halved as long as their boxes matter.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "planar/boundary/sum_boundary.hpp"

namespace pd::detail {

/// Calls visit(edge) for the edges [begin, end) of a candidate that lie in boxes with enter(box), halving the range.
template <class Enter, class Visit>
void visit_edges(const SumBoundary& boundary, const Candidate& c, int begin, int end, const Enter& enter,
                 const Visit& visit) {
  if (!enter(boundary.box(c, begin, end))) return;
  if (end - begin == 1) return visit(begin);
  const int middle = (begin + end) / 2;
  visit_edges(boundary, c, begin, middle, enter, visit);
  visit_edges(boundary, c, middle, end, enter, visit);
}

/// Does the box meet the ray from y along d at a parameter in [0, limit]? Returns a number not above the first one
/// there, or infinity.
inline double enter_ray(const Box2& box, const Point2& y, const Point2& d, double limit) {
  double low = 0, high = limit;
  for (std::size_t k = 0; k < 2; ++k) {
    if (d[k] == 0) {
      if (y[k] < box.low[k] || y[k] > box.high[k]) return std::numeric_limits<double>::infinity();
      continue;
    }
    double a = (box.low[k] - y[k]) / d[k], b = (box.high[k] - y[k]) / d[k];
    if (a > b) std::swap(a, b);
    // A few roundings of the difference and of the quotient.
    const double air = 0x1p-48 * std::max(std::abs(a), std::abs(b)) + 0x1p-48 * std::abs(y[k] / d[k]);
    low = std::max(low, a - air);
    high = std::min(high, b + air);
  }
  return low <= high ? low : std::numeric_limits<double>::infinity();
}

}  // namespace pd::detail
