#include "world/heavy_loads.hpp"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "pair/solver_core.hpp"
#include "shapes/body_motion.hpp"
#include "stack/body_inertia.hpp"
#include "stack/impulse_newton.hpp"

namespace pd::detail {

namespace {

/// Ratio of masses from which a pair is looked at: ten sweeps mend a third of the load of lesser ratios.
constexpr btScalar kHeavy = 30;
/// Sweeps do not find a load in time that is more than so many times the light body's weight.
constexpr btScalar kLoad = 10;
/// Bodies that are solved for, and those of them whose neighbours may join. Others go on pushing as they do. Twice as
/// many take a third of the step of a heap of mixed sizes.
constexpr std::size_t kMostBodies = 8;
constexpr std::size_t kMostSupported = 6;
/// Share of the speed that gravity adds in a step. Bodies that close more slowly after the sweeps carry their
/// load.
constexpr btScalar kUnresolved = btScalar(0.1);

/// The rigid body of an object; null for one that impulses do not move.
const btRigidBody* moving(const btCollisionObject* object) {
  const btRigidBody* const body = btRigidBody::upcast(object);
  return body != nullptr && body->getInvMass() > 0 && !body->isStaticOrKinematicObject() ? body : nullptr;
}

bool masses_differ(const btCollisionObjectArray& objects) {
  btScalar least = BT_LARGE_FLOAT, most = 0;
  for (int i = 0; i < objects.size(); ++i) {
    const btRigidBody* const body = moving(objects[i]);
    if (body == nullptr) continue;
    least = std::min(least, body->getInvMass());
    most = std::max(most, body->getInvMass());
  }
  return most >= kHeavy * least;
}

/// The error that the sweeps have left at a light body: the largest speed at which a point that pushes still closes,
/// and the velocity of the body on the point's other side.
struct Unresolved {
  btScalar speed = 0;
  btVector3 support = btVector3(0, 0, 0);
};

void note_unresolved(const btPersistentManifold& manifold, const BodyMotion& a, const BodyMotion& b, bool a_is_light,
                     Unresolved& most) {
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    const btManifoldPoint& point = manifold.getContactPoint(k);
    if (!(point.m_appliedImpulse > 0)) continue;
    const btVector3& place = point.getPositionWorldOnB();
    const btVector3 of_a = a.velocity_at(place), of_b = b.velocity_at(place);
    const btScalar speed = (of_b - of_a).dot(point.m_normalWorldOnB);
    if (speed > most.speed) most = {speed, a_is_light ? of_b : of_a};
  }
}

class HeavyLoads {
 public:
  HeavyLoads(btDiscreteDynamicsWorld& world, SolverCore& core, btScalar seconds, ImpulseNewton& newton)
      : world_(world),
        dispatcher_(*world.getDispatcher()),
        core_(core),
        info_(world.getSolverInfo()),
        seconds_(seconds),
        newton_(newton) {
    newton_.masses.clear();
    newton_.rows.clear();
  }

  void carry() {
    if (!find_pairs() || !find_loaded()) return;
    find_group();
    find_other_forces();
    add_rows();
    bound_impulses();
    if (newton_.solve().settled) hand_on();
  }

 private:
  /// A heavy body that rests on a light one.
  struct Pair {
    const btRigidBody* heavy;
    const btRigidBody* light;
    int manifold;
    PairMemory* memory;
    HeavyLoad before;  ///< at the end of the last step
  };
  struct Body {
    const btRigidBody* body;
    BodyInertia inertia;
    BodyMotion motion;
    btVector3 gains = btVector3(0, 0, 0);  ///< of the velocity of its centre, from the next step's forces
    btVector3 turns = btVector3(0, 0, 0);  ///< of its angular velocity
    bool measured = false;                 ///< the forces are those of this step
  };
  /// The point of a manifold that takes the impulse of a row.
  struct Place {
    int manifold;
    int point;
  };

  [[nodiscard]] const btPersistentManifold& manifold(int m) const { return *dispatcher_.getManifoldByIndexInternal(m); }

