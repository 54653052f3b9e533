/// @file
/// Every sample of the guide "pdepth in a Bullet world" (engine_glue/README.md), compiled and run. A check compares the
/// guide's text with the marked parts.
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <pd/bullet/compound.hpp>
#include <pd/bullet/contact_recorder.hpp>
#include <pd/bullet/debug_draw.hpp>
#include <pd/bullet/install.hpp>
#include <pd/bullet/mesh_check.hpp>
#include <pd/bullet/rollback.hpp>
#include <pd/bullet/snapshot.hpp>
#include <pd/bullet/solver_settings.hpp>
#include <pd/bullet/stack_solver.hpp>
#include <pd/bullet/world_queries.hpp>
#include <pd/solid/convex_decomposition.hpp>
#include <vector>

namespace {

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "the guide promises: %s\n", what);
  std::exit(1);
}

/// A box on a table, under the constraint solver that the sample names.
template <class Impulses>
struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  Impulses impulses;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &impulses, &configuration};
  btBoxShape table_shape{btVector3(5, 1, 5)}, box_shape{btVector3(0.5f, 0.5f, 0.5f)};
  btRigidBody table{0, nullptr, &table_shape}, box{1, nullptr, &box_shape, btVector3(0.1f, 0.1f, 0.1f)};

  World() {
    table.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, -1, 0)));
    box.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0.5f, 0)));
    world.addRigidBody(&table);
    world.addRigidBody(&box);
  }
  ~World() {
    world.removeRigidBody(&box);
    world.removeRigidBody(&table);
  }
};

void install_and_uninstall() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  // [install]
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);  // any time, also between steps
  world.stepSimulation(1.0f / 240, 0);
  pd::uninstall(world, solver);  // Bullet's own algorithms again, from the next step on
  // [/install]
  world.stepSimulation(1.0f / 240, 0);
  expect(solver.statistics().calls > 0, "pairs are asked once the solver is installed");
}

void opt_out() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  w.box.setUserIndex(7);
  // [opt_out]
  pd::BulletSolverSettings settings;
  settings.takes_pair = [](const btCollisionObject& a, const btCollisionObject& b, void*) {
    return a.getUserIndex() != 7 && b.getUserIndex() != 7;  // bodies marked 7 keep Bullet's contacts
  };
  pd::BulletPenetrationDepthSolver solver(settings);
  pd::install(world, solver);
  // [/opt_out]
  world.stepSimulation(1.0f / 240, 0);
  expect(solver.statistics().calls == 0, "a pair that is opted out is not asked");
}

void settings() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  // [settings]
  pd::apply_recommended(world.getSolverInfo());
  // [/settings]
  expect(world.getSolverInfo().m_numIterations == 30, "thirty iterations");
}

void stacks() {
  // [stack]
  pd::StackSolver impulses;  // in place of btSequentialImpulseConstraintSolver
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);
  pd::apply_recommended(world.getSolverInfo());
  world.getSolverInfo().m_numIterations = 10;
  // [/stack]
  btBoxShape floor(btVector3(1, 1, 1)), cube(btVector3(0.01f, 0.01f, 0.01f));
  btRigidBody below(0, nullptr, &floor);
  below.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, -1, 0)));
  world.addRigidBody(&below);
  std::unique_ptr<btRigidBody> tower[10];
  for (int i = 0; i < 10; ++i) {
    btVector3 inertia;
    cube.calculateLocalInertia(0.01f, inertia);
    tower[i] = std::make_unique<btRigidBody>(0.01f, nullptr, &cube, inertia);
    tower[i]->setWorldTransform(
        btTransform(btQuaternion::getIdentity(), btVector3(0, 0.01f + 0.02f * static_cast<btScalar>(i), 0)));
    world.addRigidBody(tower[i].get());
  }
  for (int step = 0; step < 300; ++step) world.stepSimulation(1.0f / 60, 0);
  const btScalar top = tower[9]->getWorldTransform().getOrigin().y();
  expect(top > 0.1899f && top < 0.1901f, "a tower of ten boxes of 2 cm stands");
  for (auto& body : tower) world.removeRigidBody(body.get());
  world.removeRigidBody(&below);
}

void meshes() {
  btTriangleMesh triangles;
  triangles.addTriangle(btVector3(-5, 0, -5), btVector3(-5, 0, 5), btVector3(5, 0, 5));
  triangles.addTriangle(btVector3(-5, 0, -5), btVector3(5, 0, 5), btVector3(5, 0, -5));
  // [mesh]
  const pd::Expected<pd::SurfaceReport> report = pd::check_mesh(triangles);  // before Bullet builds its tree
  if (!report) {
    std::fprintf(stderr, "the mesh is refused at %s\n", report.error().where.c_str());
    std::exit(1);
  }
  btBvhTriangleMeshShape ground(&triangles, true);
  pd::BulletSolverSettings settings;
  settings.one_sided_meshes = true;  // only where every mesh is the surface of a solid
  pd::BulletPenetrationDepthSolver solver(settings);
  // [/mesh]
  expect(report->faces == 2, "two triangles");
  expect(ground.getMeshInterface() == &triangles && settings.one_sided_meshes, "the mesh is Bullet's");
}

