/// @file
/// The triangles that Bullet makes on the stack for meshes and heightfields, converted once each: a table of fixed
/// size, found by content. A triangle of the same corners and margin is the same body, so nothing here can be stale.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "shapes/cached_shape.hpp"
#include "shapes/mixed_bits.hpp"

namespace pd::detail {

/// Belongs to one thread's buffers. A new triangle takes the place of the one that its hash shares a slot with.
class TriangleCache {
 public:
  static constexpr std::size_t kSlots = 2048;

  /// Puts the triangle's body into `known`, made by `convert` where neither that nor the table has it yet.
  template <class Convert>
  void find(const btTriangleShape& triangle, std::shared_ptr<CachedShape>& known, Convert&& convert) {
    TriangleKey key{};
    for (int i = 0; i < 3; ++i) {
      const btVector3& corner = triangle.getVertexPtr(i);
      key[3 * i] = corner.x();
      key[3 * i + 1] = corner.y();
      key[3 * i + 2] = corner.z();
    }
    key[9] = triangle.getMargin();
    if (holds(known, key)) return;
    if (slots_.empty()) {
      slots_.resize(kSlots);
    }
    std::shared_ptr<CachedShape>& slot = slots_[HashOfArray()(key) % kSlots];
    if (!holds(slot, key)) {
      slot = convert(triangle);
      slot->triangle = key;
      ++conversions_;
    }
    known = slot;
  }

  [[nodiscard]] std::int64_t conversions() const { return conversions_; }

 private:
  /// By bits: 0 and -0 are two triangles here, and a corner that is not a number equals itself.
  static bool holds(const std::shared_ptr<CachedShape>& shape, const TriangleKey& key) {
    return shape && shape->triangle && std::memcmp(shape->triangle->data(), key.data(), sizeof(key)) == 0;
  }
  std::vector<std::shared_ptr<CachedShape>> slots_;
  std::int64_t conversions_ = 0;
};

}  // namespace pd::detail
