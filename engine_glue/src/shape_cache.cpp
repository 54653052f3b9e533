#include "pd/bullet/shape_cache.hpp"

#include <algorithm>
#include <mutex>

namespace pd {

BulletShapeCache::BulletShapeCache(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)) {}

std::shared_ptr<const ConvexShape> BulletShapeCache::find_or_convert(const btConvexShape& shape) {
  const auto convert = [&]() -> std::shared_ptr<const ConvexShape> {
    conversions_.fetch_add(1, std::memory_order_relaxed);
    auto body = to_convex_shape(shape);
    return body ? std::make_shared<const ConvexShape>(std::move(body).value()) : nullptr;
  };
  if (shape.getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    return convert();
  }
  const std::uint64_t fingerprint = shape_fingerprint(shape);
  const std::uint64_t now = clock_.fetch_add(1, std::memory_order_relaxed);
  {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(&shape);
    if (found != entries_.end() && found->second.fingerprint == fingerprint) {
      found->second.last_use.store(now, std::memory_order_relaxed);
      return found->second.body;
    }
  }
  // Converted outside the lock: readers of other shapes go on. Two threads may convert the same shape; both get equal
  // bodies.
  auto body = convert();
  const std::unique_lock lock(mutex_);
  const auto present = entries_.find(&shape);
  if (present != entries_.end()) {
    if (present->second.fingerprint == fingerprint) {
      return present->second.body;  // another thread was first: one body for all, so that warm pairs recognise it
    }
    entries_.erase(present);
  }
  if (entries_.size() >= capacity_) {
    entries_.erase(std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
      return a.second.last_use.load(std::memory_order_relaxed) < b.second.last_use.load(std::memory_order_relaxed);
    }));
  }
  entries_.try_emplace(&shape, fingerprint, body, now);
  return body;
}

void BulletShapeCache::forget(const btCollisionShape* shape) {
  const std::unique_lock lock(mutex_);
  entries_.erase(shape);
}

void BulletShapeCache::clear() {
  const std::unique_lock lock(mutex_);
  entries_.clear();
}

std::size_t BulletShapeCache::size() const {
  const std::shared_lock lock(mutex_);
  return entries_.size();
}

}  // namespace pd
