/// @file
/// Bullet shapes converted once: a bounded table from shape to convex body, read by every thread of the dispatcher.
///
/// Bullet tells nobody when a shape is scaled, edited or freed (and its address used again). So every look-up compares
/// the shape's present fingerprint with that of its entry (`shape_fingerprint`: type, margin, scaling, every point) and
/// converts afresh when they differ; a shape that died is never read, and its entry leaves when the table is full
/// (least recently used first) or by `forget`.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <unordered_map>

#include "pd/bullet/shape_conversion.hpp"

namespace pd {

class BulletShapeCache {
 public:
  /// @param capacity  entries kept, at least 1.
  explicit BulletShapeCache(std::size_t capacity = 4096);

  /// The body of `shape`, or nullptr where it has none (`to_convex_shape` says why). Shared with the cache: it stays
  /// valid for as long as the caller holds it, whatever becomes of the entry.
  /// Safe from any number of threads, as long as the shape itself is not changed meanwhile (Bullet asks the same). The
  /// triangles that Bullet makes on the stack for meshes and heightfields are converted without an entry.
  [[nodiscard]] std::shared_ptr<const ConvexShape> find_or_convert(const btConvexShape& shape);

  /// Drops the entry of a shape, if there is one; the shape itself is not read.
  void forget(const btCollisionShape* shape);
  /// Drops every entry.
  void clear();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Conversions so far: first sights, and entries whose shape had changed.
  [[nodiscard]] std::int64_t conversions() const { return conversions_.load(std::memory_order_relaxed); }

 private:
  struct Entry {
    Entry(std::uint64_t print, std::shared_ptr<const ConvexShape> converted, std::uint64_t now)
        : fingerprint(print), body(std::move(converted)), last_use(now) {}
    std::uint64_t fingerprint;
    std::shared_ptr<const ConvexShape> body;  ///< null: known to have none
    std::atomic<std::uint64_t> last_use;
  };

  const std::size_t capacity_;
  mutable std::shared_mutex mutex_;
  std::unordered_map<const btCollisionShape*, Entry> entries_;  // looked up only; never iterated into a result
  std::atomic<std::uint64_t> clock_{0};
  std::atomic<std::int64_t> conversions_{0};
};

}  // namespace pd
