/// @file
/// An entry of the shape cache: what a Bullet shape was converted to, and when it was last compared.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// A triangle by content: its corners and its margin.
using TriangleKey = std::array<btScalar, 10>;

struct CachedShape {
  const btCollisionShape* source = nullptr;  ///< compared, never read
  std::uint64_t fingerprint = 0;
  std::uint64_t signature = 0;
  std::optional<TriangleKey> triangle;       ///< of a btTriangleShape, which has no address that lasts
  std::shared_ptr<const ConvexShape> body;   ///< null: the shape has none
  std::shared_ptr<const ConvexShape> sharp;  ///< of a btBoxShape: as a partner of another one
  Error refusal{ErrorCode::unsupported, {}, {}};
  std::atomic<bool> used{false};           ///< found since the cache last looked for entries to drop
  std::atomic<std::uint64_t> compared{0};  ///< the stamp under which all points were last compared

  /// True if the shape has this fingerprint. The stamp is then noted as the one under which all points were compared.
  bool has_content(std::uint64_t now, std::uint64_t stamp) {
    if (fingerprint == now) compared.store(stamp, std::memory_order_relaxed);
    return fingerprint == now;
  }
  /// The body as Bullet's contacts take it beside another one: two boxes are sharp. Requires a body.
  [[nodiscard]] const ConvexShape& beside(const CachedShape& other) const {
    return sharp && other.sharp ? *sharp : *body;
  }
};

/// Converts a shape without a cache.
[[nodiscard]] std::shared_ptr<CachedShape> converted(const btConvexShape& shape);

}  // namespace pd::detail
