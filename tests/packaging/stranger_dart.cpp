/// @file
/// A stranger's program on the door to DART: two cubes, their contacts by pdepth.
#include <algorithm>
#include <cstdio>
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionOption.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <memory>
#include <pd/dart/collision_detector.hpp>

int main() {
  const auto cube = std::make_shared<dart::dynamics::BoxShape>(Eigen::Vector3d(1, 1, 1));
  auto a = dart::dynamics::SimpleFrame::createShared(dart::dynamics::Frame::World());
  auto b = dart::dynamics::SimpleFrame::createShared(dart::dynamics::Frame::World());
  a->setShape(cube);
  b->setShape(cube);
  b->setTranslation(Eigen::Vector3d(0.75, 0, 0));
  pd::register_dart_detector();
  const auto detector = dart::collision::CollisionDetector::getFactory()->create("pdepth");
  const auto group = detector->createCollisionGroup(a.get(), b.get());
  dart::collision::CollisionResult result;
  group->collide(dart::collision::CollisionOption(), &result);
  double depth = 0;
  for (const auto& contact : result.getContacts()) depth = std::max(depth, contact.penetrationDepth);
  std::printf("depth %g, %zu points\n", depth, result.getNumContacts());
}
