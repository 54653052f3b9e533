// What is a step, a wall or an edge of a union stays one: ramps are climbed, kerbs stop, valleys and corners hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

using Triangles = std::vector<UnionWorld::Triangle>;

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

btBoxShape* box(UnionWorld& world, double x, double y, double z) { return world.bullet.shape<btBoxShape>(at(x, y, z)); }

double y_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().y()); }
double x_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().x()); }

/// A strip across z that follows a profile of points (x, y), left to right, facing up.
Triangles strip(const std::vector<std::pair<double, double>>& profile, int across) {
  Triangles triangles;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    for (int k = 0; k < across; ++k) {
      const double z0 = -2 + 4.0 * k / across;
      const double z1 = -2 + 4.0 * (k + 1) / across;
      const auto [x0, y0] = profile[i];
      const auto [x1, y1] = profile[i + 1];
      add_rectangle(triangles, at(x0, y0, z0), at(x0, y0, z1), at(x1, y1, z1), at(x1, y1, z0));
    }
  }
  return triangles;
}

TEST(UnionCorners, ARampIsClimbed) {
  for (const bool sphere : {false, true}) {
    UnionWorld world;
    world.fixed(world.mesh(strip({{-8, 0}, {-4, 0}, {0, 0}, {2, 0.73}, {6, 2.19}}, 3), 0));
    btConvexShape* shape =
        sphere ? static_cast<btConvexShape*>(world.bullet.shape<btSphereShape>(btScalar(.4))) : box(world, .4, .4, .4);
    const btRigidBody* body = world.moving(shape, at(-3, .4, .1), at(3, 0, 0));
    double highest = 0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      highest = std::max(highest, y_of(*body) - 0.4);
    }
    // v^2 / 2g is .459; the part of the speed into the ramp (6 % of the energy at 20 degrees) is lost at its foot.
    EXPECT_GT(highest, 0.33) << sphere;
    EXPECT_LT(highest, 0.52) << sphere;
  }
}

TEST(UnionCorners, AKerbStops) {
  for (const double height : {0.05, 0.1, 0.3}) {
    for (const bool compound : {false, true}) {
      SCOPED_TRACE(testing::Message() << height << (compound ? " compound" : " mesh"));
      UnionWorld world;
      if (compound) {
        btCompoundShape* ground = flush_boxes(world, 13, 1, 2);
        ground->addChildShape(btTransform(btQuaternion::getIdentity(), at(3, height - .5, 0)), box(world, 2, .5, 2));
        world.fixed(ground);
      } else {
        world.fixed(world.mesh(strip({{-8, 0}, {-3, 0}, {0, 0}, {1, 0}, {1, height}, {4, height}, {8, height}}, 2), 0));
      }
      btRigidBody* body = world.moving(box(world, .4, .4, .4), at(-2, .4, .1), at(3, 0, 0));
      // It would trip, as it should; here it is to stop.
      body->setAngularFactor(btScalar(0));
      double highest = 0;
      for (int i = 0; i < 180; ++i) {
        world.step();
        highest = std::max(highest, y_of(*body) - 0.4);
      }
      EXPECT_LT(x_of(*body), 0.62);
      EXPECT_GT(x_of(*body), 0.4);
      EXPECT_LT(static_cast<double>(body->getLinearVelocity().length()), 0.05);
      EXPECT_LT(highest, 0.05);
    }
  }
}

TEST(UnionCorners, NothingFallsThroughAValley) {
  // Walls of 30, 45 and 70 degrees, meeting in the line x = y = 0.
  for (const double degrees : {30.0, 45.0, 70.0}) {
    const double rise = std::tan(degrees * M_PI / 180);
    for (int kind = 0; kind < 6; ++kind) {
      SCOPED_TRACE(testing::Message() << degrees << " degrees, " << kind);
      UnionWorld world;
      if (kind < 3) {
        world.fixed(
            world.mesh(strip({{-3, 3 * rise}, {-.3, .3 * rise}, {0, 0}, {.5, .5 * rise}, {3, 3 * rise}}, 3), 0));
      } else {
        // Two slabs, .1 thick, that cross at the bottom.
        auto* slabs = world.bullet.shape<btCompoundShape>();
        for (const double side : {-1.0, 1.0}) {
          const btQuaternion turn(btVector3(0, 0, 1), btScalar(side * degrees * M_PI / 180));
          const btVector3 middle = quatRotate(turn, at(side * 1.9, -.05, 0));
          slabs->addChildShape(btTransform(turn, middle), box(world, 2, .05, 2));
        }
        world.fixed(slabs);
      }
      btConvexShape* shape = kind % 3 == 0
                                 ? static_cast<btConvexShape*>(world.bullet.shape<btSphereShape>(btScalar(.3)))
                             : kind % 3 == 1 ? box_hull(world.bullet, at(.3, .3, .3), 0)
                                             : box_hull(world.bullet, at(.05, .4, .3), 0);
      const btQuaternion turn(btVector3(0, 0, 1), btScalar(kind % 3 == 1 ? 0.7 : 0.05));
      const btRigidBody* body = world.moving(shape, btTransform(turn, at(.02, 1.2, .1)), at(0, -2, 0));
      double lowest = 1;
      for (int i = 0; i < 240; ++i) {
        world.step();
        lowest = std::min(lowest, y_of(*body));
      }
      // No centre of these bodies comes nearer to the bottom than the least half extent, less a centimetre.
      EXPECT_GT(lowest, 0.05 - 0.01);
      EXPECT_LT(std::abs(x_of(*body)), 3);
    }
  }
}

