/// @file
/// What a search among the P_ij takes from the last frame and leaves for the next (`WarmUnion`).
///
/// Parts are remembered by the caller's names. The search itself orders parts and bodies by content, which poses may
/// change from frame to frame: bodies exchanged turn P into -P, and cubes into their mirror images.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compound/part_pairs.hpp"

namespace pd::detail {

/// A cube of the last search.
struct CoverNode {
  std::int32_t children = -1;  ///< the first of eight; -1: it was not halved
  std::int32_t part_a = -1;    ///< the P_ij that held it as a whole; -1: none is known
  std::int32_t part_b = -1;
};

struct CoverTree {
  double half = 0;  ///< of the first cube, which is centred at the origin (inside lengths)
  std::vector<CoverNode> nodes;
};

/// What a WarmUnion holds.
struct WarmUnionState {
  std::size_t parts_a = 0;
  std::size_t parts_b = 0;
  int scale_exponent = 0;
  bool exchanged = false;  ///< the bodies, in the search that the tree is from
  CoverTree tree;
  CoverTree next;               ///< of the search that goes on
  std::size_t least_nodes = 0;  ///< of the searches since the tree was begun
  std::int32_t pair_a = -1;     ///< the pair of parts that told the class; -1: nothing is remembered
  std::int32_t pair_b = -1;
  Vec3 way = Vec3::Zero();  ///< the last translation out (of the caller's a); 0: none
};

/// One query's view of it.
class UnionMemory {
 public:
  /// Refers to both. Starts afresh where the numbers of parts are others.
  UnionMemory(WarmUnionState& state, const UnionPair& pair, bool exchanged);

  struct Parts {
    std::size_t a, b;
  };
  /// The pair of parts that told the class last, in the pair's order.
  [[nodiscard]] std::optional<Parts> telling_pair() const;
  /// The last way out for the pair's a.
  [[nodiscard]] std::optional<Vec3> way() const;
  /// Keeps the answer, and the cubes of the search if there was one: nothing before it changes what is remembered.
  void keep(std::int32_t part_a, std::int32_t part_b, const Vec3& way);

  /// Before a search: half the side of the first cube, at least `least`.
  double begin(const PartDifferences& differences, double least);
  /// A cube of the last search, or -1; 0 is the first.
  [[nodiscard]] std::int32_t first() const { return state_.tree.nodes.empty() ? -1 : 0; }
  [[nodiscard]] bool halved(std::int32_t node) const { return node >= 0 && at(node).children >= 0; }
  [[nodiscard]] std::int32_t child(std::int32_t node, int which) const;
  /// The P_k that held it; -1: none is known.
  [[nodiscard]] std::int32_t holder(std::int32_t node) const;

  /// The same cubes of this search: 0 is the first.
  std::int32_t halve(std::int32_t record);
  void held(std::int32_t record, const PartDifference& piece);

 private:
  [[nodiscard]] const CoverNode& at(std::int32_t node) const {
    return state_.tree.nodes[static_cast<std::size_t>(node)];
  }

  WarmUnionState& state_;
  const UnionPair& pair_;
  bool exchanged_;
  bool searched_ = false;
  std::vector<std::size_t> place_a_;  ///< by the caller's name, after the exchange
  std::vector<std::size_t> place_b_;
  std::vector<std::int32_t> pieces_;  ///< the P_k by places, -1: none
};

}  // namespace pd::detail
