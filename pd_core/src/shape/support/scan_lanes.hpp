/// @file
/// The farthest of few vertices, four at a time: a part of every kernel that scans (instruction_sets.hpp).
#pragma once

#include "numeric/lanes.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

static_assert(2 * kLanes == kVertexBlock);

struct Direction {
  double x, y, z;
};

PD_INLINE void heights(Lanes& to, const VertexArrays& v, int i, const Direction& d) {
  Lanes x, y, z;
  load(x, v.x + i);
  load(y, v.y + i);
  load(z, v.z + i);
  to = x * d.x + y * d.y + z * d.z;
}

/// The lowest index among the maximisers.
PD_INLINE int farthest(const VertexArrays& v, const Direction& d) {
  // Two rows of lanes, so that comparisons do not wait for each other. Ids are counted in doubles: one kind of
  // register.
  const Lanes row = {0, 1, 2, 3};
  Lanes best, other;
  heights(best, v, 0, d);
  heights(other, v, kLanes, d);
  const Lanes zero = {0, 0, 0, 0};
  if (v.count <= kVertexBlock) {
    const Lanes tops = zero + greatest(other > best ? other : best);
    const unsigned winners = mask_of_four(best == tops) | mask_of_four(other == tops) << kLanes;
    // The padding repeats vertex 0, which comes first. Nobody wins where products overflowed.
    const int winner = __builtin_ctz(winners | 1U << kVertexBlock);
    return winner < v.count ? winner : 0;
  }
  Lanes best_id = row, other_id = row + kLanes, id = other_id;
  for (int i = kVertexBlock; i < v.count; i += kVertexBlock) {
    Lanes next, after;
    heights(next, v, i, d);
    heights(after, v, i + kLanes, d);
    id += kLanes;
    best_id = next > best ? id : best_id;
    best = next > best ? next : best;
    id += kLanes;
    other_id = after > other ? id : other_id;
    other = after > other ? after : other;
  }
  const Lanes tops = zero + greatest(other > best ? other : best);
  const Lanes none = zero + 0x1p40;
  const Lanes from_best = best == tops ? best_id : none;
  const Lanes from_other = other == tops ? other_id : none;
  const double winner = least(from_other < from_best ? from_other : from_best);
  return winner < v.count ? static_cast<int>(winner) : 0;
}

}  // namespace pd::detail
