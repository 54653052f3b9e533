/// @file
/// Shapes of one step of a world: converted once, and compared once a step.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <cstdint>
#include <memory>

#include "pd/bullet/shape_cache.hpp"
#include "shapes/cached_shape.hpp"

namespace pd::detail {

struct StepShapes {
  BulletShapeCache& cache;
  std::uint64_t stamp;  ///< of this step of this world (`BulletShapeCache::find`), 0: unknown

  [[nodiscard]] std::shared_ptr<CachedShape> find(const btConvexShape& shape) const { return cache.find(shape, stamp); }

  /// Brings up to date what a shape that is no triangle was converted to. `known`: as found earlier, or null.
  void refresh(const btConvexShape& shape, std::shared_ptr<CachedShape>& known) const {
    // The signature of a box is all that there is to compare. Others are compared without a look into the cache.
    const auto same = [&] {
      return shape.getShapeType() == BOX_SHAPE_PROXYTYPE ||
             (stamp != 0 && known->compared.load(std::memory_order_relaxed) == stamp) ||
             known->has_content(shape_fingerprint(shape), stamp);
    };
    if (!known || known->source != &shape || known->signature != shape_signature(shape) || !same()) known = find(shape);
  }
};

}  // namespace pd::detail
