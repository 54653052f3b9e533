/// @file
/// Bullet shapes converted once: a bounded table from shape to convex body, read by every thread of the dispatcher.
///
/// Bullet tells nobody when a shape is scaled, edited or freed (and its address used again). So a look-up compares the
/// shape's present fingerprint with that of its entry (`shape_fingerprint`: type, margin, scaling, every point) and
/// converts afresh when they differ. A shape that died is never read, and its entry leaves once the table is full or by
/// `forget`. A full table is looked through from one end to the other, a few entries for each new one: entries that
/// nobody has asked for since the last look go, and the others stay. So the table grows with the shapes of a world,
/// shrinks after it, and each new entry takes constant time. Shapes of the same fingerprint share one body: a wall of
/// equal bricks is converted once, and its queries read one body's memory. A fingerprint has 64 bits; an edit or
/// another shape that has the same one by chance is not noticed.
///
/// In a dynamics world that steps, all points are compared once a step and shape. Further look-ups of the same step
/// compare what takes no time: type, margin, scaling, sizes, the number of points and where they lie
/// (`shape_signature`). A point that is moved in place between two steps is so noticed at the next step. Detections and
/// queries of the host between two steps compare all points, for each pair anew. Where nobody tells of steps (a
/// dispatcher without a dynamics world, `BulletContacts::persistent`, this class alone) every look-up does.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <shared_mutex>
#include <unordered_map>

#include "pd/bullet/shape_conversion.hpp"

namespace pd {

namespace detail {
struct CachedShape;
}

class BulletShapeCache {
 public:
  /// @param capacity  entries kept although nobody asks for them any more, at least 1. Entries in use are kept beyond.
  explicit BulletShapeCache(std::size_t capacity = 4096);

  /// The body of `shape`, or nullptr where it has none (`to_convex_shape` says why). Shared with the cache: it stays
  /// valid for as long as the caller holds it, whatever becomes of the entry.
  /// Safe from any number of threads, as long as the shape itself is not changed meanwhile (Bullet asks the same). The
  /// triangles that Bullet makes on the stack for meshes and heightfields are converted without an entry.
  [[nodiscard]] std::shared_ptr<const ConvexShape> find_or_convert(const btConvexShape& shape);

  /// The entry of `shape`. `stamp`: a number that belongs to one step of one world, 0 where no step is known; an entry
  /// that was compared under this stamp is given out by its signature alone.
  [[nodiscard]] std::shared_ptr<detail::CachedShape> find(const btConvexShape& shape, std::uint64_t stamp);

  /// Drops the entry of a shape, if there is one; the shape itself is not read.
  void forget(const btCollisionShape* shape);
  /// Drops every entry.
  void clear();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Conversions so far: first sights, and entries whose shape had changed, of shapes like no other one at hand.
  [[nodiscard]] std::int64_t conversions() const { return conversions_.load(std::memory_order_relaxed); }

 private:
  /// An entry for the shape as it is now: the body of an equal one, or converted.
  [[nodiscard]] std::shared_ptr<detail::CachedShape> make_entry(const btConvexShape& shape, std::uint64_t fingerprint);
  /// Requires the mutex to be held.
  void erase(const btCollisionShape* shape);
  /// Looks at a few entries of a full table and drops those that nobody uses. Requires the mutex to be held.
  void make_room();

  using Entries = std::list<std::shared_ptr<detail::CachedShape>>;

  const std::size_t capacity_;
  mutable std::shared_mutex mutex_;
  Entries entries_;
  Entries::iterator next_look_ = entries_.end();  ///< entries before it were looked at last
  std::unordered_map<const btCollisionShape*, Entries::iterator> places_;
  /// By fingerprint, as long as their entries stand.
  std::unordered_map<std::uint64_t, std::weak_ptr<detail::CachedShape>> by_content_;
  std::atomic<std::int64_t> conversions_{0};
};

}  // namespace pd
