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

struct PairsResult {
  ContactClass contact = ContactClass::separated;  ///< of the pair that is deepest in contact
  PenetrationDepth nearest;  ///< the answer of the deepest, or the first touching, or the nearest pair
  std::int32_t part_a = 0;
  std::int32_t part_b = 0;
};

/// Asks every pair of parts whose boxes allow a say. Ties go to the first pair.
[[nodiscard]] PairsResult classify_pairs(const UnionPair& pair, Scratch& scratch, double delta, UnionStatistics& work);

}  // namespace pd::detail
