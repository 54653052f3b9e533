// Points that all go on are written four at a time: bit for bit what the way point by point gives.
#include "pair/lasting_points.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

namespace pd::test {
namespace {

using detail::FreshPoints;
using detail::PairMemory;

/// A manifold with its memory between two boxes.
struct Pair {
  explicit Pair(btScalar threshold)
      : manifold(&a, &b, 0, threshold, threshold),
        of_a(nullptr, &shape, &a, a.getWorldTransform(), -1, -1),
        of_b(nullptr, &shape, &b, b.getWorldTransform(), -1, -1),
        result(&of_a, &of_b) {
    a.setCollisionShape(&shape);
    b.setCollisionShape(&shape);
    result.setPersistentManifold(&manifold);
  }

  btBoxShape shape{btVector3(1, 1, 1)};
  btCollisionObject a, b;
  btPersistentManifold manifold;
  PairMemory memory;
  btCollisionObjectWrapper of_a, of_b;
  btManifoldResult result;
};

/// Each point goes through Bullet.
struct OneByOne : detail::PointSurroundings {
  void enter(int) override {}
  void leave() override {}
  [[nodiscard]] bool numbers(int, detail::PieceNumbers&) const override { return false; }
};

/// Each point between pieces of its own, as on a mesh or compound: points that go on are known by their numbers, or go
/// through Bullet.
struct Pieces : detail::PointSurroundings {
  Pieces(btManifoldResult& taken, bool all_at_once, int first) : result(taken), at_once(all_at_once), step(first) {}
  void enter(int k) override {
    result.setShapeIdentifiersA(step, k);
    result.setShapeIdentifiersB(7, step + k);
  }
  void leave() override {}
  [[nodiscard]] bool numbers(int k, detail::PieceNumbers& out) const override {
    out = {step, k, 7, step + k};
    return at_once;
  }

