/// @file
/// `pd::ContactRecorder`: what it writes of real worlds, judged. Every shape of the table, meshes, heightfields,
/// planes, compounds; a tower under Bullet's EPA and under ours.
#include <BulletCollision/CollisionDispatch/btBox2dBox2dCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btConvex2dConvex2dAlgorithm.h>
#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/NarrowPhaseCollision/btMinkowskiPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <cmath>
#include <memory>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/contact_recorder.hpp"
#include "pd/bullet/install.hpp"
#include "record_text.hpp"

namespace pd::test {
namespace {

using audit::Column;

/// Relative to L; poses, witnesses and depths are rounded to the scalar, and ours of curved bodies are within 1e-6 of
/// the depth.
constexpr double kRounding = sizeof(btScalar) == sizeof(float) ? 2e-6 : 2e-8;

/// Steps a world with a recorder in it.
Audited record_and_audit(BulletWorld& world, int steps, std::int64_t* unsupported = nullptr) {
  const TemporaryFolder folder;
  const std::string path = folder.path() / "contacts.jsonl";
  ContactRecorder recorder(world.world(), path.c_str());
  EXPECT_TRUE(recorder.good());
  for (int i = 0; i < steps; ++i) world.world().stepSimulation(btScalar(1) / 60, 0);
  EXPECT_TRUE(recorder.close());
  if (unsupported != nullptr) *unsupported = recorder.unsupported();
  Audited audited = audit_file(path);
  EXPECT_EQ(audited.total().contacts, recorder.contacts());
  for (const audit::RefusedLine& line : audited.audit->summary.refusals()) {
    ADD_FAILURE() << line.line << ": " << line.refusal.code << " " << line.refusal.message << " " << line.refusal.where;
  }
  return audited;
}

std::int64_t contacts_of(const Audited& audited, const std::string& kind) {
  const auto found = audited.audit->summary.by_kind().find(kind);
  return found == audited.audit->summary.by_kind().end() ? 0 : found->second.contacts;
}

/// What stands alone on a floor, or leans by an angle about z, 1 mm deep.
template <class Floor>
Audited on_a_floor(btCollisionShape* (*make)(BulletWorld&), Floor&& floor, bool ours, double angle = 0) {
  BulletWorld world;
  BulletPenetrationDepthSolver solver;
  floor(world);
  btCollisionShape* shape = make(world);
  btVector3 low;
  btVector3 high;
  btTransform pose(btQuaternion(btVector3(0, 0, 1), btScalar(angle)));
  shape->getAabb(pose, low, high);  // of some shapes wider than they are
  if (shape->isConvex()) {
    const btVector3 down = btVector3(0, -1, 0) * pose.getBasis();
    low = pose * static_cast<btConvexShape*>(shape)->localGetSupportingVertex(down);
  }
  pose.setOrigin(btVector3(btScalar(0.1), -low.y() - btScalar(0.001), btScalar(0.2)));
  world.body(shape, 1, pose);
  if (ours) install(world.world(), solver);
  return record_and_audit(world, 3);
}

const std::vector<btCollisionShape* (*)(BulletWorld&)>& every_shape() {
  static const std::vector<btCollisionShape* (*)(BulletWorld&)> shapes{
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btBoxShape>(btVector3(1, 2, 3)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btSphereShape>(btScalar(1)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCapsuleShape>(btScalar(0.5), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCylinderShape>(btVector3(1, 2, 1)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btConeShape>(btScalar(1), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCapsuleShapeX>(btScalar(0.5), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCapsuleShapeZ>(btScalar(0.5), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCylinderShapeX>(btVector3(2, 1, 1)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btCylinderShapeZ>(btVector3(1, 1, 2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btConeShapeX>(btScalar(1), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btConeShapeZ>(btScalar(1), btScalar(2)); },
      [](BulletWorld& w) -> btCollisionShape* {
        return w.shape<btBU_Simplex1to4>(btVector3(1, -1, 0), btVector3(-1, -1, 1), btVector3(-1, -1, -1),
                                         btVector3(0, 1, 0));
      },
      [](BulletWorld& w) -> btCollisionShape* { return box_hull(w, btVector3(1, 1, 1), btScalar(0.04)); },
      [](BulletWorld& w) -> btCollisionShape* {
        auto* compound = w.shape<btCompoundShape>();
        auto* child = w.shape<btBoxShape>(btVector3(1, 1, 1));
        compound->addChildShape(btTransform(btQuaternion(0, 0, btScalar(0.1)), btVector3(2, 0, 0)), child);
        compound->addChildShape(btTransform(btQuaternion(0, 0, btScalar(-0.1)), btVector3(-2, 0, 0)), child);
        return compound;
      },
  };
  return shapes;
}

const std::vector<btVector3>& corners_of_a_wedge() {
  static const std::vector<btVector3> corners{btVector3(1, -1, 1),  btVector3(-1, -1, 1), btVector3(-1, -1, -1),
                                              btVector3(1, -1, -1), btVector3(0, 1, 1),   btVector3(0, 1, -1)};
  return corners;
}

btConvexHullShape* wedge(BulletWorld& w) {
  return w.shape<btConvexHullShape>(&corners_of_a_wedge()[0][0], static_cast<int>(corners_of_a_wedge().size()));
}

/// Clouds, sums, scaled shapes, and those of the plane.
const std::vector<btCollisionShape* (*)(BulletWorld&)>& rarer_shapes() {
  static const std::vector<btCollisionShape* (*)(BulletWorld&)> shapes{
      [](BulletWorld& w) -> btCollisionShape* {
        // Bullet keeps the pointer, and does not write.
        static std::vector<btVector3> points = corners_of_a_wedge();
        return w.shape<btConvexPointCloudShape>(points.data(), static_cast<int>(points.size()),
                                                btVector3(1, btScalar(0.5), 1));
      },
      [](BulletWorld& w) -> btCollisionShape* {
        return w.shape<btMinkowskiSumShape>(wedge(w), w.shape<btSphereShape>(btScalar(0.3)));
      },
      [](BulletWorld& w) -> btCollisionShape* {
        auto* sum = w.shape<btMinkowskiSumShape>(wedge(w), w.shape<btBoxShape>(btVector3(1, 1, 2)));
        sum->setTransformA(btTransform(btQuaternion(btVector3(0, 0, 1), btScalar(0.3))));
        return sum;
      },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btUniformScalingShape>(wedge(w), btScalar(0.7)); },
      [](BulletWorld& w) -> btCollisionShape* {
        return w.shape<btUniformScalingShape>(w.shape<btCylinderShape>(btVector3(1, 2, 1)), btScalar(0.7));
      },
      [](BulletWorld& w) -> btCollisionShape* {
        return w.shape<btUniformScalingShape>(w.shape<btConeShape>(btScalar(1), btScalar(2)), btScalar(1.3));
      },
      [](BulletWorld& w) -> btCollisionShape* {
        return w.shape<btUniformScalingShape>(w.shape<btBoxShape>(btVector3(1, 1, 1)), btScalar(1.3));
      },
      [](BulletWorld& w) -> btCollisionShape* {
        const btVector3 centres[3] = {btVector3(-1, 0, 0), btVector3(1, 0, 0), btVector3(0, btScalar(0.5), 1)};
        const btScalar radii[3] = {1, btScalar(0.5), btScalar(0.3)};
        return w.shape<btMultiSphereShape>(centres, radii, 3);
      },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btConvex2dShape>(wedge(w)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btBox2dShape>(btVector3(1, 2, 0)); },
      [](BulletWorld& w) -> btCollisionShape* { return w.shape<btBox2dShape>(btVector3(1, 2, btScalar(0.04))); },
  };
  return shapes;
}

void expect_exact(const Audited& audited, std::size_t shape) {
  SCOPED_TRACE(shape);
  EXPECT_GT(audited.total().contacts, 0);
  EXPECT_EQ(audited.total().judged, audited.total().contacts);
  EXPECT_EQ(audited.total().missed, 0);
  EXPECT_EQ(audited.total().phantom, 0);
  EXPECT_GT(audited.total().of(Column::depth_error).count(), 0);
  EXPECT_LE(audited.max(Column::depth_error), kRounding);
  EXPECT_LE(audited.max(Column::normal_excess), kRounding);
}

// Bullet's own answer against a plane is a support, right up to rounding: so is what the recorder makes of the shapes.
TEST(ContactRecorder, EveryShapeOnAPlane) {
  const auto plane = [](BulletWorld& world) {
    world.body(world.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)), 0, btVector3(0, 0, 0));
  };
  for (std::size_t i = 0; i < every_shape().size(); ++i) expect_exact(on_a_floor(every_shape()[i], plane, false), i);
}

// Our answers on a hull: exact, with the shapes' margins as the narrow phase takes them.
TEST(ContactRecorder, EveryShapeOnAHull) {
  const auto hull = [](BulletWorld& world) {
    world.body(box_hull(world, btVector3(20, 1, 20), btScalar(0.04)), 0, btVector3(0, btScalar(-1.04), 0));
  };
  for (std::size_t i = 0; i < every_shape().size(); ++i) {
    const Audited audited = on_a_floor(every_shape()[i], hull, true);
    expect_exact(audited, i);
    EXPECT_LE(audited.max(Column::point_error), 0.01) << i;
  }
}

TEST(ContactRecorder, RarerShapesOnAPlane) {
  const auto plane = [](BulletWorld& world) {
    world.body(world.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)), 0, btVector3(0, 0, 0));
  };
  for (std::size_t i = 0; i < rarer_shapes().size(); ++i) {
    for (const double angle : {0.0, 0.3}) expect_exact(on_a_floor(rarer_shapes()[i], plane, false, angle), i);
  }
}

TEST(ContactRecorder, RarerShapesOnAHull) {
  const auto hull = [](BulletWorld& world) {
    world.body(box_hull(world, btVector3(20, 1, 20), btScalar(0.04)), 0, btVector3(0, btScalar(-1.04), 0));
  };
  for (std::size_t i = 0; i < rarer_shapes().size(); ++i) {
    for (const double angle : {0.0, 0.3}) {
      const Audited audited = on_a_floor(rarer_shapes()[i], hull, true, angle);
      expect_exact(audited, i);
      EXPECT_LE(audited.max(Column::point_error), 0.01) << i;
    }
  }
}

TEST(ContactRecorder, TrianglesOfMeshesAndHeightfields) {
  static const std::vector<btScalar> corners{-20, 0, -20, 20, 0, -20, 20, 0, 20, -20, 0, 20};
  static std::vector<btScalar> scalars = corners;
  static std::vector<int> indices{0, 2, 1, 0, 3, 2};
  btTriangleIndexVertexArray mesh(2, indices.data(), 3 * sizeof(int), 4, scalars.data(), 3 * sizeof(btScalar));
  btBvhTriangleMeshShape triangles(&mesh, true);
  static const std::vector<float> heights(16, 0.0F);
  btHeightfieldTerrainShape field(4, 4, heights.data(), 1, 0, 0, 1, PHY_FLOAT, false);
  field.setLocalScaling(btVector3(10, 1, 10));
  for (btCollisionShape* floor : {static_cast<btCollisionShape*>(&triangles), static_cast<btCollisionShape*>(&field)}) {
    for (const bool ours : {false, true}) {
      BulletWorld world;
      BulletPenetrationDepthSolver solver;
      world.body(floor, 0, btVector3(0, 0, 0));
      auto* hull = box_hull(world, btVector3(1, 1, 1), btScalar(0.04));
      world.body(hull, 1, btVector3(btScalar(3.5), 1 + hull->getMargin() + floor->getMargin() - btScalar(0.001), 1));
      auto* ball = world.shape<btSphereShape>(btScalar(1));
      world.body(ball, 1, btVector3(btScalar(-5), btScalar(0.999), btScalar(-3)));
      if (ours) install(world.world(), solver);
      const Audited audited = record_and_audit(world, 2);
      EXPECT_GT(contacts_of(audited, "convex-convex"), 0) << ours;
      EXPECT_GT(contacts_of(audited, "convex-sphere"), 0) << ours;
      EXPECT_EQ(audited.total().judged, audited.total().contacts);
      EXPECT_EQ(audited.total().phantom, 0);
      if (ours) {
        EXPECT_LE(audited.max(Column::depth_error), kRounding);
      }
      // Bullet's algorithm for spheres and triangles has no margin, and neither has the recorded triangle.
      const auto& balls = audited.audit->summary.by_kind().at("convex-sphere");
      EXPECT_LE(balls.of(Column::depth_error).max(), 1e-5) << ours;
    }
  }
}

TEST(ContactRecorder, PairsThatDoNotMeetAreNothing) {
  BulletWorld world;
  world.world().setGravity(btVector3(0, 0, 0));
  auto* ball = world.shape<btSphereShape>(btScalar(1));
  world.body(ball, 1, btVector3(0, 0, 0));
  world.body(ball, 1, btVector3(btScalar(1.8), btScalar(1.8), 0));  // boxes meet, balls do not
  const Audited audited = record_and_audit(world, 1);
  EXPECT_EQ(audited.total().contacts, 1);
  EXPECT_EQ(audited.total().missed + audited.total().phantom, 0);
  EXPECT_EQ(audited.total().of(Column::depth_error).count(), 0) << "null was written";
}

TEST(ContactRecorder, CountsWhatItCannotWrite) {
  BulletWorld world;
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, btScalar(0.5)};
  auto* stretched = world.shape<btMultiSphereShape>(centres, radii, 2);
  stretched->setLocalScaling(btVector3(1, 1, btScalar(1.5)));
  world.body(stretched, 1, btVector3(0, 1, 0));
  world.body(world.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)), 0, btVector3(0, 0, 0));
  std::int64_t unsupported = 0;
  EXPECT_EQ(record_and_audit(world, 2, &unsupported).total().contacts, 0);
  EXPECT_EQ(unsupported, 2);
}

// In space a flat body leaves another across their common plane by no way at all: these depths are another question's.
TEST(ContactRecorder, CountsWhatBulletAnswersInThePlane) {
  for (const bool registered : {false, true}) {
    BulletWorld world;
    world.world().setGravity(btVector3(0, 0, 0));
    btVoronoiSimplexSolver simplex;
    btMinkowskiPenetrationDepthSolver depth;
    btConvex2dConvex2dAlgorithm::CreateFunc convex(&simplex, &depth);
    btBox2dBox2dCollisionAlgorithm::CreateFunc boxes;
    if (registered) {
      const int kBox = BOX_2D_SHAPE_PROXYTYPE, kConvex = CONVEX_2D_SHAPE_PROXYTYPE;
      world.dispatcher().registerCollisionCreateFunc(kConvex, kConvex, &convex);
      world.dispatcher().registerCollisionCreateFunc(kBox, kBox, &boxes);
    }
    auto* box = world.shape<btBox2dShape>(btVector3(1, 2, 0));
    world.body(box, 1, btVector3(0, 0, 0));
    world.body(box, 1, btVector3(btScalar(1.9), 0, 0));
    auto* flat = world.shape<btConvex2dShape>(wedge(world));
    world.body(flat, 1, btVector3(10, 0, 0));
    world.body(flat, 1, btVector3(btScalar(11.8), 0, 0));
    std::int64_t unsupported = 0;
    const Audited audited = record_and_audit(world, 1, &unsupported);
    EXPECT_EQ(audited.total().contacts, registered ? 0 : 2);
    EXPECT_EQ(unsupported, registered ? 2 : 0);
    EXPECT_EQ(audited.total().judged, audited.total().contacts);
  }
}

TEST(ContactRecorder, LeavesTheWorldAsItWas) {
  BulletWorld world;
  const auto before = world.dispatcher().getNearCallback();
  const TemporaryFolder folder;
  {
    ContactRecorder recorder(world.world(), (folder.path() / "contacts.jsonl").c_str());
    EXPECT_NE(world.dispatcher().getNearCallback(), before);
    ContactRecorder second(world.world(), (folder.path() / "second.jsonl").c_str());
    EXPECT_FALSE(second.good());
  }
  EXPECT_EQ(world.dispatcher().getNearCallback(), before);
  ContactRecorder nowhere(world.world(), (folder.path() / "no" / "contacts.jsonl").c_str());
  EXPECT_FALSE(nowhere.good());
  EXPECT_EQ(world.dispatcher().getNearCallback(), before);
}

/// Where a tower's bodies are after a while, recorded or not.
std::vector<btVector3> positions_after(int steps, bool recorded) {
  BulletWorld world;
  const TemporaryFolder folder;
  world.body(world.shape<btBoxShape>(btVector3(5, 1, 5)), 0, btVector3(0, -1, 0));
  auto* hull = box_hull(world, btVector3(1, 1, 1), btScalar(0));
  for (int i = 0; i < 4; ++i) world.body(hull, 1, btVector3(btScalar(0.1) * btScalar(i), btScalar(2 * i + 1), 0));
  std::unique_ptr<ContactRecorder> recorder;
  if (recorded) recorder = std::make_unique<ContactRecorder>(world.world(), (folder.path() / "contacts.jsonl").c_str());
  for (int i = 0; i < steps; ++i) world.world().stepSimulation(btScalar(1) / 60, 0);
  std::vector<btVector3> positions;
  for (const auto& body : world.bodies()) positions.push_back(body->getWorldTransform().getOrigin());
  return positions;
}

TEST(ContactRecorder, ChangesNothing) {
  const auto plain = positions_after(120, false);
  const auto recorded = positions_after(120, true);
  ASSERT_EQ(plain.size(), recorded.size());
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_TRUE(plain[i] == recorded[i]) << i;
}

/// Hulls of 2 cm with margin 0, as in the demo `stacking`.
Audited tower(bool ours) {
  BulletWorld world;
  BulletPenetrationDepthSolver solver;
  const auto half = btScalar(0.01);
  world.body(box_hull(world, btVector3(btScalar(0.1), half, btScalar(0.1)), 0), 0, btVector3(0, -half, 0));
  auto* hull = box_hull(world, btVector3(half, half, half), 0);
  for (int i = 0; i < 6; ++i) {
    btTransform pose(btQuaternion(btScalar(0.2) * btScalar(i), 0, 0), btVector3(0, half * btScalar(2 * i + 1), 0));
    world.body(hull, btScalar(0.1), pose);
  }
  if (ours) install(world.world(), solver);
  return record_and_audit(world, 60);
}

TEST(ContactRecorder, ATowerUnderBulletsDepthAndUnderOurs) {
  const Audited bullets = tower(false);
  const Audited ours = tower(true);
  for (const Audited* audited : {&bullets, &ours}) {
    EXPECT_GT(audited->total().judged, 300);
    EXPECT_EQ(audited->total().unanswered, 0);
  }
  EXPECT_EQ(ours.total().missed, 0);
  EXPECT_EQ(ours.total().phantom, 0);
  EXPECT_LE(ours.max(Column::depth_error), kRounding);
  EXPECT_LE(ours.max(Column::normal_excess), kRounding);
  std::printf(
      "[ tower    ] Bullet's: missed %lld, phantom %lld, depth error max %.2g, normal excess max %.2g of %lld\n",
      static_cast<long long>(bullets.total().missed), static_cast<long long>(bullets.total().phantom),
      bullets.max(Column::depth_error), bullets.max(Column::normal_excess),
      static_cast<long long>(bullets.total().judged));
  std::printf(
      "[ tower    ] ours:     missed %lld, phantom %lld, depth error max %.2g, normal excess max %.2g of %lld\n",
      static_cast<long long>(ours.total().missed), static_cast<long long>(ours.total().phantom),
      ours.max(Column::depth_error), ours.max(Column::normal_excess), static_cast<long long>(ours.total().judged));
  // In double precision Bullet's EPA is right about this tower, too.
  if (sizeof(btScalar) == sizeof(float)) {
    EXPECT_GT(bullets.max(Column::depth_error), 100 * ours.max(Column::depth_error));
  }
}

}  // namespace
}  // namespace pd::test
