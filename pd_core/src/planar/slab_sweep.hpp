/// @file
/// The sweep that makes DirectionSlabs: which pieces are neighbours along d at some place, and an order of all of them.
#pragma once

#include <set>
#include <vector>

#include "planar/direction_slabs.hpp"

namespace pd::detail {

class SlabSweep {
 public:
  explicit SlabSweep(DirectionSlabs& slabs);

  /// Numbers the pieces so that whatever is behind has the smaller number, and keeps every state of the sweep.
  void run();

 private:
  struct Behind {
    const SlabSweep* sweep;
    bool operator()(std::int32_t a, std::int32_t b) const { return a != b && sweep->compare(a, b) < 0; }
  };
  /// Order along d of two pieces that stand over one column.
  [[nodiscard]] int compare(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] DirectionSlabs::End low_end(std::int32_t piece, bool high) const;
  void sweep_once();
  void number_pieces();
  void keep_states();

  DirectionSlabs& slabs_;
  std::vector<std::vector<std::int32_t>> starting_, ending_;  ///< per event
  std::vector<std::vector<std::int32_t>> ahead_;              ///< per piece: neighbours ahead of it
};

}  // namespace pd::detail
