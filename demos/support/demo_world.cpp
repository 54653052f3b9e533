#include "support/demo_world.hpp"

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btMinkowskiPenetrationDepthSolver.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "pd/bullet/scalar.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/render/mesh.hpp"
#include "pd/render/palette.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/bullet/convex_pieces.hpp"

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

scenes::ContactRun run_of(SolverKind kind) {
  const bool ours = kind == SolverKind::exact || kind == SolverKind::approximate;
  return ours ? scenes::ContactRun::pdepth_sharp : scenes::ContactRun::bullet_sharp;
}

BulletSolverSettings settings_for(SolverKind kind) {
  BulletSolverSettings settings;
  settings.delta = kind == SolverKind::approximate ? kApproximateDelta : 0;
  return settings;
}

/// What is drawn of a body: a convex piece, or all of a mesh.
struct Drawn {
  int body;
  render::MeshRef mesh;
  Pose local;
  int colour;  ///< class
};

std::vector<Drawn> drawn_bodies(const scenes::World& world, const std::vector<scenes::ConvexPiece>& pieces) {
  std::vector<Drawn> result;
  int part = 0, last_body = -1;
  for (const scenes::ConvexPiece& piece : pieces) {
    const scenes::WorldBody& body = world.bodies[static_cast<std::size_t>(piece.body)];
    part = piece.body == last_body ? part + 1 : 0;
    last_body = piece.body;
    if (body.drawn && body.triangles.empty()) {
      const int colour = body.parts_coloured ? body.colour + part : body.colour;
      result.push_back({piece.body, render::shape_mesh(*piece.shape), piece.local, colour});
    }
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const scenes::WorldBody& body = world.bodies[i];
    if (!body.drawn || body.triangles.empty()) continue;
    if (body.kind == scenes::WorldBody::Kind::compound) {
      std::vector<std::array<std::int32_t, 3>> triangles;
      for (const auto& t : body.triangles) triangles.push_back({t[0], t[1], t[2]});
      result.push_back({static_cast<int>(i), render::triangle_mesh(body.points, triangles), Pose(), body.colour});
    } else {
      // Triangles of their own corners: what bodies catch on are edges between coplanar ones, which are to be seen.
      std::vector<Vec3> corners;
      std::vector<std::array<std::int32_t, 3>> triangles;
      for (const auto& triangle : body.triangles) {
        const auto first = static_cast<std::int32_t>(corners.size());
        triangles.push_back({first, first + 1, first + 2});
        for (const int corner : triangle) corners.push_back(body.points[static_cast<std::size_t>(corner)]);
      }
      result.push_back({static_cast<int>(i), render::triangle_mesh(corners, triangles), Pose(), body.colour});
    }
  }
  return result;
}

}  // namespace

struct DemoWorld::State {
  State(const scenes::World& world, SolverKind solver_kind_in)
      : kind(solver_kind_in),
        bullet_solver(kind == SolverKind::bullet_minkowski ? std::unique_ptr<btConvexPenetrationDepthSolver>(
                                                                 std::make_unique<btMinkowskiPenetrationDepthSolver>())
                                                           : std::make_unique<btGjkEpaPenetrationDepthSolver>()),
        scene(world, run_of(kind), settings_for(kind)),
        pieces(scenes::convex_pieces(world)),
        drawn(drawn_bodies(world, pieces)) {}

  [[nodiscard]] bool ours() const { return kind == SolverKind::exact || kind == SolverKind::approximate; }
  [[nodiscard]] const scenes::WorldBody& plan(int i) const { return scene.plan(i); }

  SolverKind kind;
  CountedSolver bullet_solver;
  scenes::BulletScene scene;
  std::vector<scenes::ConvexPiece> pieces;
  std::vector<Drawn> drawn;
  std::vector<Vec3> starts;
  Scratch scratch;
};

DemoWorld::DemoWorld(const scenes::World& world, SolverKind kind) : state_(std::make_unique<State>(world, kind)) {
  State& s = *state_;
  if (!s.ours()) {
    static_cast<btConvexConvexAlgorithm::CreateFunc*>(s.scene.configuration().getCollisionAlgorithmCreateFunc(
                                                          CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE))
        ->m_pdSolver = &s.bullet_solver;
  }
  bullet().getSolverInfo().m_numIterations = world.solver_iterations;
  bullet().getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  for (int i = 0; i < num_bodies(); ++i) s.starts.push_back(to_pd(body(i).getWorldTransform().getOrigin()));
}

DemoWorld::~DemoWorld() = default;

Measurement DemoWorld::step() {
  State& s = *state_;
  const BulletSolverStatistics before = solver().statistics();
  const std::int64_t bullet_calls = s.bullet_solver.calls;
  const double bullet_microseconds = s.bullet_solver.microseconds;
  const auto start = std::chrono::steady_clock::now();
  s.scene.step(s.scene.plan().steps_per_second);
  const double spent = microseconds_since(start);
  const BulletSolverStatistics after = solver().statistics();
  Measurement result = measure();
  result.step_microseconds = spent;
  result.solver_calls = s.ours() ? after.calls - before.calls : s.bullet_solver.calls - bullet_calls;
  result.solver_microseconds = s.ours() ? 1e-3 * static_cast<double>(after.nanoseconds - before.nanoseconds)
                                        : s.bullet_solver.microseconds - bullet_microseconds;
  return result;
}

