#include "support/demo_world.hpp"

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btMinkowskiPenetrationDepthSolver.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>

#include "pd/bullet/install.hpp"
#include "pd/bullet/pair_answer.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/render/mesh.hpp"
#include "pd/render/palette.hpp"
#include "scenes/bullet/bullet_scene.hpp"

namespace pd::demo {

namespace {

/// Within 1 %.
constexpr double kApproximateDelta = 1e-2;

double microseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

/// Bullet's own solver, with a count and a clock.
class CountedSolver : public btConvexPenetrationDepthSolver {
 public:
  explicit CountedSolver(std::unique_ptr<btConvexPenetrationDepthSolver> solver) : solver_(std::move(solver)) {}
  bool calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                    const btTransform& pose_a, const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                    btVector3& witness_b, btIDebugDraw* draw) override {
    const auto start = std::chrono::steady_clock::now();
    const bool found = solver_->calcPenDepth(simplex, a, b, pose_a, pose_b, v, witness_a, witness_b, draw);
    microseconds += microseconds_since(start);
    ++calls;
    return found;
  }
  std::int64_t calls = 0;
  double microseconds = 0;

 private:
  std::unique_ptr<btConvexPenetrationDepthSolver> solver_;
};

}  // namespace

Expected<SolverKind> solver_kind(std::string_view word) {
  for (const SolverKind kind :
       {SolverKind::exact, SolverKind::approximate, SolverKind::bullet_epa, SolverKind::bullet_minkowski}) {
    if (word == to_string(kind)) {
      return kind;
    }
  }
  return Error{ErrorCode::bad_value, "the solvers are exact, approx, bullet-epa and bullet-minkowski", "--solver"};
}

std::string_view to_string(SolverKind kind) {
  switch (kind) {
    case SolverKind::exact:
      return "exact";
    case SolverKind::approximate:
      return "approx";
    case SolverKind::bullet_epa:
      return "bullet-epa";
    case SolverKind::bullet_minkowski:
      return "bullet-minkowski";
  }
  return "";
}

std::string_view describe(SolverKind kind) {
  switch (kind) {
    case SolverKind::exact:
      return "pdepth: exact depth, whole manifolds";
    case SolverKind::approximate:
      return "pdepth: depth within 1 %, whole manifolds";
    case SolverKind::bullet_epa:
      return "Bullet as shipped: GJK + EPA, a point a step";
    case SolverKind::bullet_minkowski:
      return "Bullet with its Minkowski sampling solver";
  }
  return "";
}

namespace {

BulletSolverSettings settings_for(SolverKind kind) {
  BulletSolverSettings settings;
  settings.delta = kind == SolverKind::approximate ? kApproximateDelta : 0;
  return settings;
}

}  // namespace

struct DemoWorld::State {
  State(const scenes::World& description, SolverKind solver_kind_in)
      : plan(description),
        kind(solver_kind_in),
        solver(settings_for(kind)),
        bullet_solver(kind == SolverKind::bullet_minkowski ? std::unique_ptr<btConvexPenetrationDepthSolver>(
                                                                 std::make_unique<btMinkowskiPenetrationDepthSolver>())
                                                           : std::make_unique<btGjkEpaPenetrationDepthSolver>()),
        dispatcher(&configuration),
        world(&dispatcher, &broadphase, &constraint_solver, &configuration) {}

  [[nodiscard]] bool ours() const { return kind == SolverKind::exact || kind == SolverKind::approximate; }

  scenes::World plan;
  SolverKind kind;
  BulletPenetrationDepthSolver solver;
  CountedSolver bullet_solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraint_solver;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btConvexShape>> bullet_shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::shared_ptr<const ConvexShape>> shapes;
  std::vector<double> radii;
  std::vector<render::MeshRef> meshes;
  std::vector<Vec3> starts;
  Scratch scratch;
};

DemoWorld::DemoWorld(const scenes::World& world, SolverKind kind) : state_(std::make_unique<State>(world, kind)) {
  State& s = *state_;
  if (s.ours()) {
    install(s.world, s.solver);
  } else {
    static_cast<btConvexConvexAlgorithm::CreateFunc*>(
        s.configuration.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE))
        ->m_pdSolver = &s.bullet_solver;
  }
  s.world.setGravity(to_bullet(world.gravity));
  s.world.getSolverInfo().m_numIterations = world.solver_iterations;
  s.world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  for (const scenes::WorldBody& plan : world.bodies) {
    s.bullet_shapes.push_back(scenes::convex_bullet_shape(plan, false, 0));
    btConvexShape& shape = *s.bullet_shapes.back();
    btVector3 inertia(0, 0, 0);
    if (plan.mass > 0) {
      shape.calculateLocalInertia(static_cast<btScalar>(plan.mass), inertia);
    }
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(plan.mass), nullptr, &shape, inertia);
    const Eigen::Quaterniond& q = plan.orientation;
    info.m_startWorldTransform = btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                                          static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                                             to_bullet(plan.position));
    info.m_friction = static_cast<btScalar>(world.friction);
    info.m_restitution = static_cast<btScalar>(world.restitution);
    s.bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *s.bodies.back();
    body.setLinearVelocity(to_bullet(plan.linear_velocity));
    body.setAngularVelocity(to_bullet(plan.angular_velocity));
    body.setActivationState(DISABLE_DEACTIVATION);  // nothing is put to sleep: the figures show the solvers alone
    s.world.addRigidBody(&body);
    s.shapes.push_back(s.solver.cache().find_or_convert(shape));
    s.radii.push_back(bounding_radius(*s.shapes.back()));
    s.meshes.push_back(render::shape_mesh(*s.shapes.back()));
    s.starts.push_back(to_pd(body.getWorldTransform().getOrigin()));
  }
}

