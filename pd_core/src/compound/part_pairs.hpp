/// @file
/// What the pairs of parts say about two unions: class, distance, and the deepest pair.
#pragma once

#include <vector>

#include "compound/part_differences.hpp"
#include "pd/compound/compound_depth.hpp"

namespace pd::detail {

/// A box that holds a posed convex body, rounded outwards.
[[nodiscard]] Box bounding_box(const PosedShape& part);

/// Two unions where they stand.
struct UnionPair {
  std::vector<PosedShape> a;
  std::vector<PosedShape> b;
  std::vector<Box> boxes_a;
  std::vector<Box> boxes_b;
  std::vector<std::int32_t> order_a;  ///< which part of the caller's body each is
  std::vector<std::int32_t> order_b;
  double size = 0;  ///< at least |coordinate| of every point of P
  bool polytopes = true;

  /// The parts of each body in an order of their contents, so that no answer depends on the caller's.
  static Expected<UnionPair> pose(const PosedCompound& a, const PosedCompound& b);
  /// Orders the two bodies by content, so that an answer does not depend on which was named first. True when they were
  /// exchanged.
  bool exchange_to_canonical_order();
  /// Turns places in `a` and `b` into the caller's.
  void name_parts(std::int32_t& part_a, std::int32_t& part_b) const {
    part_a = order_a[static_cast<std::size_t>(part_a)];
    part_b = order_b[static_cast<std::size_t>(part_b)];
  }
  /// An upper bound of the depth: the least axis-parallel move that takes the boxes of the unions apart.
  [[nodiscard]] double box_exit() const;
  /// 2^k near `size` where products of lengths could leave the range of doubles, else 0.
  [[nodiscard]] int scale_exponent() const;
};

class UnionMemory;

struct PairsResult {
  ContactClass contact = ContactClass::separated;  ///< of the pair that is deepest in contact
  PenetrationDepth nearest;  ///< the answer of the deepest, or the first touching, or the nearest pair
  std::int32_t part_a = 0;
  std::int32_t part_b = 0;
  bool remembered = false;  ///< the pair that told the class last did so again
};

/// Asks every pair of parts whose boxes allow a say. Ties go to the first pair.
/// @param memory  nullptr, or the last frame's: the pair that told the class then is asked first. Of polytopes that one
///                overlapping pair is enough for the class, and `nearest` need not be the deepest.
[[nodiscard]] PairsResult classify_pairs(const UnionPair& pair, Scratch& scratch, double delta,
                                         const UnionMemory* memory, UnionStatistics& work);

/// A length within which a placement is free: that of the last frame's way out or a little more, where it is free now,
/// else `box_exit`.
[[nodiscard]] double free_reach(const UnionPair& pair, const UnionMemory& memory, Scratch& scratch);

}  // namespace pd::detail
