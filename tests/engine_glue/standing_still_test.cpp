// A body that has hardly moved on a mesh is asked about the triangles that made its points, and no others.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// Of the distance up to which there are contacts: who has moved by less stands still.
constexpr double kHardly = 1.0 / 32;

/// A box or a compound on a rise of small triangles. Nothing moves but by hand: contacts are found without steps.
class OnARise {
 public:
  explicit OnARise(bool compound = false) {
    constexpr int kCells = 40;
    vertices_.resize((kCells + 1) * (kCells + 1));
    for (int i = 0; i <= kCells; ++i) {
      for (int k = 0; k <= kCells; ++k) {
        const double x = .1 * i - 2, z = .1 * k - 2;
        vertices_[static_cast<std::size_t>(number(i, k))] = vector(x, -.05 * (x * x + z * z), z);
        if (i == kCells || k == kCells) continue;
        indices_.insert(indices_.end(), {number(i, k), number(i, k + 1), number(i + 1, k + 1)});
        indices_.insert(indices_.end(), {number(i, k), number(i + 1, k + 1), number(i + 1, k)});
      }
    }
    triangles_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(indices_.size() / 3), indices_.data(), 3 * static_cast<int>(sizeof(int)),
        static_cast<int>(vertices_.size()), &vertices_[0][0], static_cast<int>(sizeof(btVector3)));
    mesh_ = world_.bullet.shape<btBvhTriangleMeshShape>(triangles_.get(), true);
    mesh_->setMargin(0);
    world_.fixed(mesh_);
    btCollisionShape* shape = world_.bullet.shape<btBoxShape>(vector(.5, .1, .5));
    if (compound) {
      compound_ = world_.bullet.shape<btCompoundShape>();
      compound_->addChildShape(btTransform(btQuaternion::getIdentity(), vector(-.5, 0, 0)),
                               static_cast<btBoxShape*>(shape));
      compound_->addChildShape(btTransform(btQuaternion::getIdentity(), vector(.5, 0, 0)),
                               static_cast<btBoxShape*>(shape));
      shape = compound_;
    }
    body_ = world_.moving(shape, pose_at(0, 0), vector(0, 0, 0));
  }

  /// Half a millimetre in the rise, turned a little, and so far from there.
  static btTransform pose_at(double aside, double down) {
    return btTransform(btQuaternion(vector(.3, 1, .2).normalized(), btScalar(.1)),
                       vector(.03 + aside, .118 - down, .02));
  }
  void place(double aside, double down) { body_->setWorldTransform(pose_at(aside, down)); }

  /// Finds the contacts. @return the queries that took
  std::int64_t find() {
    world_.solver.reset_statistics();
    world_.bullet.world().performDiscreteCollisionDetection();
    return world_.solver.statistics().calls;
  }
  double least_distance() { return world_.bullet.least_distance(); }
  int num_contacts() { return world_.bullet.num_contacts(); }
  void raise(int i, int k, double by) {
    vertices_[static_cast<std::size_t>(number(i, k))] += vector(0, by, 0);
    mesh_->refitTree(vector(-9, -9, -9), vector(9, 9, 9));
  }
  void shift_child(double by) {
    compound_->updateChildTransform(0, btTransform(btQuaternion::getIdentity(), vector(-.5, by, 0)));
  }

 private:
  static int number(int i, int k) { return 41 * i + k; }

  std::vector<btVector3> vertices_;
  std::vector<int> indices_;
  std::unique_ptr<btTriangleIndexVertexArray> triangles_;
  UnionWorld world_;
  btBvhTriangleMeshShape* mesh_ = nullptr;
  btCompoundShape* compound_ = nullptr;
  btRigidBody* body_ = nullptr;
};

/// Bullet takes a fiftieth of the radius of a body smaller than 1 m round.
double threshold() { return .7 * static_cast<double>(gContactBreakingThreshold); }

TEST(StandingStill, AsksWhatMadePoints) {
  OnARise scene;
  const std::int64_t all = scene.find();
  EXPECT_GT(all, 20);
  const double distance = scene.least_distance();
  const int contacts = scene.num_contacts();
  EXPECT_GE(contacts, 4);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(scene.find(), contacts);
    EXPECT_NEAR(scene.least_distance(), distance, 1e-12);
    EXPECT_EQ(scene.num_contacts(), contacts);
  }
}

TEST(StandingStill, DepthsAreThoseOfTheStep) {
  // Straight down the same triangle stays the deepest, and nothing of its depth is late.
  const double step = .2 * kHardly * threshold();
  OnARise scene;
  scene.find();
  for (int i = 1; i <= 4; ++i) {
    OnARise anew;
    scene.place(0, i * step);
    anew.place(0, i * step);
    EXPECT_LT(scene.find(), anew.find());
    EXPECT_NEAR(scene.least_distance(), anew.least_distance(), 1e-12) << i;
  }
}

TEST(StandingStill, WhoeverMovesIsAskedAboutAll) {
  OnARise scene, anew;
  const std::int64_t all = scene.find();
  const double step = .7 * kHardly * threshold();
  scene.place(step, 0);
  EXPECT_LT(scene.find(), all / 2);
  scene.place(2 * step, 0);  // small steps add up
  anew.place(2 * step, 0);
  EXPECT_EQ(scene.find(), anew.find());
  EXPECT_NEAR(scene.least_distance(), anew.least_distance(), 1e-12);
}

TEST(StandingStill, AnEditedTriangleIsSeen) {
  for (const bool compound : {false, true}) {
    OnARise scene(compound), anew(compound);
    const std::int64_t all = scene.find();
    EXPECT_LT(scene.find(), all / 2);
    // One vertex under the body, aside of its points, and those of six triangles change.
    for (OnARise* each : {&scene, &anew}) each->raise(17, 23, .03);
    scene.find();
    anew.find();
    EXPECT_LT(anew.least_distance(), -.01);
    EXPECT_NEAR(scene.least_distance(), anew.least_distance(), 1e-12);
  }
}

TEST(StandingStill, AnEditedCompoundIsSeen) {
  OnARise scene(true), anew(true);
  const std::int64_t all = scene.find();
  EXPECT_LT(scene.find(), all / 2);
  for (OnARise* each : {&scene, &anew}) each->shift_child(-.01);
  EXPECT_EQ(scene.find(), anew.find());
  EXPECT_NEAR(scene.least_distance(), anew.least_distance(), 1e-12);
}

}  // namespace
}  // namespace pd::test
