/// @file
/// The program's operator new: counts, and can be told to fail.
#pragma once

#include <cstdint>

namespace pd::test {

/// All so far.
[[nodiscard]] std::int64_t allocations();

/// From now on the n-th allocation throws std::bad_alloc, once; 0: none does.
/// @return whether the last one that was to fail did
bool fail_allocation(std::int64_t n);

}  // namespace pd::test