void rollback() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  w.box.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 1, 0)));
  w.box.setLinearVelocity(btVector3(0, -40, 0));
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);
  // [rollback]
  pd::RollbackStepper stepper(world, solver);
  const pd::RollbackReport report = stepper.step(1.0f / 60);  // in place of world.stepSimulation(1.0f / 60, 0)
  for (const pd::FirstContact& contact : report.contacts) {
    std::printf("first contact after %.4f s, %.0e apart\n", contact.time, contact.gap);
  }
  // [/rollback]
  expect(report.contacts.size() == 1, "the box meets the table once");
}

void snapshot() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);
  // [snapshot]
  pd::BulletSnapshot saved(world, &solver);
  world.stepSimulation(1.0f / 60, 0);
  const bool restored = saved.restore() == pd::Restored::yes;  // the same step again gives the same bits
  // [/snapshot]
  expect(restored && w.box.getWorldTransform().getOrigin().y() == btScalar(0.5), "the box is back");
}

void queries() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);
  // [queries]
  btSphereShape probe(0.25f);
  const btTransform from(btQuaternion::getIdentity(), btVector3(0, 3, 0));
  const btTransform to(btQuaternion::getIdentity(), btVector3(0, -3, 0));
  pd::WorldQuerySettings query;
  query.cache = &solver.cache();
  const auto cast = pd::sweep_test(world, probe, from, to, query);
  if (cast && cast->hit) std::printf("the probe meets a body after %.3f of its way\n", cast->hit->fraction);
  const auto nearest = pd::distance_test(world, probe, from, 10, query);
  if (nearest && nearest->nearest) std::printf("the nearest body is %.3f away\n", nearest->nearest->distance);
  // [/queries]
  expect(cast && cast->hit && cast->hit->object == &w.box, "the probe meets the box");
  expect(nearest && nearest->nearest, "the box is near");
}

void record() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  // [record]
  pd::ContactRecorder recorder(world, "contacts.jsonl");  // any world, any solver
  for (int step = 0; step < 60; ++step) world.stepSimulation(1.0f / 60, 0);
  if (!recorder.close()) std::fprintf(stderr, "contacts.jsonl is incomplete\n");
  // [/record]
  expect(recorder.contacts() > 0, "contacts were recorded");
  std::remove("contacts.jsonl");
}

void parts() {
  const std::vector<pd::Vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0},
                                     {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}};
  const std::vector<int> offsets{0, 6, 12, 16, 20, 24, 28, 32, 36};
  const std::vector<int> corners{5, 4, 3, 2, 1, 0, 6, 7, 8,  9, 10, 11, 0,  1,  7, 6, 1, 2,
                                 8, 7, 2, 3, 9, 8, 3, 4, 10, 9, 4,  5,  11, 10, 5, 0, 6, 11};
  // [parts]
  const auto solid = pd::MeshSolid::from_faces({points, offsets, corners});  // face f: corners[offsets[f]] and on
  if (!solid) std::exit(1);                                                  // solid.error() names the fault
  const auto found = pd::decompose(*solid, {.error = 1e-3});
  if (!found || !found->error_reached) std::exit(1);
  const auto made = pd::compound_of(found->parts);  // owns the shapes: it must outlive the body
  if (!made) std::exit(1);
  const btScalar mass = 2;
  const pd::Vec3 inertia = made->inertia.diagonal();  // for a mass of 1
  btRigidBody body(mass, nullptr, made->shape.get(),
                   mass * btVector3(btScalar(inertia.x()), btScalar(inertia.y()), btScalar(inertia.z())));
  const pd::Vec3 centre = made->origin;  // where the body's origin stands in the mesh's frame
  body.setWorldTransform(
      btTransform(btQuaternion::getIdentity(), btVector3(btScalar(centre.x()), btScalar(centre.y()), 4)));
  // [/parts]
  expect(made->children.size() == 2, "an L is two convex parts");
}

struct CountingDrawer final : btIDebugDraw {
  int lines = 0;
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override { ++lines; }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int) override {}
  int getDebugMode() const override { return DBG_DrawContactPoints; }
};

void draw() {
  World<btSequentialImpulseConstraintSolver> w;
  btDiscreteDynamicsWorld& world = w.world;
  pd::BulletPenetrationDepthSolver solver;
  pd::install(world, solver);
  CountingDrawer drawer;
  // [draw]
  world.stepSimulation(1.0f / 60, 0);
  pd::ContactDrawing drawing;
  drawing.depth_scale = 100;                  // a box at rest is some 1e-5 deep
  pd::draw_contacts(world, drawer, drawing);  // `drawer` is your btIDebugDraw
  // [/draw]
  expect(drawer.lines == 11, "four depths, four edges and an arrow are drawn");
}

}  // namespace

int main() {
  install_and_uninstall();
  opt_out();
  settings();
  stacks();
  meshes();
  rollback();
  snapshot();
  queries();
  record();
  parts();
  draw();
  std::printf("every sample of the guide holds\n");
}
