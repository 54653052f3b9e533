/// @file
/// The contacts of a compound of convex children with a `btStaticPlaneShape`.
#pragma once

#include <memory>

#include "union/union_algorithm.hpp"

namespace pd::detail {

/// Each child as `PlaneAlgorithm` asks a body, but for points that lie inside of other children which lead on into the
/// plane; the points of all children are chosen together. A compound with a child that is not convex or has no exact
/// form is left to Bullet's own algorithm.
[[nodiscard]] std::unique_ptr<UnionContacts> plane_contacts();

}  // namespace pd::detail
