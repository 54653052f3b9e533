/// @file
/// The macbeath backend of directional width queries: the hierarchy of Macbeath regions over a kernel. In R^4 and R^5 a
/// kernel of 256 points or fewer is scanned instead, which takes less than a descent.
#pragma once

#include <memory>

#include "pd/dimension/directional_width.hpp"

namespace pd::dimension::detail {

/// @param epsilon  in [2e-7, 1) for D < 4, in [8e-7, 1) above: .5 or .125 of it goes into the kernel, the rest into the
///                 hierarchy.
/// @return bad_value, limit_exceeded ("epsilon").
template <int D>
[[nodiscard]] Expected<std::shared_ptr<const WidthStructure<D>>> macbeath_structure(const Body<D>& body,
                                                                                    double epsilon);

}  // namespace pd::dimension::detail
