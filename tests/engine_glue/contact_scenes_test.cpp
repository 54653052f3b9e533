// The scenes of `pdepth-bench contact` start as they say: nothing inside anything, the same twice, different when
// asked.
#include <gtest/gtest.h>

#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

using scenes::BulletScene;
using scenes::ContactRun;

class Scene : public ::testing::TestWithParam<std::string> {};

TEST_P(Scene, StartsWithoutPenetration) {
  const scenes::ContactScene plan = scenes::contact_scene(GetParam());
  EXPECT_EQ(plan.name, GetParam());
  BulletScene scene(plan.world, ContactRun::pdepth);
  scene.world().performDiscreteCollisionDetection();
  double deepest = 0;
  for (int i = 0; i < scene.dispatcher().getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = scene.dispatcher().getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      deepest = std::max(deepest, -static_cast<double>(manifold->getContactPoint(k).getDistance()));
    }
  }
  if (GetParam() == "one-place") {
    EXPECT_GT(deepest, 0.9);
  } else {
    EXPECT_LT(deepest, 1e-5 * plan.size + 1e-5);
  }
}

TEST_P(Scene, PerturbationsAreSmallAndRepeat) {
  const scenes::ContactScene still = scenes::contact_scene(GetParam());
  const scenes::ContactScene moved = scenes::contact_scene(GetParam(), 3);
  const scenes::ContactScene again = scenes::contact_scene(GetParam(), 3);
  ASSERT_EQ(still.world.bodies.size(), moved.world.bodies.size());
  for (std::size_t i = 0; i < still.world.bodies.size(); ++i) {
    const double way = (still.world.bodies[i].position - moved.world.bodies[i].position).norm();
    EXPECT_LE(way, 2e-6 * still.size);
    EXPECT_EQ(way > 0, still.world.bodies[i].mass > 0);
    EXPECT_EQ(moved.world.bodies[i].position, again.world.bodies[i].position);
  }
}

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const auto& maker : scenes::contact_scenes()) {
    result.push_back(maker.name);
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(All, Scene, ::testing::ValuesIn(names()), [](const auto& each) {
  std::string name = each.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace pd::test
