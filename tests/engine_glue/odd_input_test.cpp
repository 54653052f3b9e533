// Questions and settings that are no numbers, or endless, and shapes that are left to Bullet: each is answered, or
// refused by name.
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"
#include "pd/bullet/world_queries.hpp"

namespace pd::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

btTransform at(double x, double y, double z) {
  const btVector3 origin(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  return btTransform(btQuaternion::getIdentity(), origin);
}

enum class Ground { box, plane, mesh, heightfield, mesh_in_compound };
constexpr Ground kGrounds[] = {Ground::box, Ground::plane, Ground::mesh, Ground::heightfield, Ground::mesh_in_compound};

/// A ground whose top is at y = 1.
struct Top {
  explicit Top(Ground ground) {
    switch (ground) {
      case Ground::box:
        w.body(w.shape<btBoxShape>(btVector3(5, 1, 5)), 0, btVector3(0, 0, 0));
        break;
      case Ground::plane:
        w.body(w.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(1)), 0, btVector3(0, 0, 0));
        break;
      case Ground::heightfield:
        w.body(w.shape<btHeightfieldTerrainShape>(3, 3, heights.data(), btScalar(1), btScalar(-1), btScalar(1), 1,
                                                  PHY_FLOAT, false),
               0, btVector3(0, 1, 0));
        break;
      case Ground::mesh:
      case Ground::mesh_in_compound: {
        const btVector3 a(-5, 0, -5), b(-5, 0, 5), c(5, 0, -5), d(5, 0, 5);
        triangles.addTriangle(a, b, c);
        triangles.addTriangle(c, b, d);
        btCollisionShape* shape = w.shape<btBvhTriangleMeshShape>(&triangles, true);
        shape->setMargin(0);
        if (ground == Ground::mesh_in_compound) {
          auto* compound = w.shape<btCompoundShape>();
          compound->addChildShape(btTransform::getIdentity(), shape);
          shape = compound;
        }
        w.body(shape, 0, btVector3(0, 1, 0));
        break;
      }
    }
    w.world().updateAabbs();
  }
  btTriangleMesh triangles;
  std::vector<btScalar> heights =
      std::vector<btScalar>(9, btScalar(0));  ///< Bullet reads PHY_FLOAT in its own precision
  BulletWorld w;
  btSphereShape ball{btScalar(0.25)};
};

TEST(OddInput, TheNearestIsFoundHoweverFarItMayBe) {
  for (const Ground ground : kGrounds) {
    Top top(ground);
    for (const double reach : {2.0, 1e6, 1e15, 1e30, 1e38, std::numeric_limits<double>::max(), kInfinity}) {
      const auto found = distance_test(top.w.world(), top.ball, at(0.1, 3, 0.2), reach);
      ASSERT_TRUE(found);
      ASSERT_TRUE(found->nearest) << static_cast<int>(ground) << " " << reach;
      EXPECT_NEAR(found->nearest->distance, 1.75, 1e-6) << static_cast<int>(ground) << " " << reach;
      EXPECT_NEAR(found->nearest->normal.y(), 1, 1e-6);
    }
  }
}

TEST(OddInput, SweepsOfAnyLengthMeetTheGround) {
  for (const Ground ground : kGrounds) {
    Top top(ground);
    for (const double way : {1e3, 3e7, 1e8, 1e9, 1e12}) {
      for (const bool up : {false, true}) {
        const auto far = static_cast<double>(static_cast<btScalar>(way));
        const auto found =
            sweep_test(top.w.world(), top.ball, at(0.1, up ? -3 : 3, 0.2), at(0.1, up ? far : -far, 0.2));
        ASSERT_TRUE(found);
        ASSERT_TRUE(found->hit) << static_cast<int>(ground) << " " << way << " " << up;
        const double expected = up && ground != Ground::box ? 3.75 : 1.75;
        EXPECT_NEAR(found->hit->fraction * (far + 3), expected, 1e-5 + 1e-14 * far) << static_cast<int>(ground);
      }
    }
  }
}

/// Bullet's triangles of a plane that leans are off by a share of the reach.
TEST(OddInput, PlanesAreExactHoweverFarTheReach) {
  const Vec3 normal = Vec3(1, 2, 3).normalized();
  BulletWorld w;
  const btVector3 leaning(static_cast<btScalar>(normal.x()), static_cast<btScalar>(normal.y()),
                          static_cast<btScalar>(normal.z()));
  w.body(w.shape<btStaticPlaneShape>(leaning, btScalar(0)), 0, btVector3(0, 0, 0));
  w.world().updateAabbs();
  btSphereShape ball(btScalar(0.25));
  for (const double reach : {10., 1e6, kInfinity}) {
    const auto found = distance_test(w.world(), ball, at(normal.x(), normal.y(), normal.z()), reach);
    ASSERT_TRUE(found && found->nearest);
    EXPECT_NEAR(found->nearest->distance, 0.75, 2e-7) << reach;
  }
}

