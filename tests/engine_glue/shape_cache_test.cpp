// The cache never answers for what a shape was, only for what it is.
#include "pd/bullet/shape_cache.hpp"

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace {

TEST(ShapeCache, ConvertsOnceAndFollowsChanges) {
  pd::BulletShapeCache cache;
  btBoxShape box(btVector3(1, 1, 1));
  const auto first = cache.find_or_convert(box);
  EXPECT_EQ(cache.find_or_convert(box), first);
  EXPECT_EQ(cache.conversions(), 1);
  box.setLocalScaling(btVector3(2, 1, 1));
  const auto second = cache.find_or_convert(box);
  EXPECT_NE(second, first);
  EXPECT_EQ(cache.size(), 1u);
  EXPECT_GT(second->polytope()->max_abs_coordinate(), 1.9);
  EXPECT_LT(first->polytope()->max_abs_coordinate(), 1.0);  // still alive for those who hold it
}

TEST(ShapeCache, AddressUsedAgainByAnotherShape) {
  pd::BulletShapeCache cache;
  alignas(16) std::byte memory[std::max(sizeof(btSphereShape), sizeof(btCapsuleShape))];
  auto* sphere = new (memory) btSphereShape(1);
  EXPECT_EQ(cache.find_or_convert(*sphere)->polytope()->num_vertices(), 1);
  sphere->~btSphereShape();
  auto* capsule = new (memory) btCapsuleShape(1, 2);
  EXPECT_EQ(cache.find_or_convert(*capsule)->polytope()->num_vertices(), 2);
  capsule->~btCapsuleShape();
}

TEST(ShapeCache, BoundedLeastRecentlyUsedFirst) {
  pd::BulletShapeCache cache(3);
  std::vector<std::unique_ptr<btSphereShape>> spheres;
  for (int i = 0; i < 4; ++i) {
    spheres.push_back(std::make_unique<btSphereShape>(btScalar(i + 1)));
  }
  for (int i : {0, 1, 2, 0, 3}) {
    ASSERT_NE(cache.find_or_convert(*spheres[i]), nullptr);
    EXPECT_LE(cache.size(), 3u);
  }
  EXPECT_EQ(cache.conversions(), 4);
  ASSERT_NE(cache.find_or_convert(*spheres[0]), nullptr);
  EXPECT_EQ(cache.conversions(), 4);  // kept: used after 1 was
  ASSERT_NE(cache.find_or_convert(*spheres[1]), nullptr);
  EXPECT_EQ(cache.conversions(), 5);
}

/// The shapes of a world with more of them than the table is made for: pairs hold their entries and do not ask for them
/// in each step. Once the world is gone, others take their places, and the table shrinks.
TEST(ShapeCache, GrowsWithWhatIsInUse) {
  pd::BulletShapeCache cache(100);
  std::vector<std::unique_ptr<btSphereShape>> spheres;
  std::vector<std::shared_ptr<pd::detail::CachedShape>> held;
  for (int i = 0; i < 1000; ++i) {
    spheres.push_back(std::make_unique<btSphereShape>(btScalar(i + 1)));
    held.push_back(cache.find(*spheres.back(), 0));
  }
  EXPECT_EQ(cache.size(), spheres.size());
  for (std::size_t i = 0; i < held.size(); ++i) EXPECT_EQ(cache.find(*spheres[i], 0), held[i]);
  EXPECT_EQ(cache.conversions(), 1000);
  held.clear();
  std::vector<std::unique_ptr<btSphereShape>> others;
  for (int i = 0; i < 2000; ++i) {
    others.push_back(std::make_unique<btSphereShape>(btScalar(5000 + i)));
    ASSERT_NE(cache.find_or_convert(*others.back()), nullptr);
  }
  EXPECT_LE(cache.size(), cache.capacity());
}

TEST(ShapeCache, EqualShapesShareOneBody) {
  pd::BulletShapeCache cache(2);
  btBoxShape one(btVector3(1, 2, 3)), same(btVector3(1, 2, 3)), other(btVector3(1, 2, 4));
  const auto body = cache.find_or_convert(one);
  EXPECT_EQ(cache.find_or_convert(same), body);
  EXPECT_EQ(cache.conversions(), 1);
  EXPECT_EQ(cache.size(), 2u);
  // An edit of one leaves the other alone, and what was shared is found under neither address.
  same.setLocalScaling(btVector3(2, 1, 1));
  EXPECT_NE(cache.find_or_convert(same), body);
  EXPECT_EQ(cache.find_or_convert(one), body);
  EXPECT_EQ(cache.conversions(), 2);
  ASSERT_NE(cache.find_or_convert(other), nullptr);  // in place of `same`
  cache.forget(&one);
  EXPECT_EQ(cache.conversions(), 3);
  ASSERT_NE(cache.find_or_convert(one), nullptr);
  EXPECT_EQ(cache.conversions(), 4);
}

TEST(ShapeCache, ForgetAndClear) {
  pd::BulletShapeCache cache;
  btSphereShape a(1);
  btSphereShape b(2);
  ASSERT_NE(cache.find_or_convert(a), nullptr);
  ASSERT_NE(cache.find_or_convert(b), nullptr);
  cache.forget(&a);
  EXPECT_EQ(cache.size(), 1u);
  cache.clear();
  EXPECT_EQ(cache.size(), 0u);
}

TEST(ShapeCache, ShapesWithoutExactFormAreRememberedToo) {
  pd::BulletShapeCache cache;
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, 2};
  btMultiSphereShape unequal(centres, radii, 2);
  unequal.setLocalScaling(btVector3(1, 1, btScalar(1.5)));
  EXPECT_EQ(cache.find_or_convert(unequal), nullptr);
  EXPECT_EQ(cache.find_or_convert(unequal), nullptr);
  EXPECT_EQ(cache.conversions(), 1);
}

TEST(ShapeCache, TrianglesOnTheStackLeaveNoEntry) {
  pd::BulletShapeCache cache;
  const btTriangleShape triangle(btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(0, 1, 0));
  EXPECT_EQ(cache.find_or_convert(triangle)->polytope()->num_vertices(), 3);
  EXPECT_EQ(cache.size(), 0u);
}

TEST(ShapeCache, ManyThreadsOneBody) {
  pd::BulletShapeCache cache;
  std::vector<std::unique_ptr<btBoxShape>> boxes;
  for (int i = 0; i < 20; ++i) {
    boxes.push_back(std::make_unique<btBoxShape>(btVector3(btScalar(1 + i), 1, 1)));
  }
  std::vector<std::vector<const pd::ConvexShape*>> seen(4);
  std::vector<std::thread> threads;
  for (auto& mine : seen) {
    threads.emplace_back([&cache, &boxes, &mine] {
      for (int round = 0; round < 50; ++round) {
        mine.clear();
        for (const auto& box : boxes) {
          mine.push_back(cache.find_or_convert(*box).get());
        }
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const auto& mine : seen) {
    EXPECT_EQ(mine, seen[0]);
  }
  EXPECT_EQ(cache.size(), boxes.size());
}

}  // namespace