void DemoWorld::measure_depths(Measurement& result) {
  State& s = *state_;
  scenes::for_each_near_pair(s.scene, s.pieces, [&](const scenes::PosedPiece& a, const scenes::PosedPiece& b) {
    const PenetrationDepth answer =
        penetration_depth({a.piece.shape.get(), a.pose}, {b.piece.shape.get(), b.pose}, s.scratch);
    if (answer.contact != ContactClass::overlapping) return;
    ++result.overlapping_pairs;
    result.total_depth += answer.depth;
    if (answer.depth > result.deepest) {
      result.deepest = answer.depth;
      result.deepest_a = a.piece.body;
      result.deepest_b = b.piece.body;
      result.deepest_piece_a = a.piece.shape;
      result.deepest_piece_b = b.piece.shape;
      result.deepest_pose_a = a.pose;
      result.deepest_pose_b = b.pose;
      result.deepest_answer = answer;
    }
  });
}

Measurement DemoWorld::measure() {
  State& s = *state_;
  Measurement result;
  measure_depths(result);
  for (int i = 0; i < num_bodies(); ++i) {
    if (s.plan(i).mass == 0) continue;
    const Vec3 at = to_pd(s.scene.body(i).getWorldTransform().getOrigin());
    result.drift = std::max(result.drift, (at - s.starts[static_cast<std::size_t>(i)]).norm());
  }
  const scenes::MechanicalEnergy energy = scenes::mechanical_energy(s.scene);
  result.kinetic_energy = energy.kinetic;
  result.potential_energy = energy.potential;
  result.forward_speed = static_cast<double>(body(s.scene.first_moving()).getLinearVelocity().x());
  for (int i = 0; i < s.scene.dispatcher().getNumManifolds(); ++i) {
    result.contacts += s.scene.dispatcher().getManifoldByIndexInternal(i)->getNumContacts();
  }
  return result;
}

std::vector<Ghost> DemoWorld::ghosts() {
  constexpr double kDegree = 0.0175;
  State& s = *state_;
  const btRigidBody& moving = body(s.scene.first_moving());
  const Vec3 way = to_pd(moving.getLinearVelocity()).normalized();
  std::vector<Ghost> result;
  for (int m = 0; m < s.scene.dispatcher().getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *s.scene.dispatcher().getManifoldByIndexInternal(m);
    const bool second = manifold.getBody1() == &moving;
    if (manifold.getBody0() != &moving && !second) continue;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const Vec3 normal = (second ? -1.0 : 1.0) * to_pd(point.m_normalWorldOnB);
      if (point.m_appliedImpulse > 0 && normal.dot(way) < -kDegree) {
        result.push_back({to_pd(point.getPositionWorldOnB()), normal});
      }
    }
  }
  return result;
}

render::Scene DemoWorld::picture(const Measurement& measurement, double shown_depth) const {
  const State& s = *state_;
  render::Scene scene;
  const bool shown = measurement.deepest > shown_depth;
  for (const Drawn& drawn : s.drawn) {
    const scenes::WorldBody& plan = s.plan(drawn.body);
    const Pose pose = to_pd(state_->scene.body(drawn.body).getWorldTransform());
    render::Body body;
    body.mesh = drawn.mesh;
    body.pose =
        Pose::from_trusted_matrix(pose.rotation() * drawn.local.rotation(), pose.apply(drawn.local.translation()));
    body.colour = render::palette::varied(render::palette::categorical(static_cast<std::size_t>(drawn.colour)),
                                          static_cast<std::uint32_t>(drawn.body));
    body.highlight = shown && (drawn.body == measurement.deepest_a || drawn.body == measurement.deepest_b);
    // What stands still is glass: what goes on behind it and inside it is the point of the picture.
    body.opacity = plan.mass > 0 ? 1.0f : 0.45f;
    scene.bodies.push_back(std::move(body));
  }
  scene.ground.height = s.scene.plan().studio_floor;
  scene.focus.include(s.scene.plan().view_lower);
  scene.focus.include(s.scene.plan().view_upper);
  return scene;
}

btDiscreteDynamicsWorld& DemoWorld::bullet() { return state_->scene.world(); }
BulletPenetrationDepthSolver& DemoWorld::solver() { return state_->scene.solver(); }
int DemoWorld::num_bodies() const { return state_->scene.num_bodies(); }
btRigidBody& DemoWorld::body(int i) { return state_->scene.body(i); }
const scenes::WorldBody& DemoWorld::description(int i) const { return state_->plan(i); }

const ConvexShape& DemoWorld::shape(int i) const {
  const auto found = std::find_if(state_->pieces.begin(), state_->pieces.end(),
                                  [&](const scenes::ConvexPiece& piece) { return piece.body == i; });
  return *found->shape;
}

int DemoWorld::index_of(const void* collision_object) const {
  for (int i = 0; i < num_bodies(); ++i) {
    if (static_cast<const btCollisionObject*>(&state_->scene.body(i)) == collision_object) {
      return i;
    }
  }
  return -1;
}

}  // namespace pd::demo
