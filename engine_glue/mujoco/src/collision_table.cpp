#include "collision_table.hpp"

namespace pd::detail {

int ReplacedEntries::put(mjfCollision function) {
  active_ = true;
  int count = 0;
  for (int first = 0; first < mjNGEOMTYPES; ++first) {
    for (int second = first; second < mjNGEOMTYPES; ++second) {
      mjfCollision& entry = mjCOLLISIONFUNC[first][second];
      if (!is_convex_pair(first, second) || entry == nullptr) continue;
      if (entry != function) {
        before_[first][second] = entry;
        entry = function;
      }
      ++count;
    }
  }
  return count;
}

void ReplacedEntries::put_back(mjfCollision function) {
  active_ = false;
  for (int first = 0; first < mjNGEOMTYPES; ++first) {
    for (int second = first; second < mjNGEOMTYPES; ++second) {
      mjfCollision& entry = mjCOLLISIONFUNC[first][second];
      if (entry == function) entry = before_[first][second];
    }
  }
}

}  // namespace pd::detail
