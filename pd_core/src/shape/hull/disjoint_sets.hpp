/// @file
/// Disjoint sets of 0 .. n - 1 with path halving; the lowest member names the set.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace pd::detail {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t find(std::int32_t i) {
    while (parent(i) != i) {
      parent(i) = parent(parent(i));
      i = parent(i);
    }
    return i;
  }
  void unite(std::int32_t i, std::int32_t j) {
    i = find(i);
    j = find(j);
    if (i < j) {
      parent(j) = i;
    } else {
      parent(i) = j;
    }
  }

 private:
  std::int32_t& parent(std::int32_t i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<std::int32_t> parent_;
};

}  // namespace pd::detail
