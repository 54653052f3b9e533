// What a pair costs beside its answer: shapes are compared once a step, triangles are converted once, buffers are
// shared and counted.
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <thread>

#include "pair/thread_buffers.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "shapes/cached_shape.hpp"

namespace pd::test {
namespace {

btConvexHullShape tetrahedron() {
  btConvexHullShape hull;
  for (const btVector3& point : {btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(0, 1, 0), btVector3(0, 0, 1)}) {
    hull.addPoint(point);
  }
  return hull;
}

TEST(Lookup, PointsAreComparedOncePerStamp) {
  BulletShapeCache cache;
  btConvexHullShape hull = tetrahedron();
  const auto first = cache.find(hull, 7);
  hull.getUnscaledPoints()[1].setX(2);  // in place
  EXPECT_EQ(cache.find(hull, 7), first);
  const auto next = cache.find(hull, 8);
  EXPECT_NE(next, first);
  EXPECT_DOUBLE_EQ(next->body->polytope()->max_abs_coordinate(), 2);
  // Without a stamp, every time.
  hull.getUnscaledPoints()[1].setX(3);
  EXPECT_DOUBLE_EQ(cache.find(hull, 0)->body->polytope()->max_abs_coordinate(), 3);
}

TEST(Lookup, WhatCostsNoTimeIsComparedAlways) {
  BulletShapeCache cache;
  btConvexHullShape hull = tetrahedron();
  const auto first = cache.find(hull, 7);
  hull.setLocalScaling(btVector3(2, 2, 2));
  const auto scaled = cache.find(hull, 7);
  EXPECT_NE(scaled, first);
  hull.setMargin(btScalar(0.01));
  const auto thin = cache.find(hull, 7);
  EXPECT_NE(thin, scaled);
  hull.addPoint(btVector3(2, 2, 2));
  EXPECT_NE(cache.find(hull, 7), thin);
  btBoxShape box(btVector3(1, 1, 1));
  const auto sharp = cache.find(box, 7);
  ASSERT_NE(sharp->sharp, nullptr);
  EXPECT_EQ(sharp->sharp->margin(), 0);
  EXPECT_DOUBLE_EQ(sharp->sharp->polytope()->max_abs_coordinate(), 1);
  box.setLocalScaling(btVector3(3, 1, 1));
  EXPECT_NEAR(cache.find(box, 7)->sharp->polytope()->max_abs_coordinate(), 3, 1e-5);
}

TEST(Lookup, TrianglesAreConvertedOnceAndTheTableIsBounded) {
  BulletShapeCache cache;
  detail::TriangleCache triangles;
  const auto convert = [&](const btTriangleShape& triangle) { return cache.find(triangle, 0); };
  const auto triangle = [](int i) {
    return btTriangleShape(btVector3(btScalar(i), 0, 0), btVector3(btScalar(i + 1), 0, 0),
                           btVector3(btScalar(i), 1, 0));
  };
  const auto find = [&](const btTriangleShape& shape) {
    std::shared_ptr<detail::CachedShape> known;
    triangles.find(shape, known, convert);
    return known;
  };
  const auto first = find(triangle(0));
  EXPECT_EQ(find(triangle(0)), first);
  EXPECT_EQ(triangles.conversions(), 1);
  const int many = 4 * static_cast<int>(detail::TriangleCache::kSlots);
  for (int i = 0; i < many; ++i) {
    const auto found = find(triangle(i));
    ASSERT_DOUBLE_EQ(found->body->polytope()->max_abs_coordinate(), std::max(1, i + 1));
  }
  // A later one took most places: those come back when they are asked for again.
  const auto again = find(triangle(0));
  EXPECT_NE(again, first);
  EXPECT_DOUBLE_EQ(again->body->polytope()->max_abs_coordinate(), 1);
  // What a pair holds stays, whatever the table of the thread that asks has.
  auto held = first;
  triangles.find(triangle(0), held, convert);
  EXPECT_EQ(held, first);
  triangles.find(triangle(1), held, convert);
  EXPECT_DOUBLE_EQ(held->body->polytope()->max_abs_coordinate(), 2);
  btTriangleShape wide = triangle(0);
  wide.setMargin(btScalar(0.2));
  EXPECT_NEAR(find(wide)->body->margin(), 0.2, 1e-6);
}

TEST(Lookup, BuffersAreAsManyAsThreadsAtOnce) {
  detail::ThreadBufferPool pool;
  for (int i = 0; i < 100; ++i) {
    auto one = pool.lease();
    one->counters.calls.add();
  }
  int buffers = 0;
  std::int64_t calls = 0;
  pool.for_each([&](detail::ThreadBuffers& each) {
    ++buffers;
    calls += each.counters.calls.read();
  });
  EXPECT_EQ(buffers, 1);
  EXPECT_EQ(calls, 100);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10000; ++i) {
        auto mine = pool.lease();
        mine->counters.calls.add();
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  buffers = 0;
  calls = 0;
  pool.for_each([&](detail::ThreadBuffers& each) {
    ++buffers;
    calls += each.counters.calls.read();
  });
  EXPECT_LE(buffers, 4);
  EXPECT_EQ(calls, 40100);
}

}  // namespace
}  // namespace pd::test
