/// @file
/// pdepth's collision detector in DART: what DART promises of any detector, pair by pair and group by group, exact
/// numbers, and worlds that come to rest.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/DistanceResult.hpp>
#include <dart/collision/RaycastOption.hpp>
#include <dart/collision/RaycastResult.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CapsuleShape.hpp>
#include <dart/dynamics/ConeShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/EllipsoidShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/MultiSphereConvexHullShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/PyramidShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "dart/dart_mesh.hpp"
#include "pd/dart/collision_detector.hpp"
#include "pd/dart/contact_recorder.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {
namespace {

using namespace dart::dynamics;
using namespace dart::collision;

std::shared_ptr<SimpleFrame> frame_of(const ShapePtr& shape, const Vec3& at = Vec3::Zero()) {
  auto frame = SimpleFrame::createShared(Frame::World());
  frame->setShape(shape);
  frame->setTranslation(at);
  return frame;
}

constexpr double kSigned = -std::numeric_limits<double>::infinity();

TEST(DartDetector, TheFactoryKnowsIt) {
  register_dart_detector();
  register_dart_detector();
  auto detector = CollisionDetector::getFactory()->create("pdepth");
  ASSERT_TRUE(detector);
  EXPECT_EQ(detector->getType(), "pdepth");
  EXPECT_EQ(detector->cloneWithoutCollisionObjects()->getType(), "pdepth");
  auto group = detector->createCollisionGroup();
  EXPECT_FALSE(detector->raycast(group.get(), Vec3::Zero(), Vec3::UnitX())) << "refused by name";
}

TEST(DartDetector, ContactsLeadFromTheSecondToTheFirst) {
  auto detector = DartDetector::create();
  auto low = frame_of(std::make_shared<BoxShape>(Vec3(1, 1, 1)));
  auto high = frame_of(std::make_shared<SphereShape>(0.5), {0.1, 0.2, 0.875});
  auto first = detector->createCollisionGroup(low.get()), second = detector->createCollisionGroup(high.get());
  CollisionResult result;
  ASSERT_TRUE(first->collide(second.get(), {}, &result));
  ASSERT_EQ(result.getNumContacts(), 1u);
  const auto& contact = result.getContact(0);
  EXPECT_EQ(contact.collisionObject1->getShapeFrame(), low.get());
  EXPECT_EQ(contact.collisionObject2->getShapeFrame(), high.get());
  EXPECT_TRUE(contact.normal.isApprox(-Vec3::UnitZ(), 1e-12));
  EXPECT_NEAR(contact.penetrationDepth, 0.125, 1e-12);
  EXPECT_TRUE(contact.point.isApprox(Vec3(0.1, 0.2, 0.4375), 1e-12));
  EXPECT_TRUE(result.inCollision(low.get()));
  // The same pair in one group, and moved apart.
  auto both = detector->createCollisionGroup(low.get(), high.get());
  EXPECT_TRUE(both->collide());
  EXPECT_TRUE(both->collide(CollisionOption(), &result));
  high->setTranslation(Vec3(0.1, 0.2, 1.25));
  EXPECT_FALSE(both->collide(CollisionOption(), &result));
  EXPECT_EQ(result.getNumContacts(), 0u);
}

TEST(DartDetector, LimitsFiltersAndPairsWithoutNumbers) {
  auto detector = DartDetector::create();
  auto group = detector->createCollisionGroup();
  std::vector<std::shared_ptr<SimpleFrame>> frames;
  for (int i = 0; i < 5; ++i) {
    frames.push_back(frame_of(std::make_shared<BoxShape>(Vec3(1, 1, 1)), {0.9 * i, 0, 0}));
    group->addShapeFrame(frames.back().get());
  }
  CollisionResult result;
  EXPECT_TRUE(group->collide(CollisionOption(), &result));
  EXPECT_EQ(result.getNumContacts(), 16u) << "four pairs of neighbours, four points each";
  EXPECT_TRUE(group->collide({true, 6, nullptr}, &result));
  EXPECT_EQ(result.getNumContacts(), 6u);
  EXPECT_FALSE(group->collide({true, 0, nullptr}, &result));
  EXPECT_TRUE(group->collide({false, 100, nullptr}, &result));
  EXPECT_EQ(result.getNumContacts(), 4u) << "one for each pair";
  struct KeepsFirst final : CollisionFilter {
    bool ignoresCollision(const CollisionObject* a, const CollisionObject* b) const override {
      return a->getShapeFrame() != kept && b->getShapeFrame() != kept;
    }
    const ShapeFrame* kept = nullptr;
  };
  auto filter = std::make_shared<KeepsFirst>();
  filter->kept = frames[0].get();
  EXPECT_TRUE(group->collide({true, 100, filter}, &result));
  EXPECT_EQ(result.getNumContacts(), 4u);
  // Objects that two groups share are not asked against themselves.
  auto other = detector->createCollisionGroup(frames[0].get());
  EXPECT_TRUE(group->collide(other.get(), {}, &result));
  EXPECT_EQ(result.getNumContacts(), 4u);
  group->removeShapeFrame(frames[1].get());
  EXPECT_FALSE(group->collide(other.get(), {}, &result));
  // Shapes that change are converted again.
  frames[0]->setShape(std::make_shared<BoxShape>(Vec3(4, 1, 1)));
  EXPECT_TRUE(group->collide(other.get(), {}, &result));
  auto foreign = FCLCollisionDetector::create()->createCollisionGroup();
  EXPECT_FALSE(detector->collide(foreign.get(), {}, &result)) << "a group of another detector";
}

TEST(DartDetector, ARowAlongAnyAxisMeetsItsNeighbours) {
  for (int axis = 0; axis < 3; ++axis) {
    auto detector = DartDetector::create();
    auto even = detector->createCollisionGroup(), odd = detector->createCollisionGroup();
    auto all = detector->createCollisionGroup();
    std::vector<SimpleFramePtr> frames;
    for (int i = 0; i < 6; ++i) {
      frames.push_back(frame_of(std::make_shared<BoxShape>(Vec3(1, 1, 1)), 0.9 * i * Vec3::Unit(axis)));
      all->addShapeFrame(frames.back().get());
      (i % 2 == 0 ? even : odd)->addShapeFrame(frames.back().get());
    }
    CollisionResult result;
    EXPECT_TRUE(all->collide(CollisionOption(), &result));
    EXPECT_EQ(result.getNumContacts(), 20u) << "five pairs of neighbours, four points each, axis " << axis;
    EXPECT_TRUE(even->collide(odd.get(), {}, &result));
    EXPECT_EQ(result.getNumContacts(), 20u) << axis;
    EXPECT_FALSE(odd->collide(CollisionOption(), &result)) << axis;
  }
}

TEST(DartDetector, Distances) {
  auto detector = DartDetector::create();
  auto a = frame_of(std::make_shared<SphereShape>(0.5)),
       b = frame_of(std::make_shared<BoxShape>(Vec3(1, 1, 1)), {2, 0, 0});
  auto far = frame_of(std::make_shared<SphereShape>(0.5), {0, 9, 0});
  auto group = detector->createCollisionGroup(a.get(), b.get(), far.get());
  DistanceResult result;
  EXPECT_NEAR(group->distance({true, 0, nullptr}, &result), 1, 1e-12);
  EXPECT_TRUE(result.found());
  EXPECT_EQ(result.shapeFrame1, a.get());
  EXPECT_EQ(result.shapeFrame2, b.get());
  EXPECT_TRUE(result.nearestPoint1.isApprox(Vec3(0.5, 0, 0), 1e-12));
  EXPECT_TRUE(result.nearestPoint2.isApprox(Vec3(1.5, 0, 0), 1e-12));
  b->setTranslation(Vec3(0.75, 0, 0));
  EXPECT_EQ(group->distance({false, 0, nullptr}, &result), 0) << "clamped by the lower bound";
  EXPECT_NEAR(group->distance({true, kSigned, nullptr}, &result), -0.25, 1e-12);
  EXPECT_NEAR((result.nearestPoint1 - result.nearestPoint2).norm(), 0.25, 1e-12);
  // A plane is the half-space below it.
  auto ground = frame_of(std::make_shared<PlaneShape>(Vec3::UnitZ(), -2));
  auto floor = detector->createCollisionGroup(ground.get());
  EXPECT_NEAR(group->distance(floor.get(), {true, kSigned, nullptr}, &result), 1.5, 1e-12);
  EXPECT_NEAR(result.nearestPoint2.z(), -2, 1e-12);
  EXPECT_EQ(detector->createCollisionGroup()->distance(DistanceOption(), &result), 0);
  EXPECT_FALSE(result.found()) << "no pair";
}

ConvexPolytope stone() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) {
    const Vec3 p = 0.5 * Vec3{normal(random), normal(random), normal(random)}.normalized();
    points.push_back(p.cast<float>().cast<double>());
  }
  return *ConvexPolytope::from_points(points);
}

