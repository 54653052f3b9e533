// What slides over many pieces that are meant as one keeps its way: no contact with the edges and faces inside.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

struct Ground {
  std::string name;
  std::function<btCollisionShape*(UnionWorld&)> make;
  double top = 0;  ///< height of the surface: the margin, where it lies outside
};

struct Slide {
  double speed = 0;
  double aside = 0;
  double hop = 0;
  double sink = 0;
  double spin = 0;
};

/// A box of half a metre, 3 m/s along x, six seconds, without friction and restitution.
Slide slide(UnionWorld& world, const Ground& ground, btCollisionShape* shape, double half, double yaw, double x = -9,
            double z = .13) {
  world.fixed(ground.make(world));
  const btVector3 at{btScalar(x), btScalar(half + ground.top), btScalar(z)};
  btRigidBody* body =
      world.moving(shape, btTransform(btQuaternion(btVector3(0, 1, 0), btScalar(yaw)), at), btVector3(3, 0, 0));
  Slide result;
  for (int i = 0; i < 360; ++i) {
    world.step();
    const double rise = static_cast<double>(body->getWorldTransform().getOrigin().y() - at.y());
    result.hop = std::max(result.hop, rise);
    result.sink = std::max(result.sink, -rise);
    result.spin = std::max(result.spin, static_cast<double>(body->getAngularVelocity().length()));
  }
  result.speed = static_cast<double>(body->getLinearVelocity().x());
  result.aside = std::abs(static_cast<double>(body->getLinearVelocity().z()));
  return result;
}

Ground mesh_of_cells(const char* name, double cell, btScalar margin) {
  return {name,
          [=](UnionWorld& world) {
            std::vector<UnionWorld::Triangle> triangles;
            add_floor(triangles, -12, 12, -2, 2, static_cast<int>(24 / cell), static_cast<int>(4 / cell));
            return world.mesh(triangles, margin);
          },
          static_cast<double>(margin)};
}

std::vector<Ground> grounds() {
  const btScalar margin = CONVEX_DISTANCE_MARGIN;
  return {
      mesh_of_cells("mesh", 1, 0),
      mesh_of_cells("mesh_margin", 1, margin),
      mesh_of_cells("fine_mesh", 0.25, margin),
      {"slivers",
       [](UnionWorld& world) {
         std::vector<UnionWorld::Triangle> triangles;
         add_floor(triangles, -12, 12, -2, 2, 960, 1);
         return world.mesh(triangles, 0);
       }},
      {"two_huge_triangles",
       [](UnionWorld& world) {
         std::vector<UnionWorld::Triangle> triangles;
         add_floor(triangles, -2e3, 2e3, -2e3, 2e3, 1, 1);
         return world.mesh(triangles, 0);
       }},
      {"t_junctions", [](UnionWorld& world) { return world.mesh(floor_of_t_junctions(12, 2), CONVEX_DISTANCE_MARGIN); },
       margin},
      {"heightfield", [](UnionWorld& world) { return flat_heightfield(world, 25, 1, 0); }},
      {"heightfield_margin", [](UnionWorld& world) { return flat_heightfield(world, 49, btScalar(.5), btScalar(.04)); },
       margin},
      {"heightfield_diamonds", [](UnionWorld& world) { return flat_heightfield(world, 25, 1, 0, true); }},
      {"flush_boxes", [](UnionWorld& world) { return flush_boxes(world, 25, 1, 2); }},
      {"decomposition", [](UnionWorld& world) { return decomposed_slab(world, 25, 1, 2, 0); }},
      {"decomposition_margin",
       [](UnionWorld& world) { return decomposed_slab(world, 25, 1, 2, CONVEX_DISTANCE_MARGIN); }, margin},
  };
}

class GhostSlide : public ::testing::TestWithParam<Ground> {};

void PrintTo(const Ground& ground, std::ostream* out) { *out << ground.name; }

void expect_kept(const Slide& s) {
  EXPECT_TRUE(std::abs(s.speed - 3) < 0.005 && s.aside < 0.005 && s.hop < 1e-4 && s.sink < 1e-3 && s.spin < 0.05)
      << "speed " << s.speed << ", aside " << s.aside << ", hop " << s.hop << ", sink " << s.sink << ", spin "
      << s.spin;
}

TEST_P(GhostSlide, BoxKeepsItsSpeed) {
  for (const double yaw : {0.0, 0.3}) {
    SCOPED_TRACE(yaw);
    UnionWorld world;
    expect_kept(slide(world, GetParam(), world.bullet.shape<btBoxShape>(btVector3(.4F, .4F, .4F)), 0.4, yaw));
  }
}

TEST_P(GhostSlide, HullKeepsItsSpeed) {
  UnionWorld world;
  expect_kept(slide(world, GetParam(), box_hull(world.bullet, btVector3(.4F, .4F, .4F), 0), 0.4, 0));
}

TEST_P(GhostSlide, CompoundKeepsItsSpeed) {
  UnionWorld world;
  auto* halves = world.bullet.shape<btCompoundShape>();
  for (const btScalar x : {btScalar(-.2), btScalar(.2)}) {
    halves->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(x, 0, 0)),
                          world.bullet.shape<btBoxShape>(btVector3(.2F, .4F, .4F)));
  }
  expect_kept(slide(world, GetParam(), halves, 0.4, 0));
}

TEST_P(GhostSlide, FromAnyStart) {
  std::uint64_t state = 7;
  const auto next = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11U) * 0x1p-53;
  };
  for (int start = 0; start < 6; ++start) {
    SCOPED_TRACE(start);
    UnionWorld world;
    const btVector3 half(btScalar(.2 + .3 * next()), btScalar(.3), btScalar(.2 + .3 * next()));
    btConvexShape* shape = start % 2 == 0 ? static_cast<btConvexShape*>(world.bullet.shape<btBoxShape>(half))
                                          : box_hull(world.bullet, half, 0);
    const double yaw = start < 2 ? 0 : 3 * next();
    const double x = -9.5 + next();
    expect_kept(slide(world, GetParam(), shape, static_cast<double>(half.y()), yaw, x, 1.6 * next() - .8));
  }
}

INSTANTIATE_TEST_SUITE_P(All, GhostSlide, ::testing::ValuesIn(grounds()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace pd::test
