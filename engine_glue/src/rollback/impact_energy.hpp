/// @file
/// Impacts with friction and restitution that would add energy, and how much restitution they may have.
///
/// Bullet makes the normal velocity after an impact -e times that before it (Newton's law), whatever friction does in
/// between. Friction that slows or turns a body drives it into the surface again, the normal impulse that makes up for
/// it grows, and the two may leave more energy than there was: T. R. Kane and D. A. Levinson, "Dynamics: theory and
/// applications", 1985, section 5.8. Contacts that bounce do the work
///
///     W = sum of p . (v- + v+) / 2
///
/// over their points, p the impulse with friction, v- and v+ the relative velocities before and after: what the bodies'
/// kinetic energy gains by them. Without restitution it is never positive (p . v+ <= 0, and v+ - v- lies along p).
/// Where it is, the step is made again with less restitution. Impulses of a point that slips one way grow as 1 + e,
/// so W(e) = (1 + e) x + (1 + e)^2 y, whose zero is the restitution to try next.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <mutex>
#include <vector>

#include "rollback/free_flight.hpp"

namespace pd::detail {

class ImpactEnergy {
 public:
  /// @param flight  knows how bodies moved before a step
  explicit ImpactEnergy(const FreeFlight& flight) : flight_(flight) {}

  /// A part of a step begins: all pairs have their own restitution.
  void begin_part();
  /// Whether a step was too good by its restitution: then the pairs at fault have less of it from here on, and the step
  /// is to be made again from where it began. False once a part has been made again as often as that may help.
  bool lessen(btDiscreteDynamicsWorld& world, btScalar step);
  /// Gives a pair's points what restitution it has left. Any thread.
  void apply(btPersistentManifold& manifold);
  /// Gives points their own restitution back after a step.
  void restore();

  [[nodiscard]] bool any() const { return !pairs_.empty(); }

 private:
  /// What the contacts of a pair of bodies do.
  struct PairWork {
    const btCollisionObject* a;
    const btCollisionObject* b;
    btScalar share;  ///< of its own restitution, in force
    double e;        ///< largest restitution among its points that bounce, 0: none does
    double given;    ///< sum of p . v-
    double work;     ///< W
  };
  struct KeptRestitution {
    btManifoldPoint* point;
    btScalar value;
  };

  [[nodiscard]] btScalar share_of(const btPersistentManifold& manifold) const;
  PairWork& work_of(const btPersistentManifold& manifold);
  void add(const btPersistentManifold& manifold, const btContactSolverInfo& info, btScalar step);
  [[nodiscard]] btVector3 velocity_before(const btRigidBody& body, const btVector3& point, btScalar step) const;
  [[nodiscard]] btVector3 velocity_after(const btRigidBody& body, const btVector3& point) const;

  const FreeFlight& flight_;
  std::vector<PairWork> works_;
  std::vector<PairWork> pairs_;  ///< that have less restitution in this part
  std::vector<KeptRestitution> kept_;
  std::mutex keeping_;
  int repeated_ = 0;
};

}  // namespace pd::detail
