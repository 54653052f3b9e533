/// @file
/// Bodies whose groups did not pay lately, and for how many steps these are left to Bullet's sweeps.
///
/// A group has no name that lasts from step to step, so that its bodies remember, by their place in the world. A group
/// waits while most of its bodies do. Each trial that does not pay doubles the wait, up to `kLongest` steps.
///
/// Factorisations that a column takes while contacts come and go are its debt, and calm steps pay it back. A column
/// that lands takes up to 32 factorisations in some steps, then stands with one or two. Hulls that tumble take 20 in
/// each.
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

  /// @return whether it may be solved while its contacts come and go.
  [[nodiscard]] bool may_owe(const SolverBodies& bodies, std::span<const int> group) {
    return largest_debt(bodies, group) < kMostDebt;
  }

  /// @param owed  factorisations that were made although contacts came and went
  void note(const SolverBodies& bodies, std::span<const int> group, bool has_paid, int owed) {
    unsigned longest = 0;
    for (const int body : group) longest = std::max(longest, wait(entry_of(bodies[body])));
    longest = has_paid ? longest / 2 : std::clamp(2 * longest, 2U, kLongest);
    unsigned debt = largest_debt(bodies, group);
    debt = owed > 0 ? debt + static_cast<unsigned>(owed) : debt - std::min(debt, kPaidBack);
    const unsigned entry = (debt << (2 * kBits)) | (longest << kBits) | (has_paid ? 0 : longest);
    for (const int body : group) entry_of(bodies[body]) = entry;
  }

  /// For snapshots: of each body its debt, its wait, and how many steps of that are left.
  btAlignedObjectArray<unsigned> entries;

 private:
  static constexpr unsigned kLongest = 64;
  static constexpr unsigned kMostDebt = 96;
  static constexpr unsigned kPaidBack = 4;  ///< by a step that is not owed
  static constexpr unsigned kBits = 8;
  static constexpr unsigned kMask = (1U << kBits) - 1;

  static unsigned left(unsigned entry) { return entry & kMask; }
  static unsigned wait(unsigned entry) { return (entry >> kBits) & kMask; }
  static unsigned debt(unsigned entry) { return entry >> (2 * kBits); }
  unsigned largest_debt(const SolverBodies& bodies, std::span<const int> group) {
    unsigned largest = 0;
    for (const int body : group) largest = std::max(largest, debt(entry_of(bodies[body])));
    return largest;
  }
  unsigned& entry_of(const btSolverBody& body) {
    const int place = std::max(0, body.m_originalBody->getWorldArrayIndex());
    if (place >= entries.size()) entries.resize(place + 1, 0);
    return entries[place];
  }
};

}  // namespace pd::detail
