#include "rollback/world_objects.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <functional>

namespace pd::detail {

/// Bullet numbers rigid bodies as they are made, in a private member that no function returns. Access is not checked
/// where a template is instantiated explicitly, which gives this function its body.
int number_of(const btRigidBody& body);

template <int btRigidBody::*kNumber>
struct NumberOfBody {
  friend int number_of(const btRigidBody& body) { return body.*kNumber; }
};
template struct NumberOfBody<&btRigidBody::m_debugBodyId>;

WorldObjects::Noted WorldObjects::noted(const btCollisionObject& object) {
  const btBroadphaseProxy* const proxy = object.getBroadphaseHandle();
  const btRigidBody* const body = btRigidBody::upcast(&object);
  return {&object, object.getCollisionShape(), proxy != nullptr ? proxy->getUid() : -1,
          body != nullptr ? number_of(*body) : -1};
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
    if (!now.is(before)) return false;
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
    if (old != before.end() && old->is(object)) {
      kept.push_back(object.object);
    }
  }
  return kept;
}

}  // namespace pd::detail
