#include "collision_table.hpp"

namespace pd::detail {

mjfCollision& ReplacedEntries::entry_of(int first, int second, ReplacedEntries* above) {
  mjfCollision& entry = mjCOLLISIONFUNC[first][second];
  const bool covered = above != nullptr && above->active_ && entry == above->function_;
  return covered ? above->before_[first][second] : entry;
}

int ReplacedEntries::put(mjfCollision function, ReplacedEntries* above) {
  int count = 0;
  for (int first = 0; first < mjNGEOMTYPES; ++first) {
    for (int second = first; second < mjNGEOMTYPES; ++second) {
      mjfCollision& entry = entry_of(first, second, above);
      if (!is_convex_pair(first, second) || entry == nullptr) continue;
      mjfCollision& before = before_[first][second];
      if (active_ && before != nullptr && entry != function && entry != before) continue;
      if (entry != function) {
        before = entry;
        entry = function;
      }
      ++count;
    }
  }
  active_ = true;
  function_ = function;
  return count;
}

void ReplacedEntries::put_back(ReplacedEntries* above) {
  if (!active_) return;
  for (int first = 0; first < mjNGEOMTYPES; ++first) {
    for (int second = first; second < mjNGEOMTYPES; ++second) {
      mjfCollision& entry = entry_of(first, second, above);
      if (entry == function_) entry = before_[first][second];
    }
  }
  active_ = false;
}

}  // namespace pd::detail