  /// Notes the pairs of very different masses.
  bool find_pairs() {
    for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
      const btPersistentManifold& between = manifold(m);
      if (!responds(between)) continue;
      if (between.getNumContacts() > 0) touching_.push_back(m);
      const btRigidBody* const a = moving(between.getBody0());
      const btRigidBody* const b = moving(between.getBody1());
      if (a == nullptr || b == nullptr) continue;
      const bool a_is_heavy = a->getInvMass() < b->getInvMass();
      const btRigidBody& heavy = a_is_heavy ? *a : *b;
      const btRigidBody& light = a_is_heavy ? *b : *a;
      if (light.getInvMass() < kHeavy * heavy.getInvMass() || !heavy.isActive()) continue;
      PairMemory* const memory = core_.pairs.find(&between);
      if (memory != nullptr) pairs_.push_back({&heavy, &light, m, memory, memory->load});
    }
    return !pairs_.empty();
  }

  /// Keeps the pairs in which a light body carries more than the sweeps have found out, or did so before.
  bool find_loaded() {
    std::unordered_map<const btCollisionObject*, Unresolved> unresolved_of;
    for (const Pair& pair : pairs_) unresolved_of[pair.light];
    for (const int m : touching_) {
      const btPersistentManifold& between = manifold(m);
      const auto a = unresolved_of.find(between.getBody0()), b = unresolved_of.find(between.getBody1());
      BodyMotion motion_a, motion_b;
      if ((a == unresolved_of.end() && b == unresolved_of.end()) ||
          !motion_of(*between.getBody0(), seconds_, motion_a) || !motion_of(*between.getBody1(), seconds_, motion_b)) {
        continue;
      }
      if (a != unresolved_of.end()) note_unresolved(between, motion_a, motion_b, true, a->second);
      if (b != unresolved_of.end()) note_unresolved(between, motion_a, motion_b, false, b->second);
    }
    std::erase_if(pairs_, [&](const Pair& pair) {
      HeavyLoad& load = pair.memory->load;
      const btScalar weight = pair.heavy->getGravity().length() * seconds_, least = kUnresolved * weight;
      const Unresolved& unresolved = unresolved_of[pair.light];
      const btScalar pushed = push_of(manifold(pair.manifold)), coming = comes_on(pair, unresolved.support);
      const btScalar load_of_heavy =
          pushed * pair.light->getInvMass() + coming * pair.light->getInvMass() / pair.heavy->getInvMass();
      if (!(pushed > 0)) {
        load.carried = false;
      } else if (unresolved.speed > least && coming > least && load_of_heavy > kLoad * weight) {
        load.carried = true;
      }
      const bool known = load.known;
      load.begin(*pair.heavy);
      return !load.carried || !known;
    });
    return !pairs_.empty();
  }

  /// How fast the heavy body comes on against what holds the light one. The light body itself may move with either.
  [[nodiscard]] btScalar comes_on(const Pair& pair, const btVector3& support) const {
    const btPersistentManifold& between = manifold(pair.manifold);
    BodyMotion heavy;
    (void)motion_of(*pair.heavy, seconds_, heavy);
    const btScalar side = between.getBody0() == pair.heavy ? btScalar(-1) : btScalar(1);
    btScalar most = 0;
    for (int k = 0; k < between.getNumContacts(); ++k) {
      const btManifoldPoint& point = between.getContactPoint(k);
      if (!(point.m_appliedImpulse > 0)) continue;
      const btVector3 velocity = heavy.velocity_at(point.getPositionWorldOnB()) - support;
      most = std::max(most, side * velocity.dot(point.m_normalWorldOnB));
    }
    return most;
  }

  static bool responds(const btPersistentManifold& between) {
    return between.getBody0()->hasContactResponse() && between.getBody1()->hasContactResponse();
  }
  static btScalar push_of(const btPersistentManifold& between) {
    btScalar sum = 0;
    for (int k = 0; k < between.getNumContacts(); ++k) sum += between.getContactPoint(k).m_appliedImpulse;
    return sum;
  }

