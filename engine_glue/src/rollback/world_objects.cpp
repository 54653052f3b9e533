#include "rollback/world_objects.hpp"

#include <algorithm>
#include <functional>

namespace pd::detail {

WorldObjects::Noted WorldObjects::noted(const btCollisionObject& object) {
  const btBroadphaseProxy* const proxy = object.getBroadphaseHandle();
  return {&object, object.getCollisionShape(), proxy != nullptr ? proxy->getUid() : -1};
}

void WorldObjects::note(const btCollisionWorld& world) {
  const btCollisionObjectArray& present = world.getCollisionObjectArray();
  objects_.resize(static_cast<std::size_t>(present.size()));
  for (int i = 0; i < present.size(); ++i) objects_[static_cast<std::size_t>(i)] = noted(*present[i]);
}

bool WorldObjects::same(const btCollisionWorld& world, Shapes shapes) const {
  const btCollisionObjectArray& present = world.getCollisionObjectArray();
  if (static_cast<std::size_t>(present.size()) != objects_.size()) return false;
  for (int i = 0; i < present.size(); ++i) {
    const Noted& before = objects_[static_cast<std::size_t>(i)];
    const Noted now = noted(*present[i]);
    if (now.object != before.object || now.number != before.number) return false;
    if (shapes == Shapes::compared && now.shape != before.shape) return false;
  }
  return true;
}

std::vector<const btCollisionObject*> WorldObjects::renew(const btCollisionWorld& world) {
  const auto by_address = [](const Noted& a, const Noted& b) { return std::less<>()(a.object, b.object); };
  std::vector<Noted> before = std::move(objects_);
  note(world);
  std::vector<Noted> now = objects_;
  std::sort(before.begin(), before.end(), by_address);
  std::sort(now.begin(), now.end(), by_address);
  std::vector<const btCollisionObject*> kept;
  auto old = before.begin();
  for (const Noted& object : now) {
    while (old != before.end() && by_address(*old, object)) ++old;
    if (old != before.end() && old->object == object.object && old->number == object.number) {
      kept.push_back(object.object);
    }
  }
  return kept;
}

}  // namespace pd::detail
