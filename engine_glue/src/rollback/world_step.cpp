#include "rollback/world_step.hpp"

namespace pd::detail {

namespace {

/// Takes the callbacks out for as long as it lives.
class Silence {
 public:
  Silence(btInternalTickCallback& pre, btInternalTickCallback& post)
      : pre_(pre), post_(post), saved_pre_(pre), saved_post_(post) {
    pre = nullptr;
    post = nullptr;
  }
  ~Silence() {
    pre_ = saved_pre_;
    post_ = saved_post_;
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  btInternalTickCallback& pre_;
  btInternalTickCallback& post_;
  btInternalTickCallback saved_pre_;
  btInternalTickCallback saved_post_;
};

}  // namespace

void WorldStep::save_kinematic_state(btDiscreteDynamicsWorld& world, btScalar step) {
  (world.*(&WorldStep::saveKinematicState))(step);
}

void WorldStep::move(btDiscreteDynamicsWorld& world, btScalar step) {
  const Silence silence(world.*(&WorldStep::m_internalPreTickCallback), world.*(&WorldStep::m_internalTickCallback));
  (world.*(&WorldStep::internalSingleStepSimulation))(step);
}

void WorldStep::synchronize(btDiscreteDynamicsWorld& world, btScalar ahead, btScalar fixed) {
  world.*(&WorldStep::m_localTime) = ahead;
  world.*(&WorldStep::m_fixedTimeStep) = fixed;
  world.synchronizeMotionStates();
}

}  // namespace pd::detail
