/// @file
/// What a pair with a mesh or compound remembers of its pieces, handed from step to step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pair_registry.hpp"

namespace pd::detail {

/// The memories that a step asks for take the place of last step's: what is not asked for is forgotten, so that there
/// are never more than pieces met in one step.
class PieceMemories {
 public:
  void begin() { fresh_.clear(); }

  /// Taken from last step's memories, or new. Valid until the next is taken.
  /// @param old  sorted by number
  PieceMemory& take(std::vector<PieceMemory>& old, std::uint64_t number) {
    const auto found = std::lower_bound(old.begin(), old.end(), number,
                                        [](const PieceMemory& x, std::uint64_t n) { return x.pieces < n; });
    if (found != old.end() && found->pieces == number) {
      fresh_.push_back(std::move(*found));
      found->met = false;  // its number is still there for the search for the next
    } else {
      fresh_.emplace_back();
      fresh_.back().pieces = number;
    }
    return fresh_.back();
  }

  /// Puts the memories that were taken in place of the old ones. Hosts may give several triangles one number: these
  /// keep the order in which they were met.
  void end(std::vector<PieceMemory>& old) {
    std::stable_sort(fresh_.begin(), fresh_.end(),
                     [](const PieceMemory& x, const PieceMemory& y) { return x.pieces < y.pieces; });
    old.swap(fresh_);
  }

 private:
  std::vector<PieceMemory> fresh_;
};

}  // namespace pd::detail
