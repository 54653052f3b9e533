/// @file
/// The commonest step of a manifold: every point of the last one goes on in its place, and all are made alike.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <array>
#include <cstdint>

#include "pair/manifold_points.hpp"
#include "pair/pair_registry.hpp"

namespace pd::detail {

/// Of each entry of the manifold, the new point that it goes on as.
using PointOrder = std::array<int, 4>;

/// Whether as many points come as there are, all near enough, and memory knows the old ones.
[[nodiscard]] bool may_all_last(const btPersistentManifold& manifold, const PairMemory& memory,
                                const FreshPoints& fresh, const btManifoldResult& result);

/// Whether all new points have the old ones' features, wherever they are.
[[nodiscard]] bool order_by_feature(const PairMemory& memory, const FreshPoints& fresh, PointOrder& order);

/// Whether the new points are known to lie within the breaking threshold of the old ones, or not to matter.
enum class PlacesKnown : std::uint8_t { no, yes };

/// What `replace_points` does to points that go on, bit for bit and all at once. Requires `may_all_last`.
/// @param pieces  knows each point's numbers; nullptr: all stand in one piece, under one normal
/// @return false: one may have moved too far to be the same, and nothing has changed.
bool replace_lasting_points(btPersistentManifold& manifold, PairMemory& memory, const FreshPoints& fresh,
                            const PointOrder& order, PlacesKnown known, btScalar seconds,
                            const btManifoldResult& result, const PointSurroundings* pieces);

}  // namespace pd::detail