struct Solid {
  ShapePtr shape;
  ConvexShape body;
};

std::vector<Solid> solids() {
  const MultiSphereConvexHullShape::Spheres spheres{{0.2, Vec3(0, 0, 0.3)}, {0.3, Vec3(0.2, 0, -0.1)}};
  const std::vector<Sphere> same{{Vec3(0, 0, 0.3), 0.2}, {Vec3(0.2, 0, -0.1), 0.3}};
  return {{std::make_shared<BoxShape>(Vec3(0.6, 0.8, 1)), *ConvexPolytope::box({0.3, 0.4, 0.5})},
          {std::make_shared<SphereShape>(0.4), *ConvexShape::sphere(0.4)},
          {std::make_shared<EllipsoidShape>(Vec3(0.6, 1, 0.8)), *ConvexShape::ellipsoid({0.3, 0.5, 0.4})},
          {std::make_shared<CylinderShape>(0.3, 0.8), *ConvexShape::cylinder(0.3, 0.4, 2)},
          {std::make_shared<CapsuleShape>(0.2, 0.8), *ConvexShape::capsule(0.2, 0.4, 2)},
          {std::make_shared<ConeShape>(0.4, 0.8), *ConvexShape::cone(0.4, 0.4, 2)},
          {std::make_shared<PyramidShape>(0.8, 0.6, 0.9),
           *ConvexPolytope::from_points(std::vector<Vec3>{
               {-0.4, -0.3, -0.45}, {0.4, -0.3, -0.45}, {-0.4, 0.3, -0.45}, {0.4, 0.3, -0.45}, {0, 0, 0.45}})},
          {std::make_shared<MultiSphereConvexHullShape>(spheres), *ConvexShape::hull_of_spheres(same)},
          {test::dart_mesh(stone()), stone()}};
}

