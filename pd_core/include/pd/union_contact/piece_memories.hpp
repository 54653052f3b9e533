/// @file
/// A pair with a mesh or compound has a memory of every two pieces, which is handed from step to step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pd/numeric/language.hpp"

namespace pd {

/// The memories that a step asks for take the place of last step's. All others are forgotten, so that there are never
/// more than pieces met in one step.
///
/// @tparam Memory  of two pieces, with their number (`pieces`), `met` and `parted`, which a step sets anew.
template <class Memory>
class PieceMemories {
 public:
  void begin() {
    fresh_.clear();
    next_ = 0;
  }

  /// Taken from last step's memories, or new. Valid until the next is taken.
  /// @param old  sorted by number
  Memory& take(std::vector<Memory>& old, std::uint64_t number) {
    auto found = old.begin() + static_cast<std::ptrdiff_t>(std::min(next_, old.size()));
    if (found == old.end() || found->pieces != number) {
      found = std::lower_bound(old.begin(), old.end(), number,
                               [](const Memory& x, std::uint64_t n) { return x.pieces < n; });
    }
    if (found != old.end() && found->pieces == number) {
      next_ = static_cast<std::size_t>(found - old.begin()) + 1;
      fresh_.push_back(std::move(*found));
      found->met = false;  // its number is still there for the search for the next
      found->parted.forget();
    } else {
      fresh_.emplace_back();
      fresh_.back().pieces = number;
    }
    return fresh_.back();
  }

  /// Finds a memory in place, without `take` and `end`, for a step that asks few again and keeps all others. Null:
  /// none.
  static Memory* find(std::vector<Memory>& all, std::uint64_t number) {
    const auto found =
        std::lower_bound(all.begin(), all.end(), number, [](const Memory& x, std::uint64_t n) { return x.pieces < n; });
    return found != all.end() && found->pieces == number ? &*found : nullptr;
  }

  /// Puts the memories that were taken in place of the old ones. Hosts may give several triangles one number: these
  /// keep the order in which they were met.
  void end(std::vector<Memory>& old) {
    const auto earlier = [](const Memory& x, const Memory& y) { return x.pieces < y.pieces; };
    if (!std::is_sorted(fresh_.begin(), fresh_.end(), earlier)) {
      std::stable_sort(fresh_.begin(), fresh_.end(), earlier);
    }
    old.swap(fresh_);
  }

 private:
  std::vector<Memory> fresh_;
  std::size_t next_ = 0;  ///< most steps ask in last step's order
};

}  // namespace pd
