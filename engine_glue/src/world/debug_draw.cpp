#include "pd/bullet/debug_draw.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace pd {
namespace {

const btVector3 kDeep(btScalar(0.85), btScalar(0.1), btScalar(0.1));
const btVector3 kApart(btScalar(0.1), btScalar(0.3), btScalar(0.85));
const btVector3 kNormal(btScalar(0.95), btScalar(0.65), btScalar(0));

/// Points of a manifold in order around its first normal.
using Ring = std::array<const btManifoldPoint*, MANIFOLD_CACHE_SIZE>;

Ring around(const btPersistentManifold& manifold) {
  const auto count = static_cast<std::size_t>(manifold.getNumContacts());
  Ring ring{};
  btVector3 middle(0, 0, 0);
  for (std::size_t i = 0; i < count; ++i) {
    ring[i] = &manifold.getContactPoint(static_cast<int>(i));
    middle += ring[i]->getPositionWorldOnB() / btScalar(count);
  }
  btVector3 x, y;
  btPlaneSpace1(ring[0]->m_normalWorldOnB, x, y);
  const auto angle = [&](const btManifoldPoint* point) {
    const btVector3 arm = point->getPositionWorldOnB() - middle;
    return std::atan2(arm.dot(y), arm.dot(x));
  };
  std::stable_sort(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(count),
                   [&](const auto* a, const auto* b) { return angle(a) < angle(b); });
  return ring;
}

void draw_arrow(const btVector3& from, const btVector3& along, btIDebugDraw& drawer) {
  const btVector3 tip = from + along;
  drawer.drawLine(from, tip, kNormal);
  btVector3 aside, other;
  btPlaneSpace1(along.normalized(), aside, other);
  const btScalar barb = btScalar(0.2);
  for (const btScalar side : {barb, -barb}) {
    drawer.drawLine(tip, tip - barb * along + side * btScalar(0.5) * along.length() * aside, kNormal);
  }
}

void draw(const btPersistentManifold& manifold, btIDebugDraw& drawer, const ContactDrawing& drawing) {
  const auto count = static_cast<std::size_t>(manifold.getNumContacts());
  const Ring ring = around(manifold);
  const btManifoldPoint& deepest =
      **std::min_element(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(count),
                         [](const auto* a, const auto* b) { return a->getDistance() < b->getDistance(); });
  for (std::size_t i = 0; i < count; ++i) {
    const btManifoldPoint& point = *ring[i];
    const btVector3& color = point.getDistance() < 0 ? kDeep : kApart;
    const btVector3& on_b = point.getPositionWorldOnB();
    const btVector3 depth = point.m_normalWorldOnB * point.getDistance() * btScalar(drawing.depth_scale);
    drawer.drawLine(on_b, on_b + depth, color);
    // Two points have one line between them, and one point has none.
    if (count > 2 || (count == 2 && i == 0)) drawer.drawLine(on_b, ring[(i + 1) % count]->getPositionWorldOnB(), color);
  }
  draw_arrow(deepest.getPositionWorldOnB(), deepest.m_normalWorldOnB * btScalar(drawing.normal_length), drawer);
  if (!drawing.text) return;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", -static_cast<double>(deepest.getDistance()));
  drawer.draw3dText(deepest.getPositionWorldOnB(), text.data());
}

}  // namespace

void draw_contacts(btCollisionWorld& world, btIDebugDraw& drawer, const ContactDrawing& drawing) {
  btDispatcher& dispatcher = *world.getDispatcher();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() > 0) draw(manifold, drawer, drawing);
  }
}

}  // namespace pd