  /// The bodies of the pairs, and those that touch them, and so on.
  void find_group() {
    places_.assign(static_cast<std::size_t>(world_.getNumCollisionObjects()), -1);
    for (int i = 0; i < world_.getNumConstraints(); ++i) {
      const btTypedConstraint& joint = *world_.getConstraint(i);
      jointed_.insert(&joint.getRigidBodyA());
      jointed_.insert(&joint.getRigidBodyB());
    }
    for (const Pair& pair : pairs_) {
      // The forces of joints are known of a heavy body only.
      add_body(pair.heavy, true);
      add_body(pair.light, false);
    }
    std::size_t asked = 0;
    for (std::size_t known = 0; known < group_.size(); known = asked) {
      asked = group_.size();
      for (const int m : touching_) {
        const btCollisionObject* const objects[2] = {manifold(m).getBody0(), manifold(m).getBody1()};
        const int first = place_of(objects[0]), second = place_of(objects[1]);
        if (std::max(first, second) < static_cast<int>(known)) continue;
        manifolds_.push_back(m);
        for (const auto& [place, other] : {std::pair(first, objects[1]), std::pair(second, objects[0])}) {
          const btRigidBody* const body = moving(other);
          if (place >= 0 && place < static_cast<int>(kMostSupported) && body != nullptr) add_body(body, false);
        }
      }
    }
    std::sort(manifolds_.begin(), manifolds_.end());
    manifolds_.erase(std::unique(manifolds_.begin(), manifolds_.end()), manifolds_.end());
    for (const Body& body : group_) newton_.masses.push_back(body.inertia.mass);
  }

  void add_body(const btRigidBody* body, bool with_joints) {
    if (group_.size() == kMostBodies || (!with_joints && jointed_.count(body) != 0)) return;
    int& place = places_[static_cast<std::size_t>(body->getWorldArrayIndex())];
    if (place >= 0) return;
    place = static_cast<int>(group_.size());
    Body& added = group_.emplace_back();
    added.body = body;
    added.inertia = body_inertia(body->getInvMass() * body->getLinearFactor(), body->getInvInertiaTensorWorld(),
                                 body->getAngularFactor());
    (void)motion_of(*body, seconds_, added.motion);
    added.gains = body->getGravity() * seconds_;
  }

  [[nodiscard]] int place_of(const btCollisionObject* object) const {
    const int index = object->getWorldArrayIndex();
    return index < 0 ? -1 : places_[static_cast<std::size_t>(index)];
  }

  /// Finds the forces on heavy bodies that neither gravity nor contacts explain: those of joints and of the host. They
  /// are assumed to act in the next step, too.
  void find_other_forces() {
    for (const Pair& pair : pairs_) {
      const HeavyLoad& load = pair.before;
      const int place = place_of(pair.heavy);
      if (place < 0) continue;
      Body& heavy = group_[static_cast<std::size_t>(place)];
      if (heavy.measured) continue;
      heavy.measured = true;
      const btRigidBody& body = *heavy.body;
      btVector3 gains = heavy.motion.velocity - load.velocity, turns = heavy.motion.turn - load.turn;
      for (const int m : manifolds_) {
        const btPersistentManifold& between = manifold(m);
        const bool first = between.getBody0() == heavy.body;
        if (!first && between.getBody1() != heavy.body) continue;
        for (int k = 0; k < between.getNumContacts(); ++k) {
          const btManifoldPoint& point = between.getContactPoint(k);
          const btVector3 push = point.m_normalWorldOnB * (first ? point.m_appliedImpulse : -point.m_appliedImpulse);
          const btVector3 arm = (first ? point.getPositionWorldOnA() : point.getPositionWorldOnB()) - load.centre;
          gains -= push * body.getInvMass() * body.getLinearFactor();
          turns -= body.getInvInertiaTensorWorld() * arm.cross(push) * body.getAngularFactor();
        }
      }
      heavy.gains = gains;
      heavy.turns = turns;
    }
  }

  void add_rows() {
    for (const int m : manifolds_) {
      for (int k = 0; k < manifold(m).getNumContacts(); ++k) add_row(m, k);
    }
  }

