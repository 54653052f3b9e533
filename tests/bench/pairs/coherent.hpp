/// @file
/// Coherent frames: two bodies turn a little from frame to frame at about the same depth, and every solver that can
/// remember the pair does. Every frame of every solver is judged.
#pragma once

#include <string>
#include <vector>

#include "bench/measure/table.hpp"
#include "bench/pairs/pair_source.hpp"

namespace pd::bench {

/// One sequence: bodies of a family, radians a frame, and the share of the size that the bodies overlap by (at most).
struct Sequence {
  scenes::PairFamily family;
  int vertices;
  double step_radians;
  double depth_share;
};

/// The sequences of the shapes in `families` and `vertices` (both empty = all).
[[nodiscard]] Expected<std::vector<Sequence>> choose_sequences(const std::vector<std::string>& families,
                                                               const std::vector<int>& vertices, bool quick);

struct CoherentRow {
  std::string family;
  int vertices = 0;
  double step_radians = 0;
  double depth_share = 0;
  std::string solver;
  int frames = 0;
  double p50_ns = kUnknown;
  double p99_ns = kUnknown;
  double ratio_to_bullet = kUnknown;      ///< p50 over that of Bullet's EPA in the same sequence
  double p99_ratio_to_bullet = kUnknown;  ///< the same of p99
  int wrong = 0;
  double worst_error = 0;  ///< relative to the depth
  int longest_wrong_run = 0;
  double warm_share = 0;  ///< frames answered from the memory of the pair
  double allocations = 0;
};

struct CoherentSettings {
  std::vector<Sequence> sequences;
  int frames = 200;
  std::uint64_t seed = 0;
};

/// All sequences, printed as they come, and a summary over all of them for each solver.
[[nodiscard]] std::vector<CoherentRow> run_coherent(const CoherentSettings& settings, Solvers& solvers);

/// Columns
/// family,vertices,step,depth,solver,frames,p50_ns,p99_ns,ratio_to_bullet,p99_ratio_to_bullet,wrong,worst_error,
/// longest_wrong_run,warm_share,allocations.
[[nodiscard]] std::string to_csv(const std::vector<CoherentRow>& rows);

}  // namespace pd::bench
