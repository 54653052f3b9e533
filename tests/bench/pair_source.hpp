/// @file
/// The pairs that are measured: which families, sizes and depths, and the bodies of each draw.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/solver.hpp"

namespace pd::bench {

/// One row of the table: a family, its size and how deep the bodies stand.
struct Cell {
  scenes::PairFamily family;
  int vertices;
  scenes::DepthClass depth;
};

struct Draw {
  Bodies bodies;
  Pose pose_a;
  Pose pose_b;
};

/// Families by name, sizes by number; both empty = all that the bench knows. `quick` leaves the dear ones out.
/// An unknown family is an Error that names it.
[[nodiscard]] Expected<std::vector<Cell>> choose_cells(const std::vector<std::string>& families,
                                                       const std::vector<int>& vertices, bool quick);

/// The pair of this number. Cubes are placed here, aligned with the axes and overlapping by exactly 1/64 or 1/8 of a
/// unit; all others are the scenes' own. Nothing where the bodies happen not to be what the cell asks for (the next
/// number is another draw).
[[nodiscard]] std::optional<Draw> draw(const Cell& cell, std::uint64_t seed, std::uint64_t number);

}  // namespace pd::bench
