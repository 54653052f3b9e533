// Bodies that are metres deep in large meshes: what is looked at grows with the triangles, and not with their square.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine_glue/union_worlds.hpp"
#include "shapes/triangles_around.hpp"

namespace pd::test {
namespace {

constexpr int kSide = 50;  ///< cells of a ground
constexpr btScalar kCell = btScalar(0.2);

/// Hands each triangle on and counts it.
class Counted : public btTriangleCallback {
 public:
  Counted(btTriangleCallback& callback, std::int64_t& count) : callback_(callback), count_(count) {}
  void processTriangle(btVector3* corners, int part, int index) override {
    ++count_;
    callback_.processTriangle(corners, part, index);
  }

 private:
  btTriangleCallback& callback_;
  std::int64_t& count_;
};

/// A ground that counts the triangles that anyone reads from it.
template <class Shape>
class CountedGround : public Shape {
 public:
  using Shape::Shape;
  void processAllTriangles(btTriangleCallback* callback, const btVector3& lower,
                           const btVector3& upper) const override {
    Counted counted(*callback, count);
    Shape::processAllTriangles(&counted, lower, upper);
  }
  mutable std::int64_t count = 0;
};

using CountedMesh = CountedGround<btBvhTriangleMeshShape>;
using CountedHeights = CountedGround<btHeightfieldTerrainShape>;

/// Slopes of up to 40 degrees; the ground lies between 0 and 0.16.
btScalar height(int i, int j) { return btScalar(0.04) * static_cast<btScalar>((7 * i + 13 * j) % 5); }

btVector3 corner(int i, int j) {
  return {kCell * static_cast<btScalar>(i - kSide / 2), height(i, j), kCell * static_cast<btScalar>(j - kSide / 2)};
}

class DeepInLargeMesh : public testing::Test {
 protected:
  CountedMesh* bumpy_mesh() {
    world_.meshes.push_back(std::make_unique<btTriangleMesh>());
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        world_.meshes.back()->addTriangle(corner(i, j), corner(i, j + 1), corner(i + 1, j + 1));
        world_.meshes.back()->addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i + 1, j));
      }
    }
    return world_.bullet.shape<CountedMesh>(world_.meshes.back().get(), true);
  }
  CountedHeights* bumpy_heights() {
    constexpr int kCorners = kSide + 1;
    world_.heights.push_back(std::make_unique<std::vector<btScalar>>());
    for (int j = 0; j < kCorners; ++j) {
      for (int i = 0; i < kCorners; ++i) world_.heights.back()->push_back(height(i, j));
    }
    auto* heights = world_.bullet.shape<CountedHeights>(kCorners, kCorners, world_.heights.back()->data(), btScalar(0),
                                                        btScalar(0.16), 1, false);
    heights->setLocalScaling(btVector3(kCell, 1, kCell));
    return heights;
  }
  btCollisionShape* hull() {
    auto* made = world_.bullet.shape<btConvexHullShape>();
    for (int i = 0; i < 60; ++i) {
      const double up = 1 - (2 * i + 1) / 60.0, out = std::sqrt(1 - up * up), turn = 2.4 * i;
      made->addPoint(
          btVector3(btScalar(4 * out * std::cos(turn)), btScalar(4 * up), btScalar(4 * out * std::sin(turn))));
    }
    return made;
  }
  btCollisionShape* eight_boxes() {
    auto* compound = world_.bullet.shape<btCompoundShape>();
    for (int i = 0; i < 8; ++i) {
      const auto side = [i](int bit) { return btScalar((i & bit) != 0 ? 2 : -2); };
      compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(side(1), side(2), side(4))),
                              world_.bullet.shape<btBoxShape>(btVector3(2, 2, 2)));
    }
    return compound;
  }

  /// Steps with a body whose middle lies in the ground, and expects contacts. Each triangle may be read so many times.
  template <class Ground>
  void expect_few_reads(Ground* ground, btCollisionShape* body, int times) {
    world_.fixed(ground);
    world_.moving(body, btVector3(0, btScalar(0.6), 0), btVector3(0, 0, 0));
    int first_contacts = 0;
    for (int step = 0; step < 3; ++step) {
      ground->count = 0;
      world_.step();
      EXPECT_LE(ground->count, std::int64_t{times} * 2 * kSide * kSide) << "step " << step;
      if (step == 0) first_contacts = world_.bullet.num_contacts();
    }
    EXPECT_GT(first_contacts, 0);
  }

  UnionWorld world_;
};

TEST_F(DeepInLargeMesh, BallReadsEachTriangleFewTimes) {
  expect_few_reads(bumpy_mesh(), world_.bullet.shape<btSphereShape>(btScalar(4)), 40);
}

TEST_F(DeepInLargeMesh, BallReadsEachTriangleOfAHeightfieldFewTimes) {
  expect_few_reads(bumpy_heights(), world_.bullet.shape<btSphereShape>(btScalar(4)), 40);
}

TEST_F(DeepInLargeMesh, HullReadsEachTriangleFewTimes) { expect_few_reads(bumpy_mesh(), hull(), 40); }

TEST_F(DeepInLargeMesh, CompoundReadsEachTriangleFewTimes) { expect_few_reads(bumpy_mesh(), eight_boxes(), 160); }

TEST_F(DeepInLargeMesh, BallReadsEachTriangleInACompoundFewTimes) {
  auto* compound = world_.bullet.shape<btCompoundShape>();
  CountedMesh* mesh = bumpy_mesh();
  compound->addChildShape(btTransform::getIdentity(), mesh);
  world_.fixed(compound);
  world_.moving(world_.bullet.shape<btSphereShape>(btScalar(4)), btVector3(0, btScalar(0.6), 0), btVector3(0, 0, 0));
  mesh->count = 0;
  world_.step();
  EXPECT_LE(mesh->count, std::int64_t{40} * 2 * kSide * kSide);
  EXPECT_GT(world_.bullet.num_contacts(), 0);
}

// Ways of bodies that come through a mesh are looked up so.
TEST_F(DeepInLargeMesh, KnownTrianglesInABoxAreThoseThatMeetIt) {
  CountedMesh* const mesh = bumpy_mesh();
  detail::TrianglesAround around;
  around.read(*mesh, btVector3(-3, -1, -4), btVector3(4, 1, 4));
  ASSERT_GT(around.triangles().size(), 2000U);
  mesh->count = 0;
  std::int64_t visited = 0;
  for (int i = 0; i < 200; ++i) {
    const btVector3 lower(btScalar(0.05) * static_cast<btScalar>(i % 90 - 45), 0,
                          btScalar(0.07) * static_cast<btScalar>(i % 63 - 31));
    const btVector3 upper = lower + btVector3(btScalar(0.3), btScalar(0.05), btScalar(0.1));
    std::vector<std::size_t> found, meeting;
    around.for_each_in(lower, upper, [&](std::size_t place) { found.push_back(place); });
    for (std::size_t k = 0; k < around.triangles().size(); ++k) {
      const detail::MeshTriangle& triangle = around.triangles()[k];
      if (detail::boxes_meet(triangle.lower, triangle.upper, lower, upper)) meeting.push_back(k);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, meeting) << i;
    visited += static_cast<std::int64_t>(found.size());
  }
  EXPECT_GT(visited, 400);
  EXPECT_LT(mesh->count, 2 * visited + 200);
}

}  // namespace
}  // namespace pd::test
