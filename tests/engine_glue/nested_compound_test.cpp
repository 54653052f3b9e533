// URDF importers make compounds of compounds. Their children touch as those of one compound do.
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "union_worlds.hpp"

namespace pd::test {
namespace {

btTransform at(double x, double y, double z) {
  const btVector3 origin(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  return btTransform(btQuaternion::getIdentity(), origin);
}

enum class Ground { box, compound, plane, mesh };

/// A plank of four boxes side by side on a ground: as one compound, or the two halves as compounds of their own.
struct Plank {
  explicit Plank(bool nested, Ground ground = Ground::box) {
    auto* piece = w.bullet.shape<btBoxShape>(btVector3(btScalar(0.25), btScalar(0.125), btScalar(0.5)));
    whole = w.bullet.shape<btCompoundShape>();
    for (const double x : {-0.5, 0.5}) {
      btCompoundShape* const holder = nested ? w.bullet.shape<btCompoundShape>() : whole;
      const double left = nested ? -0.25 : x - 0.25;
      holder->addChildShape(at(left, 0, 0), piece);
      holder->addChildShape(at(left + 0.5, 0, 0), piece);
      if (nested) whole->addChildShape(at(x, 0, 0), holder);
    }
    switch (ground) {
      case Ground::box:
        w.fixed(w.bullet.shape<btBoxShape>(btVector3(5, 1, 5)), btVector3(0, -1, 0));
        break;
      case Ground::compound: {
        auto* tiles = w.bullet.shape<btCompoundShape>();
        auto* tile = w.bullet.shape<btBoxShape>(btVector3(1, 1, 5));
        for (const double x : {-2., 0., 2.}) tiles->addChildShape(at(x, 0, 0), tile);
        w.fixed(tiles, btVector3(0, -1, 0));
        break;
      }
      case Ground::plane:
        w.fixed(w.bullet.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)));
        break;
      case Ground::mesh: {
        const btVector3 a(-5, 0, -5), b(-5, 0, 5), c(5, 0, -5), d(5, 0, 5);
        w.fixed(w.mesh({{a, b, c}, {c, b, d}}, 0));
        break;
      }
    }
    body = w.moving(whole, at(0, 0.135, 0), btVector3(0, 0, 0));
  }
  std::vector<const btManifoldPoint*> points() {
    std::vector<const btManifoldPoint*> all;
    btDispatcher& dispatcher = *w.bullet.world().getDispatcher();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k) all.push_back(&manifold.getContactPoint(k));
    }
    return all;
  }
  /// The number of the plank's piece at each of its points.
  std::vector<int> pieces() {
    std::vector<int> numbers;
    btDispatcher& dispatcher = *w.bullet.world().getDispatcher();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      const bool first = manifold.getBody0() == body;
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        numbers.push_back(first ? point.m_index0 : point.m_index1);
      }
    }
    return numbers;
  }

  UnionWorld w;
  btCompoundShape* whole = nullptr;
  btRigidBody* body = nullptr;
};

class NestedCompound : public testing::TestWithParam<Ground> {};

TEST_P(NestedCompound, RestsWithTheBitsOfOneWithoutCompounds) {
  Plank nested(true, GetParam()), flat(false, GetParam());
  for (int i = 0; i < 120; ++i) {
    nested.w.step();
    flat.w.step();
    ASSERT_EQ(nested.body->getWorldTransform(), flat.body->getWorldTransform()) << i;
    ASSERT_EQ(nested.points().size(), flat.points().size()) << i;
  }
  EXPECT_EQ(nested.points().size(), 4U);
}

/// Bullet numbers the children of the innermost compound.
TEST_P(NestedCompound, TellsHostsTheNumberInTheCompoundThatHoldsTheChild) {
  Plank nested(true, GetParam()), flat(false, GetParam());
  nested.w.step(60);
  flat.w.step(60);
  std::vector<int> told = nested.pieces(), expected = flat.pieces();
  for (int& number : expected) number %= 2;
  std::sort(told.begin(), told.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(told, expected);
}

std::string ground_name(const testing::TestParamInfo<Ground>& instance) {
  constexpr const char* kNames[] = {"Box", "Compound", "Plane", "Mesh"};
  return kNames[static_cast<int>(instance.param)];
}

INSTANTIATE_TEST_SUITE_P(Grounds, NestedCompound,
                         testing::Values(Ground::box, Ground::compound, Ground::plane, Ground::mesh), ground_name);

TEST(NestedCompounds, AChildThatIsMovedInsideIsSeen) {
  Plank plank(true);
  plank.w.step(60);
  EXPECT_NEAR(plank.body->getWorldTransform().getOrigin().y(), 0.125, 1e-3);
  for (int i = 0; i < 2; ++i) {
    auto& half = static_cast<btCompoundShape&>(*plank.whole->getChildShape(i));
    half.updateChildTransform(0, at(-0.25, -0.0625, 0));
    half.updateChildTransform(1, at(0.25, -0.0625, 0));
    plank.whole->updateChildTransform(i, plank.whole->getChildTransform(i));
  }
  plank.w.step(120);
  EXPECT_NEAR(plank.body->getWorldTransform().getOrigin().y(), 0.1875, 1e-3);
  EXPECT_EQ(plank.points().size(), 4U);
}

TEST(NestedCompounds, AreTakenApartWhereAHostJudgesPairsOfChildren) {
  Plank plank(true);
  static bool saw_compound = false;
  saw_compound = false;
  gCompoundChildShapePairCallback = [](const btCollisionShape* a, const btCollisionShape* b) {
    saw_compound = saw_compound || a->isCompound() || b->isCompound();
    return true;
  };
  plank.w.step(60);
  gCompoundChildShapePairCallback = nullptr;
  EXPECT_TRUE(saw_compound);
  EXPECT_NEAR(plank.body->getWorldTransform().getOrigin().y(), 0.125, 1e-3);
}

}  // namespace
}  // namespace pd::test
