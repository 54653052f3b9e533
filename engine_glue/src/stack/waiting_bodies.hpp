/// @file
/// Bodies whose groups did not pay lately, and for how many steps these are left to Bullet's sweeps.
///
/// A group has no name that lasts from step to step, so that its bodies remember, by their place in the world. A group
/// waits while most of its bodies do. Each trial that does not pay doubles the wait, up to `kLongest` steps.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <algorithm>
#include <span>

#include "stack/row_groups.hpp"

namespace pd::detail {

class WaitingBodies {
 public:
  /// One step passes for the group. @return whether it waits.
  [[nodiscard]] bool wait_a_step(const SolverBodies& bodies, std::span<const int> group) {
    std::size_t waiting = 0;
    for (const int body : group) {
      unsigned& entry = entry_of(bodies[body]);
      if (left(entry) == 0) continue;
      --entry;
      ++waiting;
    }
    return 2 * waiting > group.size();
  }

  void note(const SolverBodies& bodies, std::span<const int> group, bool has_paid) {
    unsigned longest = 0;
    for (const int body : group) longest = std::max(longest, wait(entry_of(bodies[body])));
    longest = has_paid ? longest / 2 : std::clamp(2 * longest, 2U, kLongest);
    for (const int body : group) entry_of(bodies[body]) = (longest << kBits) | (has_paid ? 0 : longest);
  }

  /// For snapshots.
  btAlignedObjectArray<unsigned> entries;

 private:
  static constexpr unsigned kLongest = 64;
  static constexpr unsigned kBits = 16;

  static unsigned left(unsigned entry) { return entry & ((1U << kBits) - 1); }
  static unsigned wait(unsigned entry) { return entry >> kBits; }
  unsigned& entry_of(const btSolverBody& body) {
    const int place = std::max(0, body.m_originalBody->getWorldArrayIndex());
    if (place >= entries.size()) entries.resize(place + 1, 0);
    return entries[place];
  }
};

}  // namespace pd::detail
