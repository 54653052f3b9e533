// A replay over meshes and compounds is the same bit for bit, whichever triangles and children the points lie on.
#include <gtest/gtest.h>

#include <functional>

#include "engine_glue/union_worlds.hpp"
#include "pd/bullet/snapshot.hpp"

namespace pd::test {
namespace {

void expect_replayed(const std::function<btCollisionShape*(UnionWorld&)>& ground) {
  UnionWorld world;
  world.fixed(ground(world));
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < 4; ++i) {
    bodies.push_back(world.moving(world.bullet.shape<btBoxShape>(btVector3(.3F, .3F, .3F)),
                                  btVector3(btScalar(i - 3), btScalar(.35 + .05 * i), btScalar(.1 * i)),
                                  btVector3(2, 0, btScalar(.2))));
    bodies.back()->setFriction(btScalar(.5));
  }
  world.step(20);
  const BulletSnapshot saved(world.bullet.world(), &world.solver);
  std::vector<btTransform> first;
  world.step(15);
  for (const btRigidBody* body : bodies) first.push_back(body->getWorldTransform());
  ASSERT_EQ(saved.restore(), Restored::yes);
  world.step(15);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_TRUE(bodies[i]->getWorldTransform() == first[i]) << i;
  }
}

TEST(UnionSnapshot, MeshesReplay) {
  expect_replayed([](UnionWorld& world) {
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -8, 8, -2, 2, 32, 8);
    return world.mesh(triangles, btScalar(.01));
  });
}

TEST(UnionSnapshot, CompoundsReplay) {
  expect_replayed([](UnionWorld& world) { return flush_boxes(world, 31, btScalar(.5), 2); });
}

}  // namespace
}  // namespace pd::test
