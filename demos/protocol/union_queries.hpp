/// @file
/// The queries that also answer for compounds and star-shaped bodies.
#pragma once

#include <string_view>

#include "protocol/handlers.hpp"

namespace pd::query {

/// The handler of a query for bodies that need not be convex; nullptr where it answers for convex bodies only (its own
/// reader then refuses the shape).
[[nodiscard]] Handler find_union_handler(std::string_view query);

}  // namespace pd::query