  void add_row(int m, int k) {
    const btPersistentManifold& between = manifold(m);
    const btManifoldPoint& point = between.getContactPoint(k);
    const btCollisionObject* const objects[2] = {between.getBody0(), between.getBody1()};
    const btVector3 at[2] = {objects[0]->getWorldTransform()(point.m_localPointA),
                             objects[1]->getWorldTransform()(point.m_localPointB)};
    const btVector3& n = point.m_normalWorldOnB;
    const double dt = static_cast<double>(seconds_);
    const double gap = static_cast<double>((at[0] - at[1]).dot(n));
    ImpulseNewton::Row row;
    double weight = 0, parting = 0;
    bool left = false;
    for (int side = 0; side < 2; ++side) {
      const btVector3 way = side == 0 ? n : -n;
      row.body[side] = place_of(objects[side]);
      if (row.body[side] < 0) {
        BodyMotion motion;
        if (!motion_of(*objects[side], seconds_, motion)) return;
        parting += static_cast<double>(motion.velocity_at(at[side]).dot(way));
        left = left || moving(objects[side]) != nullptr;
        continue;
      }
      const Body& body = group_[static_cast<std::size_t>(row.body[side])];
      const btVector3 arm = at[side] - body.motion.centre;
      row.jacobian[side] = six(way, arm.cross(way)).cwiseProduct(body.inertia.moves);
      weight += row.jacobian[side].dot(body.inertia.inverse * row.jacobian[side]);
      const btVector3 velocity = body.motion.velocity_at(at[side]) + body.gains + body.turns.cross(arm);
      parting += static_cast<double>(velocity.dot(way));
    }
    if (!(weight > 0)) return;
    const bool split =
        info_.m_splitImpulse != 0 && gap <= static_cast<double>(info_.m_splitImpulsePenetrationThreshold);
    const double wanted = gap > 0 ? -gap / dt : split ? 0 : -gap * static_cast<double>(info_.m_erp2) / dt;
    row.target = wanted - parting;
    row.softness = row.of_changes = ImpulseNewton::kSoftness * weight;
    row.impulse = static_cast<double>(point.m_appliedImpulse);
    // Nothing is known of what moves a body that is not solved for: it goes on pushing as it does.
    if (left) row.lower = row.upper = row.impulse;
    newton_.rows.push_back(row);
    rows_.push_back({m, k});
  }

  /// A body between two that do not give way would take any impulse. None is larger than what stops all bodies.
  void bound_impulses() {
    double mass = 0, speed = 0;
    for (const Body& body : group_) mass += 1 / static_cast<double>(body.body->getInvMass());
    for (const ImpulseNewton::Row& row : newton_.rows) speed = std::max(speed, row.target);
    for (ImpulseNewton::Row& row : newton_.rows) {
      if (row.lower == row.upper && row.lower != 0) continue;
      row.upper = mass * speed;
    }
  }

  void hand_on() {
    const double factor = static_cast<double>(info_.m_warmstartingFactor);
    std::vector<const btPersistentManifold*> manifolds;
    for (const Place& place : rows_) manifolds.push_back(&manifold(place.manifold));
    core_.pairs.visit_all(manifolds.data(), static_cast<int>(manifolds.size()), [&](int i, PairMemory* memory) {
      const auto row = static_cast<std::size_t>(i);
      const int k = rows_[row].point;
      if (memory == nullptr || k >= memory->num_points || newton_.rows[row].lower != 0) return;
      RememberedPoint& remembered = memory->points[static_cast<std::size_t>(k)];
      if (!(remembered.local_a == manifolds[row]->getContactPoint(k).m_localPointA)) return;
      remembered.impulse.ahead = static_cast<btScalar>(newton_.rows[row].impulse / factor);
    });
  }

  btDiscreteDynamicsWorld& world_;
  btDispatcher& dispatcher_;
  SolverCore& core_;
  const btContactSolverInfo& info_;
  btScalar seconds_;
  std::vector<Pair> pairs_;
  std::unordered_set<const btCollisionObject*> jointed_;
  std::vector<int> touching_;  ///< manifolds with points
  std::vector<int> places_;    ///< in `group_`, by the object's number in the world
  std::vector<Body> group_;
  std::vector<int> manifolds_;
  std::vector<Place> rows_;
  ImpulseNewton& newton_;  ///< keeps its memory, and the order of elimination while the same bodies touch
};

}  // namespace

void carry_heavy_loads(btDiscreteDynamicsWorld& world, SolverCore& core, btScalar seconds) {
  const btContactSolverInfo& info = world.getSolverInfo();
  if (!(seconds > 0) || (info.m_solverMode & SOLVER_USE_WARMSTARTING) == 0 || !(info.m_warmstartingFactor > 0)) return;
  if (!masses_differ(world.getCollisionObjectArray())) return;
  thread_local ImpulseNewton newton;  // a few bodies, in every step of worlds whose masses differ: its memory is kept
  HeavyLoads(world, core, seconds, newton).carry();
}

}  // namespace pd::detail
