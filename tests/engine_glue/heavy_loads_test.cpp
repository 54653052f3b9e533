// Heavy bodies on light ones stand at Bullet's default settings, and what is no load is not pushed.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/snapshot.hpp"

namespace pd::test {
namespace {

constexpr btScalar kStep = btScalar(1) / 60;

enum class Ground { box, mesh };

struct LoadedWorld : BulletWorld {
  explicit LoadedWorld(Ground ground = Ground::box) {
    install(world(), solver);
    if (ground == Ground::box) {
      floor = body(shape<btBoxShape>(btVector3(20, 1, 20)), 0, btVector3(0, -1, 0));
    } else {
      for (int i = -10; i < 10; ++i) {
        for (int k = -10; k < 10; ++k) {
          const btVector3 p(static_cast<btScalar>(i), 0, static_cast<btScalar>(k));
          const btVector3 q = p + btVector3(1, 0, 0), r = p + btVector3(0, 0, 1), s = p + btVector3(1, 0, 1);
          triangles.addTriangle(p, r, q);
          triangles.addTriangle(q, r, s);
        }
      }
      floor = body(shape<btBvhTriangleMeshShape>(&triangles, true), 0, btVector3(0, 0, 0));
    }
    floor->setFriction(1);
  }

  /// Boxes of a metre in rows and columns, as one body.
  btCollisionShape* slab(int rows, int columns) {
    auto* cube = shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
    auto* compound = shape<btCompoundShape>();
    for (int i = 0; i < rows; ++i) {
      for (int k = 0; k < columns; ++k) {
        const btVector3 at(static_cast<btScalar>(i) - btScalar(0.5) * static_cast<btScalar>(rows - 1), 0,
                           static_cast<btScalar>(k) - btScalar(0.5) * static_cast<btScalar>(columns - 1));
        compound->addChildShape(btTransform(btQuaternion::getIdentity(), at), cube);
      }
    }
    return compound;
  }
  btRigidBody* awake(btRigidBody* added) {
    added->setActivationState(DISABLE_DEACTIVATION);
    return added;
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) world().stepSimulation(kStep, 0);
  }

  BulletPenetrationDepthSolver solver;
  btTriangleMesh triangles;
  btRigidBody* floor = nullptr;
};

double height(const btRigidBody& body) { return static_cast<double>(body.getCenterOfMassPosition().y()); }

class HeavyCompound : public testing::TestWithParam<std::tuple<Ground, int, int>> {};

TEST_P(HeavyCompound, LiesOnALightOne) {
  const auto [ground, children, ratio] = GetParam();
  LoadedWorld w(ground);
  const int columns = children == 16 ? 4 : children == 9 ? 3 : 2;
  btCollisionShape* slab = w.slab(children / columns, columns);
  const auto mass = static_cast<btScalar>(children);
  const btRigidBody& light = *w.awake(w.body(slab, mass, btVector3(0, btScalar(0.55), 0)));
  const btRigidBody& heavy =
      *w.awake(w.body(slab, mass * static_cast<btScalar>(ratio), btVector3(0, btScalar(1.6), 0)));
  w.step(180);
  EXPECT_NEAR(height(light), 0.5, 0.01);
  EXPECT_NEAR(height(heavy), 1.5, 0.02);
  EXPECT_LE(w.num_contacts(), 24) << "Bullet has more than a hundred";
}

std::string slab_name(const testing::TestParamInfo<HeavyCompound::ParamType>& instance) {
  const auto [ground, children, ratio] = instance.param;
  return std::string(ground == Ground::box ? "Box" : "Mesh") + std::to_string(children) + "Times" +
         std::to_string(ratio);
}

INSTANTIATE_TEST_SUITE_P(Slabs, HeavyCompound,
                         testing::Values(std::tuple(Ground::box, 9, 200), std::tuple(Ground::mesh, 9, 200),
                                         std::tuple(Ground::box, 4, 100), std::tuple(Ground::box, 2, 100),
                                         std::tuple(Ground::box, 16, 1000), std::tuple(Ground::mesh, 6, 500)),
                         slab_name);

TEST(HeavyLoads, FourLightPillarsCarryAPlate) {
  LoadedWorld w;
  auto* pillar = w.shape<btBoxShape>(btVector3(btScalar(0.25), btScalar(0.25), btScalar(0.25)));
  for (const btScalar x : {btScalar(-0.75), btScalar(0.75)}) {
    for (const btScalar z : {btScalar(-0.75), btScalar(0.75)}) {
      w.awake(w.body(pillar, 1, btVector3(x, btScalar(0.25), z)));
    }
  }
  const btRigidBody& plate =
      *w.awake(w.body(w.shape<btBoxShape>(btVector3(1, btScalar(0.25), 1)), 400, btVector3(0, btScalar(0.8), 0)));
  w.step(300);
  EXPECT_NEAR(height(plate), 0.75, 0.005);
}

TEST(HeavyLoads, AForceOfTheHostIsNoLoad) {
  LoadedWorld w;
  auto* box = w.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  w.awake(w.body(box, 1, btVector3(0, btScalar(0.5), 0)));
  btRigidBody& heavy = *w.awake(w.body(box, 200, btVector3(0, btScalar(1.5), 0)));
  for (int i = 0; i < 120; ++i) {
    heavy.applyCentralForce(btVector3(0, btScalar(200 * 9.81 * 0.9), 0));
    w.step(1);
    ASSERT_NEAR(height(heavy), 1.5, 0.01) << "step " << i;
  }
}

TEST(HeavyLoads, BodiesThatFallTogetherDoNotPush) {
  LoadedWorld w;
  auto* box = w.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  const btRigidBody& light = *w.awake(w.body(box, 1, btVector3(0, 10, 0)));
  const btRigidBody& heavy = *w.awake(w.body(box, 200, btVector3(0, 11, 0)));
  for (int i = 0; i < 60; ++i) {
    w.step(1);
    ASSERT_LT((light.getLinearVelocity() - heavy.getLinearVelocity()).length(), btScalar(1e-3)) << "step " << i;
  }
}

TEST(HeavyLoads, ASnapshotReplaysTheSameBits) {
  LoadedWorld w;
  btCollisionShape* slab = w.slab(2, 2);
  w.awake(w.body(slab, 4, btVector3(0, btScalar(0.51), 0)));
  const btRigidBody& heavy = *w.awake(w.body(slab, 800, btVector3(0, btScalar(1.52), 0)));
  w.step(7);
  BulletSnapshot saved(w.world(), &w.solver);
  std::vector<btVector3> first, second;
  for (std::vector<btVector3>* const heights : {&first, &second}) {
    for (int i = 0; i < 20; ++i) {
      w.step(1);
      heights->push_back(heavy.getCenterOfMassPosition());
    }
    ASSERT_EQ(saved.restore(), Restored::yes);
  }
  EXPECT_TRUE(first == second);
}

}  // namespace
}  // namespace pd::test