TEST(UnionCorners, ARoomKeepsWhatIsThrownIntoItsCorners) {
  UnionWorld world;
  Triangles room;
  const double w = 2;
  const auto corner = [&](int i) { return at((i & 1) ? w : -w, (i & 2) ? w : -w, (i & 4) ? w : -w); };
  const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& f : faces) add_rectangle(room, corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]));
  world.fixed(world.mesh(room, btScalar(.02)));
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < 8; ++i) {
    btConvexShape* shape = i % 2 == 0 ? static_cast<btConvexShape*>(box(world, .25, .25, .25))
                                      : world.bullet.shape<btSphereShape>(btScalar(.25));
    bodies.push_back(world.moving(shape, corner(i) * btScalar(.4), corner(i) * btScalar(2)));
  }
  for (int i = 0; i < 300; ++i) {
    world.step();
    for (const btRigidBody* body : bodies) {
      const btVector3& centre = body->getWorldTransform().getOrigin();
      ASSERT_LT(centre.absolute()[centre.absolute().maxAxis()], btScalar(w - .15)) << i;
    }
  }
}

TEST(UnionCorners, EdgesAndTipsCarry) {
  for (const bool tip : {false, true}) {
    UnionWorld world;
    Triangles roof;
    if (tip) {
      for (int i = 0; i < 5; ++i) {
        const double a = 2 * M_PI * i / 5;
        const double b = 2 * M_PI * (i + 1) / 5;
        roof.push_back({at(0, 0, 0), at(std::cos(b), -.5, std::sin(b)), at(std::cos(a), -.5, std::sin(a))});
      }
    } else {
      roof = strip({{-1, -.5}, {0, 0}, {1, -.5}}, 2);
    }
    world.fixed(world.mesh(roof, 0));
    btRigidBody* body = world.moving(box(world, .3, .3, .3), at(0, .305, 0), at(0, 0, 0));
    body->setLinearFactor(at(0, 1, 0));
    body->setAngularFactor(btScalar(0));
    world.step(120);
    EXPECT_NEAR(y_of(*body), .3, 5e-3) << tip;
  }
}

// The pieces of a body that leans a little go on against the floor's normal, each below the one before: its contacts
// with the floor are right all the same.
TEST(UnionCorners, ALeaningPlankMeetsTheFloorAllAlong) {
  for (const double lean : {1e-4, 1e-3, 5e-3}) {
    UnionWorld world;
    world.fixed(box(world, 200, .5, 200), at(0, -.5, 0));
    const btTransform pose(btQuaternion(at(0, 0, 1), btScalar(lean)), at(0, .999 + 1.5 * lean, 0));
    world.moving(flush_boxes(world, 3, 1, .5), pose, at(0, 0, 0));
    world.bullet.world().performDiscreteCollisionDetection();
    double least = 1;
    double most = -1;
    btDispatcher& dispatcher = *world.bullet.world().getDispatcher();
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
      for (int i = 0; i < manifold.getNumContacts(); ++i) {
        const double x = static_cast<double>(manifold.getContactPoint(i).getPositionWorldOnA().x());
        least = std::min(least, x);
        most = std::max(most, x);
      }
    }
    EXPECT_LT(least, -1.48) << lean;
    EXPECT_GT(most, 1.48) << lean;
  }
}

/// The end of a ring lies between its two sides, which cover all corners of its inner face and nothing else of it. What
/// comes so fast that all of the face is within its reach is stopped by it all the same.
TEST(UnionCorners, ABarBetweenTwoOthersStopsWhatIsFast) {
  for (const double speed : {1.0, 2.0, 4.0, 6.0, 8.0}) {
    UnionWorld world;
    world.bullet.world().setGravity(at(0, 0, 0));
    auto* ring = world.bullet.shape<btCompoundShape>();
    const auto add = [&](btCollisionShape* bar, double x, double z) {
      ring->addChildShape(btTransform(btQuaternion::getIdentity(), at(x, 0, z)), bar);
    };
    for (const double side : {-1.0, 1.0}) {
      add(box(world, .3, .1, .035), 0, .125 * side);
      add(box(world, .035, .1, .09), .265 * side, 0);
    }
    world.fixed(ring);
    const btRigidBody* body = world.moving(box(world, .05, .05, .05), at(.1, .01, .02), at(speed, 0, 0));
    double farthest = 0, lifted = 0;
    for (int i = 0; i < 30; ++i) {
      world.step();
      farthest = std::max(farthest, x_of(*body));
      lifted = std::max(lifted, std::abs(y_of(*body) - .01));
    }
    // Half a step's way may be inside when it is seen first.
    EXPECT_LT(farthest, .18 + speed / 60) << speed;
    EXPECT_LT(lifted, 1e-3) << speed;
    EXPECT_LT(std::abs(static_cast<double>(body->getLinearVelocity().x())), 1.0) << speed;
  }
}

TEST(UnionCorners, ACrestIsLeftAtFullSpeed) {
  UnionWorld world;
  world.fixed(world.mesh(strip({{-6, 0}, {-2, 0}, {0, 0}, {2, -1}, {8, -4}}, 3), 0));
  const btRigidBody* body = world.moving(box(world, .4, .4, .4), at(-4, .4, .1), at(3, 0, 0));
  double slowest = 3;
  for (int i = 0; i < 90; ++i) {
    world.step();
    if (x_of(*body) < 0.3) slowest = std::min(slowest, static_cast<double>(body->getLinearVelocity().x()));
  }
  EXPECT_GT(slowest, 2.9);
  EXPECT_GT(x_of(*body), 0.3);
}

}  // namespace
}  // namespace pd::test
