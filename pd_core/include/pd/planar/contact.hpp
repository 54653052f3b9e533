/// @file
/// The two words that every planar question uses.
#pragma once

#include <array>
#include <string_view>

#include "pd/numeric/language.hpp"

namespace pd {

/// A point or vector of the plane.
using Point2 = std::array<double, 2>;

/// The place of a placement of Q: in R = P + (-Q), on its boundary, or outside its closure. Exact.
enum class PlanarContact { overlapping, touching, separated };
[[nodiscard]] std::string_view to_string(PlanarContact contact);

}  // namespace pd
