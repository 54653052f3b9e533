/// @file
/// Polytopes apart: how far, and whether by more than half of the gap, from frame to frame and from nothing.
///
/// A random line of centres, along which the second body is moved until the gap is what the row says (1, 10 or 100 % of
/// the smaller body's least extent): whatever features happen to be closest. Then both bodies turn a little from frame
/// to frame, the gap found anew each time.
#pragma once

#include "bench/measure/table.hpp"
#include "bench/pairs/standing.hpp"

namespace pd::bench {

struct ApartCell {
  scenes::PairFamily family;
  int vertices;
  double gap_share;
};

/// The cells of `families` and `vertices` (both empty = all); `quick`: up to 128 vertices.
[[nodiscard]] Expected<std::vector<ApartCell>> choose_apart(const std::vector<std::string>& families,
                                                            const std::vector<int>& vertices, bool quick);

/// Frames of one pair. Requires solids.
[[nodiscard]] std::vector<Standing> frames_apart(const Bodies& bodies, double gap_share, int count,
                                                 scenes::Random& random);

/// Right: a distance within kTolerance of the exact one, on the numbers that the solver received; or "farther" where
/// the exact distance exceeds the limit. The plane across the solver's own direction bounds the distance from below
/// over all vertices, the exact oracle over the vertices nearest to that plane from above; where the two do not settle
/// it, the exact oracle over the whole bodies does.
class ApartJudge {
 public:
  explicit ApartJudge(const Bodies& bodies) : bodies_(bodies) {}
  /// @return the relative error; 1 where the answer is wrong outright.
  [[nodiscard]] double error(const Answer& answer, const Standing& at, double limit, Precision precision) const;

 private:
  const Bodies& bodies_;
};

struct ApartSettings {
  std::vector<ApartCell> cells;
  int pairs = 24;
  std::uint64_t seed = 0;
};

/// All cells, printed as they come. The ratios are to Bullet's pair detector.
[[nodiscard]] std::vector<Row> run_apart(const ApartSettings& settings, Solvers& solvers);

}  // namespace pd::bench
