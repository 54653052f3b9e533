#include "world/installation.hpp"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <bit>
#include <cstdint>
#include <memory>

#include "union/compound_contacts.hpp"
#include "union/mesh_contacts.hpp"
#include "union/plane_contacts.hpp"
#include "world/heavy_loads.hpp"

namespace pd::detail {

namespace {

/// Places of installations in the core.
constexpr std::size_t kOfOthers = 0, kOfWorlds = 1;

}  // namespace

Installation::Installation(SolverCore& core)
    : SolverInWorld(core),
      contacts(*this, {ContactTable::contacts}),
      closest(*this, {ContactTable::closest_points}),
      mesh{{*this, {mesh_contacts, false}}, {*this, {mesh_contacts, true}}},
      compound_on_plane{{*this, {plane_contacts, false}}, {*this, {plane_contacts, true}}},
      plane{{*this, {false}}, {*this, {true}}},
      compound(*this, {compound_contacts, false}),
      compound_query(*this, {}),
      persistent(this) {}

Installation& Installation::of_others(SolverCore& core) { return at(core, kOfOthers); }

Installation& Installation::of_world(SolverCore& core, const btCollisionDispatcher* dispatcher) {
  // The dispatchers of worlds that live at the same time lie at different addresses.
  const auto address = static_cast<std::uint64_t>(std::bit_cast<std::uintptr_t>(dispatcher));
  const std::uint64_t mixed = (address * 0x9E3779B97F4A7C15ULL) >> 32U;
  return at(core, kOfWorlds + mixed % (SolverCore::kWorlds - kOfWorlds));
}

Installation& Installation::at(SolverCore& core, std::size_t place) {
  SolverInWorld* world = core.world_at(place);
  if (world == nullptr) world = &core.add_world(place, std::make_unique<Installation>(core));
  return static_cast<Installation&>(*world);  // no other kind is added
}

bool Installation::calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                                const btTransform& pose_a, const btTransform& pose_b, btVector3& v,
                                btVector3& witness_a, btVector3& witness_b, btIDebugDraw* draw) {
  return core().calc_pen_depth(simplex, a, b, pose_a, pose_b, v, witness_a, witness_b, draw);
}

void Installation::updateAction(btCollisionWorld* world, btScalar step) {
  begin_step();
  mark_between_steps(*world);
  // `install` adds the action to such worlds only.
  if (!core().closed()) carry_heavy_loads(static_cast<btDiscreteDynamicsWorld&>(*world), core(), step);
}

}  // namespace pd::detail
