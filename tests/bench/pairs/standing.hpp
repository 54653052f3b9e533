/// @file
/// Frames of one pair, measured: every solver on the same frames in turns, from frame to frame and from nothing.
#pragma once

#include <functional>
#include <string>

#include "bench/measure/table.hpp"
#include "bench/pairs/pair_source.hpp"
#include "bench/pairs/pairs.hpp"

namespace pd::bench {

struct Standing {
  Pose a;
  Pose b;
  double gap = 0;  ///< that was wanted; minus the depth of bodies that overlap

  /// What "apart by more than this?" is asked with.
  [[nodiscard]] double limit() const { return gap / 2; }
};

/// The relative error of an answer; 1 where it is wrong outright.
using FrameJudge = std::function<double(const Answer&, const Standing&, Precision)>;

/// Adds to `tallies`, one for each solver. Frame 0 grows buffers and makes the memories; the others are timed, every
/// pass from fresh memories. Solvers marked in `sits_out` (empty: none) are not run.
void measure_frames(const Bodies& bodies, const std::vector<Standing>& frames, Solvers& solvers,
                    const FrameJudge& error, std::vector<Tally>& tallies, const std::vector<char>& sits_out = {});

}  // namespace pd::bench