TEST(DartDetector, EveryPairOfShapesIsExact) {
  auto detector = DartDetector::create({.delta = 1e-9});
  const std::vector<Solid> all = solids();
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Scratch scratch;
  std::int64_t asked = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i; j < all.size(); ++j) {
      auto a = frame_of(all[i].shape), b = frame_of(all[j].shape);
      auto first = detector->createCollisionGroup(a.get()), second = detector->createCollisionGroup(b.get());
      for (int trial = 0; trial < 6; ++trial) {
        Pose poses[2];
        for (int side = 0; side < 2; ++side) {
          Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
          place.linear() =
              Eigen::Quaterniond{normal(random), normal(random), normal(random), 1}.normalized().toRotationMatrix();
          place.translation() = 0.4 * Vec3{normal(random), normal(random), normal(random)};
          (side == 0 ? a : b)->setTransform(place);
          poses[side] = *Pose::from_matrix(place.linear(), place.translation());
        }
        const double exact =
            penetration_depth({&all[i].body, poses[0]}, {&all[j].body, poses[1]}, scratch, {.delta = 1e-9})
                .signed_distance();
        DistanceResult distance;
        first->distance(second.get(), {true, kSigned, nullptr}, &distance);
        EXPECT_NEAR(distance.minDistance, exact, 1e-8) << i << " " << j;
        EXPECT_NEAR((distance.nearestPoint1 - distance.nearestPoint2).norm(), std::abs(exact), 1e-7);
        CollisionResult contacts;
        EXPECT_EQ(first->collide(second.get(), {}, &contacts), exact < 0) << i << " " << j << " " << exact;
        if (contacts.getNumContacts() > 0) {
          EXPECT_NEAR(contacts.getContact(0).penetrationDepth, -exact, 1e-8) << i << " " << j;
        }
        ++asked;
      }
    }
  }
  EXPECT_GE(detector->report().answered, asked);
  EXPECT_EQ(detector->report().left, (std::array<std::int64_t, kDartRefusals>{}));
}