TEST(OddInput, QueriesRefuseWhatIsNoNumber) {
  Top top(Ground::mesh);
  const auto expect_refused = [](const auto& answer, ErrorCode code, const std::string& where) {
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code) << where;
    EXPECT_EQ(answer.error().where, where);
  };
  const btTransform start = at(0, 3, 0);
  btCollisionWorld::ClosestConvexResultCallback callback(start.getOrigin(), start.getOrigin());
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    const btTransform lost = at(0, bad, 0);
    expect_refused(sweep_test(top.w.world(), top.ball, lost, start), ErrorCode::non_finite, "from");
    expect_refused(sweep_test(top.w.world(), top.ball, start, lost), ErrorCode::non_finite, "to");
    expect_refused(sweep_test(top.w.world(), top.ball, start, lost, callback), ErrorCode::non_finite, "to");
    expect_refused(distance_test(top.w.world(), top.ball, lost, 1), ErrorCode::non_finite, "pose");
  }
  for (const double bad : {kNaN, kInfinity, 0., -1.}) {
    WorldQuerySettings settings;
    settings.tolerance = bad;
    expect_refused(sweep_test(top.w.world(), top.ball, start, start, settings), ErrorCode::bad_value,
                   "settings.tolerance");
    expect_refused(distance_test(top.w.world(), top.ball, start, 1, settings), ErrorCode::bad_value,
                   "settings.tolerance");
  }
  for (const double bad : {kNaN, -1., -kInfinity}) {
    expect_refused(distance_test(top.w.world(), top.ball, start, bad), ErrorCode::bad_value, "reach");
  }
}

/// Returns the height of a bouncing ball after a second of steps, and how many parts they had.
std::pair<btScalar, int> bounced(const RollbackSettings& settings) {
  Top top(Ground::box);
  BulletPenetrationDepthSolver solver;
  install(top.w.world(), solver);
  btRigidBody* ball = top.w.body(&top.ball, 1, btVector3(0, 2, 0));
  ball->setRestitution(1);
  top.w.bodies().front()->setRestitution(1);
  RollbackStepper stepper(top.w.world(), solver, settings);
  int parts = 0;
  for (int i = 0; i < 60; ++i) parts += stepper.step(btScalar(1) / 60).parts;
  return {ball->getWorldTransform().getOrigin().y(), parts};
}

TEST(OddInput, SettingsOutOfRangeAreTheDefaults) {
  const auto usual = bounced({});
  const auto expect_usual = [&](double RollbackSettings::*member, double bad) {
    RollbackSettings settings;
    settings.*member = bad;
    EXPECT_EQ(bounced(settings), usual) << bad;
  };
  for (const double bad : {kNaN, kInfinity, -1.}) {
    expect_usual(&RollbackSettings::gap, bad);
    expect_usual(&RollbackSettings::contact_slop, bad);
    expect_usual(&RollbackSettings::least_part, bad);
  }
  expect_usual(&RollbackSettings::gap, 0);
  expect_usual(&RollbackSettings::least_part, 2);
}

void keep_line(const char* line, void* user) { *static_cast<std::string*>(user) += line; }

/// Bodies without exact form stay where Bullet has them stay. Bullet's several ways to ask for a pair make differences
/// where margins are negative.
void expect_left_to_bullet(btConvexShape& shape, const std::string& name) {
  for (const Ground ground : kGrounds) {
    SCOPED_TRACE(name + " on " + std::to_string(static_cast<int>(ground)));
    std::string line;
    btScalar height[2];
    for (const bool ours : {false, true}) {
      Top top(ground);
      BulletSolverSettings settings;
      settings.warning = keep_line;
      settings.user = &line;
      BulletPenetrationDepthSolver solver(settings);
      if (ours) install(top.w.world(), solver);
      btRigidBody* body = top.w.body(&shape, 1, btVector3(0, btScalar(1.6), 0));
      body->setMassProps(1, btVector3(1, 1, 1));
      body->setAngularFactor(0);
      for (int i = 0; i < 60; ++i) top.w.world().stepSimulation(btScalar(1) / 60, 0);
      height[ours ? 1 : 0] = body->getWorldTransform().getOrigin().y();
      if (ours && ground != Ground::box && ground != Ground::plane) {
        EXPECT_GT(solver.statistics().unsupported, 0);
      }
    }
    EXPECT_GT(height[0], btScalar(0.9));
    EXPECT_NEAR(height[1], height[0], 0.1);
    if (ground == Ground::mesh) {
      EXPECT_EQ(line.rfind("pdepth: " + name + ": ", 0), 0) << line;
    }
  }
}

TEST(OddInput, ShapesWithoutExactFormAreLeftToBullet) {
  btConeShape needle(0, 1), disc(1, 0);
  expect_left_to_bullet(needle, "Cone");
  expect_left_to_bullet(disc, "Cone");
  btConvexHullShape hull;
  for (int i = 0; i < 8; ++i) {
    hull.addPoint(btVector3(i & 1 ? btScalar(0.5) : btScalar(-0.5), i & 2 ? btScalar(0.5) : btScalar(-0.5),
                            i & 4 ? btScalar(0.5) : btScalar(-0.5)));
  }
  hull.setMargin(btScalar(-0.1));
  expect_left_to_bullet(hull, "Convex");
  btBoxShape box(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  box.setMargin(btScalar(-0.1));
  expect_left_to_bullet(box, "Box");
}

/// A refusal names the type of shape.
TEST(OddInput, RefusalsNameTheShape) {
  btConeShape cone(static_cast<btScalar>(kNaN), 1);
  EXPECT_EQ(to_convex_shape(cone).error().where.rfind("Cone.", 0), 0);
  btSphereShape sphere(static_cast<btScalar>(kInfinity));
  EXPECT_EQ(to_convex_shape(sphere).error().where.rfind("SPHERE.", 0), 0) << to_convex_shape(sphere).error().where;
  btUniformScalingShape scaled(&cone, 2);
  EXPECT_EQ(to_convex_shape(scaled).error().where.rfind("UniformScalingShape.Cone.", 0), 0);
}

}  // namespace
}  // namespace pd::test
