/// @file
/// Every sample of the guide "pdepth in DART" (engine_glue/dart/README.md), compiled and run. A check compares the
/// guide's text with the marked parts.
#include <cstdio>
#include <cstdlib>
#include <dart/collision/CollisionOption.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "pd/dart/collision_detector.hpp"
#include "pd/dart/contact_recorder.hpp"

namespace {

using namespace dart::dynamics;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "the guide promises: %s\n", what);
  std::exit(1);
}

/// A box that stands on a plane.
dart::simulation::WorldPtr box_on_plane() {
  auto world = dart::simulation::World::create();
  auto ground = Skeleton::create("ground"), crate = Skeleton::create("crate");
  ground->createJointAndBodyNodePair<WeldJoint>().second->createShapeNodeWith<CollisionAspect, DynamicsAspect>(
      std::make_shared<PlaneShape>(Eigen::Vector3d::UnitZ(), 0));
  auto [joint, body] = crate->createJointAndBodyNodePair<FreeJoint>();
  body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(
      std::make_shared<BoxShape>(Eigen::Vector3d(0.2, 0.2, 0.2)));
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation().z() = 0.1;
  FreeJoint::setTransformOf(joint, place);
  world->setGravity(Eigen::Vector3d(0, 0, -9.81));
  world->addSkeleton(ground);
  world->addSkeleton(crate);
  return world;
}

}  // namespace

int main() {
  const auto world = box_on_plane();
  // [use]
  pd::register_dart_detector();
  const auto detector = dart::collision::CollisionDetector::getFactory()->create("pdepth");
  world->getConstraintSolver()->setCollisionDetector(detector);
  for (int step = 0; step < 200; ++step) world->step();
  // [/use]
  const auto* dart_detector = static_cast<const pd::DartDetector*>(detector.get());
  // [report]
  const pd::DartReport report = dart_detector->report();
  const auto meshes = report.left[static_cast<std::size_t>(pd::DartRefusal::mesh)];
  std::printf("%lld pairs answered, %lld left for their meshes\n", static_cast<long long>(report.answered),
              static_cast<long long>(meshes));
  // [/report]
  expect(report.answered >= 200, "pairs are answered");
  const auto group = world->getConstraintSolver()->getCollisionGroup();
  // [record]
  pd::DartRecorder recorder("contacts.jsonl");  // whichever detector the group has
  recorder.write(*group, dart::collision::CollisionOption(), world->getTime());
  if (!recorder.close()) std::fprintf(stderr, "contacts.jsonl is incomplete\n");
  // [/record]
  expect(recorder.contacts() == 1, "a line for the pair");
}