  btManifoldResult& result;
  bool at_once;
  int step;
};

/// All but padding.
bool same_bits(const btManifoldPoint& x, const btManifoldPoint& y) {
  const auto same = [&](const auto& first, const auto& last) {
    const char* const of_x = reinterpret_cast<const char*>(&x);
    const auto from = static_cast<std::size_t>(reinterpret_cast<const char*>(&first) - of_x);
    const auto to = static_cast<std::size_t>(reinterpret_cast<const char*>(&last) - of_x) + sizeof(last);
    return std::memcmp(of_x + from, reinterpret_cast<const char*>(&y) + from, to - from) == 0;
  };
  return same(x.m_localPointA, x.m_index1) && same(x.m_userPersistentData, x.m_contactPointFlags) &&
         same(x.m_appliedImpulse, x.m_lifeTime) && same(x.m_lateralFrictionDir1, x.m_lateralFrictionDir2);
}

void expect_equal(const Pair& x, const Pair& y) {
  ASSERT_EQ(x.manifold.getNumContacts(), y.manifold.getNumContacts());
  ASSERT_EQ(x.memory.num_points, y.memory.num_points);
  ASSERT_EQ(x.memory.seconds, y.memory.seconds);
  for (int i = 0; i < x.manifold.getNumContacts(); ++i) {
    ASSERT_TRUE(same_bits(x.manifold.getContactPoint(i), y.manifold.getContactPoint(i))) << i;
    const detail::RememberedPoint& known_x = x.memory.points[i];
    const detail::RememberedPoint& known_y = y.memory.points[i];
    ASSERT_EQ(known_x.feature_id, known_y.feature_id);
    ASSERT_EQ(known_x.local_a, known_y.local_a);
    ASSERT_EQ(known_x.impulse.carried, known_y.impulse.carried);
    ASSERT_EQ(known_x.impulse.handed, known_y.impulse.handed);
  }
}

/// How many of 20,000 steps, in which bodies creep, slide and jump, points come and go, and orders turn, were taken all
/// at once.
void compare(int points, bool pieces, unsigned seed, int& lasting) {
  std::mt19937 random(seed);
  const auto within = [&](double size) {
    return static_cast<btScalar>(std::uniform_real_distribution<double>(-size, size)(random));
  };
  const btScalar threshold = btScalar(0.02);
  Pair at_once(threshold), one_by_one(threshold);
  btTransform pose_a = btTransform::getIdentity(), pose_b = btTransform::getIdentity();
  pose_a.setOrigin(btVector3(3, 2, -1));
  pose_b.setOrigin(btVector3(3, btScalar(0.01), -1));
  for (int step = 0; step < 20000; ++step) {
    const double jump = random() % 50 == 0 ? 0.1 : random() % 10 == 0 ? 5e-3 : 1e-4;
    for (btTransform* pose : {&pose_a, &pose_b}) {
      pose->getOrigin() += btVector3{within(jump), within(jump), within(jump)};
      pose->setRotation(pose->getRotation() * btQuaternion{within(jump), within(jump), within(jump), 1}.normalized());
    }
    FreshPoints fresh;
    fresh.count = random() % 40 == 0 ? static_cast<int>(random() % 5) : points;
    const btVector3 normal = pose_b.getBasis().getColumn(1);
    const unsigned turn = random() % 3 == 0 ? static_cast<unsigned>(random() % 4) : 0;
    const bool other_features = random() % 20 == 0;
    for (int i = 0; i < fresh.count; ++i) {
      const unsigned corner = (static_cast<unsigned>(i) + turn) % 4;
      const btVector3 place(corner % 2 == 0 ? btScalar(1) : btScalar(-1), 1, corner < 2 ? btScalar(1) : btScalar(-1));
      const btVector3 own = pieces && random() % 4 == 0 ? (normal + btVector3(within(0.1), 0, 0)).normalized() : normal;
      fresh.points[i] = {own, pose_b(place), within(0.01), static_cast<int>(corner) + (other_features ? 10 : 0), i};
    }
    const btScalar seconds = btScalar(1) / (random() % 10 == 0 ? 120 : 60);
    for (Pair* pair : {&at_once, &one_by_one}) {
      pair->a.setWorldTransform(pose_a);
      pair->b.setWorldTransform(pose_b);
    }
    detail::LastingPoints order;
    lasting += detail::may_all_last(at_once.manifold, at_once.memory, fresh, at_once.result) &&
                       detail::order_by_feature(at_once.memory, fresh, order)
                   ? 1
                   : 0;
    if (pieces) {
      Pieces together(at_once.result, true, step), apart(one_by_one.result, false, step);
      detail::replace_points({at_once.manifold, at_once.memory, fresh, {seconds}, at_once.result, &together});
      detail::replace_points({one_by_one.manifold, one_by_one.memory, fresh, {seconds}, one_by_one.result, &apart});
    } else {
      OneByOne alone;
      detail::replace_points({at_once.manifold, at_once.memory, fresh, {seconds}, at_once.result});
      detail::replace_points({one_by_one.manifold, one_by_one.memory, fresh, {seconds}, one_by_one.result, &alone});
    }
    expect_equal(at_once, one_by_one);
    if (testing::Test::HasFatalFailure()) FAIL() << "step " << step;
    // What Bullet's solver leaves behind.
    for (int i = 0; i < at_once.manifold.getNumContacts(); ++i) {
      const btScalar impulse = std::max(btScalar(0), within(1) + btScalar(0.5)), along = within(0.6),
                     across = within(0.3);
      for (Pair* pair : {&at_once, &one_by_one}) {
        btManifoldPoint& point = pair->manifold.getContactPoint(i);
        point.m_appliedImpulse = impulse;
        point.m_appliedImpulseLateral1 = along;
        point.m_appliedImpulseLateral2 = across;
        point.m_prevRHS = along;
        point.m_lateralFrictionDir1 = btVector3(along, across, impulse);
        // A host's own touch.
        if (impulse > btScalar(1.49)) point.m_localPointA += btVector3(along, 0, across) * btScalar(1e-3);
      }
    }
  }
}

void compare_all(bool pieces) {
  for (int points = 1; points <= 4; ++points) {
    int lasting = 0;
    compare(points, pieces, 7U + static_cast<unsigned>(points), lasting);
    EXPECT_GT(lasting, 5000) << points;
    EXPECT_LT(lasting, 20000) << points;
  }
}

TEST(LastingPoints, AreThoseOfTheWayPointByPoint) { compare_all(false); }
TEST(LastingPoints, OfPiecesAreThoseOfTheWayPointByPoint) { compare_all(true); }

TEST(LastingPoints, OrderIsFoundByFeature) {
  PairMemory memory;
  FreshPoints fresh;
  fresh.count = 4;
  for (int i = 0; i < 4; ++i) {
    memory.points[i].feature_id = 10 + i;
    fresh.points[i].feature_id = 10 + (i * 3 + 2) % 4;
  }
  detail::LastingPoints order;
  ASSERT_TRUE(detail::order_by_feature(memory, fresh, order));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(fresh.points[order.points[i]].feature_id, memory.points[i].feature_id);
  fresh.points[1].feature_id = 12;  // twice, and 11 is missing
  EXPECT_FALSE(detail::order_by_feature(memory, fresh, order));
  memory.points[1].feature_id = 10;  // twice among the old
  EXPECT_FALSE(detail::order_by_feature(memory, fresh, order));
}

}  // namespace
}  // namespace pd::test
