/// @file
/// Log-log pictures of time against vertices, each line with its fitted exponent.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/measure/table.hpp"

namespace pd::bench {

/// One PNG for each family with three sizes or more, and depth: `<family>_<depth>.png`, of the chosen solvers' p50.
/// @return false where a file could not be written (it is named on stderr).
[[nodiscard]] bool write_plots(const std::vector<Row>& rows, const std::filesystem::path& folder);

}  // namespace pd::bench
