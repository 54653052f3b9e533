/// @file
/// u, the unit in which every error bound of this core is derived.
#pragma once

namespace pd::detail {

/// Half the distance from 1 to the next double: a rounded sum, product, quotient or root of doubles is the exact one
/// times (1 + e) with |e| <= u, unless it under- or overflows.
inline constexpr double kUnitRoundoff = 0x1p-53;

}  // namespace pd::detail
