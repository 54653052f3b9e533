/// @file
/// The triangles that Bullet makes on the stack for meshes and heightfields, converted once each: a table of fixed
/// size, found by content. A triangle of the same corners and margin is the same body, so nothing here can be stale.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "cached_shape.hpp"

namespace pd::detail {

/// Belongs to one thread's buffers. A new triangle takes the place of the one that its hash shares a slot with.
class TriangleCache {
 public:
  static constexpr std::size_t kSlots = 2048;

  /// The triangle's body, made by `convert` where it is not here yet.
  template <class Convert>
  const std::shared_ptr<CachedShape>& find(const btTriangleShape& triangle, Convert&& convert) {
    Key key{};
    for (int i = 0; i < 3; ++i) {
      const btVector3& corner = triangle.getVertexPtr(i);
      key[3 * i] = corner.x();
      key[3 * i + 1] = corner.y();
      key[3 * i + 2] = corner.z();
    }
    key[9] = triangle.getMargin();
    if (slots_.empty()) {
      slots_.resize(kSlots);
    }
    Slot& slot = slots_[hash(key) % kSlots];
    // By bits: 0 and -0 are two triangles here, and a corner that is not a number equals itself.
    if (!slot.shape || std::memcmp(slot.key.data(), key.data(), sizeof(Key)) != 0) {
      slot.shape = convert(triangle);
      slot.key = key;
      ++conversions_;
    }
    return slot.shape;
  }

  [[nodiscard]] std::int64_t conversions() const { return conversions_; }

 private:
  using Key = std::array<btScalar, 10>;
  struct Slot {
    Key key{};
    std::shared_ptr<CachedShape> shape;
  };

  static std::uint64_t hash(const Key& key) {
    std::uint64_t result = 0xCBF29CE484222325ULL;
    for (const btScalar x : key) {
      std::uint64_t word = 0;
      std::memcpy(&word, &x, sizeof(x));
      result = (result ^ word) * 0x9E3779B97F4A7C15ULL;
      result ^= result >> 32;
    }
    return result;
  }

  std::vector<Slot> slots_;
  std::int64_t conversions_ = 0;
};

}  // namespace pd::detail
