/// @file
/// Log-log pictures of the growths behind a table of claims.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/measure/claims.hpp"

namespace pd::bench {

/// One PNG for each claim and counter with growths of three points or more, its families as lines with their fitted
/// exponents. @return false where a file could not be written (it is named on stderr).
[[nodiscard]] bool write_claim_plots(const std::vector<Finding>& findings, const std::filesystem::path& folder);

}  // namespace pd::bench
