/// @file
/// Counts every allocation of this process: `operator new`, and malloc below it where the C library lets a program
/// stand in front of it (solvers written in C never come near `operator new`).
#pragma once

#include <cstdint>

namespace pd::bench {

/// Allocations so far, of all threads.
[[nodiscard]] std::int64_t allocations();

}  // namespace pd::bench
