/// @file
/// The support of P as far as double-double tells, for searches that take another vertex for what it is: one of P.
#pragma once

#include "numeric/double_double.hpp"
#include "shape/posed_pair.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

/// A vertex among the farthest.
/// @param direction  about a unit vector.
[[nodiscard]] VertexPair support_double_double(const PosedPair& pair, const Vec3DD& direction);

}  // namespace pd::detail
