/// @file
/// The contacts of compounds of convex children, with each other or with a convex body.
#pragma once

#include <memory>

#include "union/union_algorithm.hpp"

namespace pd::detail {

/// Bullet's own algorithms give every pair of children a manifold of its own, so that parts of one face fight over a
/// body, and offer no child before its box overlaps the other body's, so that what is fast is inside before anything
/// touches. Here children meet within the breaking threshold. Pairs with a child that is not convex or has no exact
/// form are left to Bullet's.
[[nodiscard]] std::unique_ptr<UnionContacts> compound_contacts();

}  // namespace pd::detail
