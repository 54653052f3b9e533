/// @file
/// The macbeath backend of directional width queries is the hierarchy of Macbeath regions over a kernel. If the build
/// exceeds its budget of operations (`kMostMacbeathWork`), and in R^4 and R^5 for a kernel of 256 points or fewer, the
/// kernel is scanned instead: the answers keep their epsilon, a query costs a product a point, and `StructureSize`
/// shows one layer.
#pragma once

#include <memory>

#include "dimension/backends/width_structure.hpp"

namespace pd::dimension::detail {

/// @param epsilon  in [2e-7, 1) for D < 4, in [8e-7, 1) above: .5 or .125 of it goes into the kernel, the rest into the
///                 hierarchy.
/// @return bad_value ("epsilon").
[[nodiscard]] Expected<std::shared_ptr<const WidthStructure>> macbeath_structure(const AnyBody& body, double epsilon);

}  // namespace pd::dimension::detail