DemoWorld::~DemoWorld() {
  for (auto& body : state_->bodies) {
    state_->world.removeRigidBody(body.get());
  }
}

Measurement DemoWorld::step() {
  State& s = *state_;
  const BulletSolverStatistics before = s.solver.statistics();
  const std::int64_t bullet_calls = s.bullet_solver.calls;
  const double bullet_microseconds = s.bullet_solver.microseconds;
  const auto start = std::chrono::steady_clock::now();
  s.world.stepSimulation(static_cast<btScalar>(1 / s.plan.steps_per_second), 0);
  const double spent = microseconds_since(start);
  const BulletSolverStatistics after = s.solver.statistics();
  Measurement result = measure();
  result.step_microseconds = spent;
  result.solver_calls = s.ours() ? after.calls - before.calls : s.bullet_solver.calls - bullet_calls;
  result.solver_microseconds = s.ours() ? 1e-3 * static_cast<double>(after.nanoseconds - before.nanoseconds)
                                        : s.bullet_solver.microseconds - bullet_microseconds;
  return result;
}

Measurement DemoWorld::measure() {
  State& s = *state_;
  Measurement result;
  const int count = num_bodies();
  std::vector<Pose> poses;
  for (const auto& body : s.bodies) {
    poses.push_back(to_pd(body->getWorldTransform()));
  }
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const double reach = s.radii[i] + s.radii[j];
      if ((s.plan.bodies[i].mass == 0 && s.plan.bodies[j].mass == 0) ||
          (poses[i].translation() - poses[j].translation()).squaredNorm() > reach * reach) {
        continue;
      }
      const PenetrationDepth answer =
          penetration_depth({s.shapes[i].get(), poses[i]}, {s.shapes[j].get(), poses[j]}, s.scratch);
      if (answer.contact != ContactClass::overlapping) {
        continue;
      }
      ++result.overlapping_pairs;
      result.total_depth += answer.depth;
      if (answer.depth > result.deepest) {
        result.deepest = answer.depth;
        result.deepest_a = i;
        result.deepest_b = j;
        result.deepest_pose_a = poses[i];
        result.deepest_pose_b = poses[j];
        result.deepest_answer = answer;
      }
    }
  }
  for (int i = 0; i < count; ++i) {
    const btRigidBody& body = *s.bodies[i];
    const double mass = s.plan.bodies[i].mass;
    if (mass == 0) {
      continue;
    }
    result.drift = std::max(result.drift, (poses[i].translation() - s.starts[i]).norm());
    const Vec3 omega = to_pd(body.getAngularVelocity());
    const Vec3 inverse_inertia = to_pd(body.getInvInertiaDiagLocal());
    const Vec3 local_omega = poses[i].rotation().transpose() * omega;
    result.kinetic_energy += 0.5 * mass * to_pd(body.getLinearVelocity()).squaredNorm();
    for (int k = 0; k < 3; ++k) {
      result.kinetic_energy += inverse_inertia[k] > 0 ? 0.5 * local_omega[k] * local_omega[k] / inverse_inertia[k] : 0;
    }
    result.potential_energy -= mass * s.plan.gravity.dot(poses[i].translation());
  }
  for (int i = 0; i < s.dispatcher.getNumManifolds(); ++i) {
    result.contacts += s.dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
  }
  return result;
}

render::Scene DemoWorld::picture(const Measurement& measurement, double shown_depth) const {
  const State& s = *state_;
  render::Scene scene;
  const bool shown = measurement.deepest > shown_depth;
  for (int i = 0; i < num_bodies(); ++i) {
    if (!s.plan.bodies[i].drawn) {
      continue;
    }
    render::Body body;
    body.mesh = s.meshes[i];
    body.pose = to_pd(s.bodies[i]->getWorldTransform());
    body.colour = render::palette::varied(
        render::palette::categorical(static_cast<std::size_t>(s.plan.bodies[i].colour)), static_cast<std::uint32_t>(i));
    body.highlight = shown && (i == measurement.deepest_a || i == measurement.deepest_b);
    // What stands still is glass: what goes on behind it and inside it is the point of the picture.
    body.opacity = s.plan.bodies[i].mass > 0 ? 1.0f : 0.45f;
    scene.bodies.push_back(std::move(body));
  }
  scene.focus.include(s.plan.view_lower);
  scene.focus.include(s.plan.view_upper);
  return scene;
}

btDiscreteDynamicsWorld& DemoWorld::bullet() { return state_->world; }
BulletPenetrationDepthSolver& DemoWorld::solver() { return state_->solver; }
int DemoWorld::num_bodies() const { return static_cast<int>(state_->bodies.size()); }
btRigidBody& DemoWorld::body(int i) { return *state_->bodies[i]; }
const ConvexShape& DemoWorld::shape(int i) const { return *state_->shapes[i]; }
const scenes::WorldBody& DemoWorld::description(int i) const { return state_->plan.bodies[i]; }

int DemoWorld::index_of(const void* collision_object) const {
  for (int i = 0; i < num_bodies(); ++i) {
    if (static_cast<const btCollisionObject*>(state_->bodies[i].get()) == collision_object) {
      return i;
    }
  }
  return -1;
}

}  // namespace pd::demo