TEST(DartDetector, OthersAreLeftToFclAndNamedOnce) {
  std::vector<std::string> lines;
  DartOptions options;
  options.warning = [](const char* line, void* user) {
    static_cast<std::vector<std::string>*>(user)->emplace_back(line);
  };
  options.user = &lines;
  auto detector = DartDetector::create(options);
  auto ball = frame_of(std::make_shared<SphereShape>(0.5));
  auto open = frame_of(test::dart_mesh(stone(), 1), {0.8, 0, 0});
  open->setName("stone");
  auto group = detector->createCollisionGroup(ball.get(), open.get());
  CollisionResult result;
  EXPECT_TRUE(group->collide(CollisionOption(), &result)) << "FCL's answer";
  EXPECT_EQ(result.getContact(0).collisionObject1->getShapeFrame(), ball.get());
  group->collide(CollisionOption(), &result);
  EXPECT_EQ(detector->report().left[static_cast<std::size_t>(DartRefusal::mesh)], 2);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("\"stone\" (MeshShape), mesh: its faces do not close"), std::string::npos) << lines[0];
  open->setShape(std::make_shared<BoxShape>(Vec3(1, 1, 1)));
  open->setTranslation(Vec3(std::nan(""), 0, 0));
  group->collide(CollisionOption(), &result);
  EXPECT_EQ(detector->report().left[static_cast<std::size_t>(DartRefusal::pose)], 1);
  EXPECT_EQ(lines.size(), 2u);
}

/// Boxes on a plane in a world of DART.
dart::simulation::WorldPtr stack(int boxes) {
  auto world = dart::simulation::World::create();
  auto ground = Skeleton::create("ground");
  auto* floor = ground->createJointAndBodyNodePair<WeldJoint>().second;
  floor->createShapeNodeWith<CollisionAspect, DynamicsAspect>(std::make_shared<PlaneShape>(Vec3::UnitZ(), 0));
  world->addSkeleton(ground);
  for (int i = 0; i < boxes; ++i) {
    auto box = Skeleton::create("box" + std::to_string(i));
    auto [joint, body] = box->createJointAndBodyNodePair<FreeJoint>();
    auto shape = std::make_shared<BoxShape>(Vec3(0.4, 0.4, 0.4));
    body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
    body->setInertia(Inertia(1, Vec3::Zero(), shape->computeInertia(1)));
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    place.translation() = Vec3(0, 0, 0.2 + 0.4 * i);
    place.linear() = Eigen::AngleAxisd(0.1 * i, Vec3::UnitZ()).toRotationMatrix();
    FreeJoint::setTransformOf(joint, place);
    world->addSkeleton(box);
  }
  return world;
}

TEST(DartWorld, AStackStandsAndIsRecorded) {
  auto world = stack(4);
  auto detector = DartDetector::create();
  world->getConstraintSolver()->setCollisionDetector(detector);
  for (int step = 0; step < 1000; ++step) world->step();
  for (std::size_t i = 1; i < world->getNumSkeletons(); ++i) {
    const Vec3 at = world->getSkeleton(i)->getBodyNode(0)->getTransform().translation();
    EXPECT_NEAR(at.head<2>().norm(), 0, 5e-3);
    EXPECT_NEAR(at.z(), 0.2 + 0.4 * static_cast<double>(i - 1), 5e-3);
  }
  EXPECT_GE(detector->report().answered, 4 * 1000);
  const std::string path = testing::TempDir() + "dart_contacts.jsonl";
  DartRecorder recorder(path.c_str());
  ASSERT_TRUE(recorder.good());
  recorder.write(*world->getConstraintSolver()->getCollisionGroup(), world->getConstraintSolver()->getCollisionOption(),
                 world->getTime());
  EXPECT_GE(recorder.contacts(), 4);
  EXPECT_EQ(recorder.unsupported(), 0);
  EXPECT_TRUE(recorder.close());
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_NE(text.str().find("DART, detector pdepth"), std::string::npos);
  std::remove(path.c_str());
  EXPECT_FALSE(DartRecorder("/nowhere/contacts.jsonl").good());
}

}  // namespace
}  // namespace pd
