/// @file
/// Whole numbers as places in arrays.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pd::detail {

/// Numbers of vertices, edges and the like have a sign; places have none.
constexpr std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace pd::detail
