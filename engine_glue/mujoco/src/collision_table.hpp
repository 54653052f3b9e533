/// @file
/// MuJoCo's table of collision functions, and the entries in it that are about convex geoms and planes.
#pragma once

#include <mujoco/mujoco.h>

namespace pd::detail {

/// The types that MuJoCo's header of this version gives to collision functions: newer versions write `mjPreContact`.
template <class Function>
struct CollisionArguments;
template <class DataArgument, class ContactArgument>
struct CollisionArguments<int (*)(const mjModel*, DataArgument*, ContactArgument*, int, int, mjtNum)> {
  using Data = DataArgument;
  using Contact = ContactArgument;
};
using CollisionData = CollisionArguments<mjfCollision>::Data;
using CollisionContact = CollisionArguments<mjfCollision>::Contact;

[[nodiscard]] constexpr bool is_convex(int type) { return type >= mjGEOM_SPHERE && type <= mjGEOM_MESH; }

/// Two types as MuJoCo orders them (first <= second) that pdepth knows: two convex geoms, or a plane and one.
[[nodiscard]] constexpr bool is_convex_pair(int first, int second) {
  return is_convex(second) && (first == mjGEOM_PLANE || (is_convex(first) && first <= second));
}

/// The normal of a contact, from the first geom to the second; MuJoCo chooses the tangents.
template <class Contact>
[[nodiscard]] const mjtNum* normal_of(const Contact& contact) {
  if constexpr (requires { contact.frame; }) {
    return contact.frame;
  } else {
    return contact.normal;
  }
}
template <class Contact>
void set_normal(Contact& contact, const double normal[3]) {
  mjtNum* axis = const_cast<mjtNum*>(normal_of(contact));
  mjtNum* tangent = nullptr;
  if constexpr (requires { contact.frame; }) {
    tangent = contact.frame + 3;
  } else {
    tangent = contact.tangent;
  }
  for (int i = 0; i < 3; ++i) {
    axis[i] = static_cast<mjtNum>(normal[i]);
    tangent[i] = 0;
  }
}

/// One function in the place of many, and the functions that stood there before.
class ReplacedEntries {
 public:
  /// Replaces the entries of convex pairs that are not null. Put a second time, it leaves alone the entries that
  /// somebody else has replaced since: their functions may call `function`, which must not call them in turn.
  /// @param above  null, or entries whose function calls those that it replaced: `function` then goes below it
  /// @return the number of entries that now hold `function`
  int put(mjfCollision function, ReplacedEntries* above = nullptr);
  /// Puts back the entries that still hold the function.
  void put_back(ReplacedEntries* above = nullptr);
  /// The function that stood at the place of two types; never null where `put` replaced it.
  [[nodiscard]] mjfCollision before(int first, int second) const { return before_[first][second]; }

 private:
  /// The entry of two types, in MuJoCo's table or below `above`.
  static mjfCollision& entry_of(int first, int second, ReplacedEntries* above);

  bool active_ = false;
  mjfCollision function_ = nullptr;
  mjfCollision before_[mjNGEOMTYPES][mjNGEOMTYPES] = {};
};

/// The entries of all recorders, which stand above those of `install_mujoco`.
ReplacedEntries& recorder_entries();

}  // namespace pd::detail
