/// @file
/// ODE's own colliders of convex geoms and planes. ODE has no getter for its table, so these are the functions that its
/// `dInitODE` puts there (ODE 0.16 with libccd), called by name.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstddef>

namespace pd::detail {

/// Two classes of convex geoms, or one and a plane, in the order in which ODE calls the collider of the two.
struct OwnCollider {
  int first;
  int second;
  dColliderFn* function;
};
inline constexpr std::size_t kOwnColliders = 20;
extern const std::array<OwnCollider, kOwnColliders> own_colliders;

/// ODE's own contacts of a pair of these classes, for a function that was put into the table: in the order in which ODE
/// calls it.
int collide_by_ode(dGeomID first, dGeomID second, int flags, dContactGeom* contacts, int skip);

/// Lets ODE answer two classes as before any override, bit for bit.
void put_back(const OwnCollider& own);

/// True if `dCollide` answers two geoms that overlap as ODE's own collider does.
[[nodiscard]] bool stands_in_table(const OwnCollider& own);

/// Contacts stand `skip` bytes apart.
[[nodiscard]] inline dContactGeom& contact_at(dContactGeom* contacts, int skip, int i) {
  return *reinterpret_cast<dContactGeom*>(reinterpret_cast<char*>(contacts) + static_cast<std::ptrdiff_t>(skip) * i);
}

}  // namespace pd::detail
