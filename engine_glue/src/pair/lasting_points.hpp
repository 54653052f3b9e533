/// @file
/// Points of a manifold that go on, all written together. In the commonest step all points of the last one go on in
/// their places.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <array>
#include <cstdint>

#include "pair/manifold_points.hpp"
#include "pair/pair_registry.hpp"

namespace pd::detail {

/// Entries of a manifold that go on, ascending, and the new point that each goes on as.
struct LastingPoints {
  int count = 0;
  std::array<int, 4> entries;
  std::array<int, 4> points;
  void add(int entry, int point) {
    entries[count] = entry;
    points[count++] = point;
  }
};

/// Whether as many points come as there are, all near enough, and memory knows the old ones.
[[nodiscard]] bool may_all_last(const btPersistentManifold& manifold, const PairMemory& memory,
                                const FreshPoints& fresh, const btManifoldResult& result);

/// True if all new points have the old ones' features, wherever they are. Requires as many as there are.
/// @param all  set to them
[[nodiscard]] bool order_by_feature(const PairMemory& memory, const FreshPoints& fresh, LastingPoints& all);

/// Whether the new points are known to lie within the breaking threshold of the old ones, or not to matter.
enum class PlacesKnown : std::uint8_t { no, yes };

/// Writes points that go on as Bullet would, one by one and bit for bit, but all at once. Requires that they are within
/// the breaking threshold, that `points_are_alike`, and that memory knows the entries by their numbers.
/// @return false: one may have moved too far to be the same, and nothing has changed.
bool replace_lasting_points(const PointsOfStep& step, const LastingPoints& lasting, PlacesKnown known);

}  // namespace pd::detail
