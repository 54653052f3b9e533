#include "pd/bullet/shape_cache.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>
#include <mutex>

#include "shapes/cached_shape.hpp"

namespace pd {

namespace {

/// Entries of a full table that are looked at for each new one. Each look drops an entry or takes its mark of use away,
/// so that two looks for each new entry would do to keep a table from growing whose entries are used once.
constexpr int kLooks = 4;

}  // namespace

std::shared_ptr<detail::CachedShape> detail::converted(const btConvexShape& shape) {
  auto result = std::make_shared<detail::CachedShape>();
  result->source = &shape;
  auto body = to_convex_shape(shape);
  if (!body) {
    result->refusal = body.error();
    return result;
  }
  result->body = std::make_shared<const ConvexShape>(std::move(body).value());
  if (shape.getShapeType() == BOX_SHAPE_PROXYTYPE) {
    auto sharp = to_sharp_box(static_cast<const btBoxShape&>(shape));
    result->sharp = sharp ? std::make_shared<const ConvexShape>(std::move(sharp).value()) : result->body;
  }
  return result;
}

BulletShapeCache::BulletShapeCache(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)) {}

std::shared_ptr<const ConvexShape> BulletShapeCache::find_or_convert(const btConvexShape& shape) {
  return find(shape, 0)->body;
}

std::shared_ptr<detail::CachedShape> BulletShapeCache::find(const btConvexShape& shape, std::uint64_t stamp) {
  if (shape.getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    conversions_.fetch_add(1, std::memory_order_relaxed);
    return detail::converted(shape);
  }
  const std::uint64_t signature = shape_signature(shape);
  std::shared_ptr<detail::CachedShape> known;
  {
    const std::shared_lock lock(mutex_);
    const auto found = places_.find(&shape);
    if (found != places_.end() && (*found->second)->signature == signature) {
      known = *found->second;
      known->used.store(true, std::memory_order_relaxed);
      if (stamp != 0 && known->compared.load(std::memory_order_relaxed) == stamp) return known;
    }
  }
  const std::uint64_t fingerprint = shape_fingerprint(shape);
  if (known && known->has_content(fingerprint, stamp)) return known;
  auto entry = make_entry(shape, fingerprint);
  entry->signature = signature;
  entry->compared.store(stamp, std::memory_order_relaxed);
  const std::unique_lock lock(mutex_);
  const auto present = places_.find(&shape);
  if (present != places_.end()) {
    const std::shared_ptr<detail::CachedShape>& other = *present->second;
    if (other->fingerprint == fingerprint && other->signature == signature) {
      return other;  // another thread was first: one body for all, so that warm pairs recognise it
    }
    erase(&shape);
  }
  make_room();
  places_.emplace(&shape, entries_.insert(next_look_, entry));
  std::weak_ptr<detail::CachedShape>& like = by_content_[fingerprint];
  if (like.expired()) like = entry;
  return entry;
}

std::shared_ptr<detail::CachedShape> BulletShapeCache::make_entry(const btConvexShape& shape,
                                                                  std::uint64_t fingerprint) {
  std::shared_ptr<detail::CachedShape> like;
  {
    const std::shared_lock lock(mutex_);
    const auto found = by_content_.find(fingerprint);
    if (found != by_content_.end()) like = found->second.lock();
  }
  std::shared_ptr<detail::CachedShape> entry;
  if (like) {
    entry = std::make_shared<detail::CachedShape>();
    entry->source = &shape;
    entry->body = like->body;
    entry->sharp = like->sharp;
    entry->refusal = like->refusal;
  } else {
    // Outside the lock: readers of other shapes go on. Two threads may convert the same shape; both get equal bodies.
    conversions_.fetch_add(1, std::memory_order_relaxed);
    entry = detail::converted(shape);
  }
  entry->fingerprint = fingerprint;
  return entry;
}

void BulletShapeCache::erase(const btCollisionShape* shape) {
  const auto found = places_.find(shape);
  if (found == places_.end()) return;
  const Entries::iterator place = found->second;
  const auto like = by_content_.find((*place)->fingerprint);
  if (like != by_content_.end() && like->second.lock() == *place) by_content_.erase(like);
  places_.erase(found);
  const bool is_next = next_look_ == place;
  const Entries::iterator next = entries_.erase(place);
  if (is_next) next_look_ = next;
}

void BulletShapeCache::make_room() {
  for (int look = 0; look < kLooks && entries_.size() >= capacity_; ++look) {
    if (next_look_ == entries_.end()) next_look_ = entries_.begin();
    const std::shared_ptr<detail::CachedShape>& entry = *next_look_;
    // A pair holds the entries of its shapes, and does not ask for them in each step.
    const bool held = entry.use_count() > 1;
    if (entry->used.exchange(false, std::memory_order_relaxed) || held) {
      ++next_look_;
    } else {
      erase(entry->source);
    }
  }
}

void BulletShapeCache::forget(const btCollisionShape* shape) {
  const std::unique_lock lock(mutex_);
  erase(shape);
}

void BulletShapeCache::clear() {
  const std::unique_lock lock(mutex_);
  places_.clear();
  entries_.clear();
  next_look_ = entries_.end();
  by_content_.clear();
}

std::size_t BulletShapeCache::size() const {
  const std::shared_lock lock(mutex_);
  return entries_.size();
}

}  // namespace pd
