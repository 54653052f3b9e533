// A beam that is let into a notch of its own width is seated in it, and is not stopped by the edges that it passes.
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

enum class Notch { of_bodies, of_a_compound };

constexpr double kBeam = 0.04;  // wide and high
constexpr double kWall = 0.02;  // high

struct Seat {
  double off;   ///< how far the beam ends from its seat
  double tilt;  ///< in radians
};

/// @param lift  of the beam above its seat: kWall puts its lower edges on those of the walls
Seat let_in(Notch notch, double width, double lift, const btQuaternion& turn) {
  BulletPenetrationDepthSolver solver;
  BulletWorld world;
  install(world.world(), solver);
  const btTransform frame(turn, at(0, 0, 0));
  world.world().setGravity(quatRotate(turn, at(0, -9.81, 0)));
  struct Part {
    btVector3 half;
    btVector3 place;
  };
  const std::array<Part, 3> parts{Part{at(0.2, 0.1, 0.05), at(0, -0.1, 0)},
                                  Part{at(0.05, kWall / 2, 0.05), at(-width / 2 - 0.05, kWall / 2, 0)},
                                  Part{at(0.05, kWall / 2, 0.05), at(width / 2 + 0.05, kWall / 2, 0)}};
  auto* whole = world.shape<btCompoundShape>();
  for (const Part& part : parts) {
    auto* box = world.shape<btBoxShape>(part.half);
    const btTransform place(btQuaternion::getIdentity(), part.place);
    if (notch == Notch::of_bodies) world.body(box, 0, frame * place);
    whole->addChildShape(place, box);
  }
  if (notch == Notch::of_a_compound) world.body(whole, 0, frame);
  const btRigidBody& beam = *world.body(world.shape<btBoxShape>(at(kBeam / 2, kBeam / 2, 0.25)), 1,
                                        frame * btTransform(btQuaternion::getIdentity(), at(0, kBeam / 2 + lift, 0)));
  for (int step = 0; step < 90; ++step) world.world().stepSimulation(btScalar(1) / 60, 0);
  const btTransform end = frame.inverse() * beam.getWorldTransform();
  return {static_cast<double>((end.getOrigin() - at(0, kBeam / 2, 0)).length()),
          static_cast<double>((end.getBasis().getColumn(1) - at(0, 1, 0)).length())};
}

std::vector<double> widths() {
  std::vector<double> result{kBeam + 1e-7, kBeam + 1e-6, kBeam + 1e-5};
  auto ulps = static_cast<float>(kBeam);
  for (int i = 0; i < 3; ++i) {
    result.push_back(static_cast<double>(ulps));
    ulps = std::nextafter(ulps, 1.0F);
  }
  return result;
}

TEST(Notch, ABeamOfItsWidthIsSeated) {
  const std::array<btQuaternion, 3> turns{btQuaternion::getIdentity(),
                                          btQuaternion(at(1, 2, 3).normalized(), btScalar(0.7)),
                                          btQuaternion(at(-2, 1, 0.5).normalized(), btScalar(2.1))};
  for (const Notch notch : {Notch::of_bodies, Notch::of_a_compound}) {
    for (const double width : widths()) {
      for (const double lift : {0.0, kWall, kWall + 1e-3, kWall + 1e-2}) {
        for (const btQuaternion& turn : turns) {
          const Seat seat = let_in(notch, width, lift, turn);
          EXPECT_LT(seat.off, 5e-4) << static_cast<int>(notch) << ' ' << width - kBeam << ' ' << lift;
          EXPECT_LT(seat.tilt, 1e-3) << static_cast<int>(notch) << ' ' << width - kBeam << ' ' << lift;
        }
      }
    }
  }
}

/// The beam is through the notch's floor by most of its height in one step. The floor beside it is covered by the walls
/// as far as it moves, but not the floor under it.
TEST(Notch, ABeamThatComesFastDoesNotFallThroughTheFloor) {
  constexpr double kHalf = 0.006;
  BulletPenetrationDepthSolver solver;
  BulletWorld world;
  install(world.world(), solver);
  world.world().setGravity(at(0, -9.81, 0));
  auto* const notch = world.shape<btCompoundShape>();
  auto* const wall = world.shape<btBoxShape>(at(0.015, 0.015, 0.06));
  const auto add = [&](btBoxShape* box, double x, double y) {
    notch->addChildShape(btTransform(btQuaternion::getIdentity(), at(x, y, 0)), box);
  };
  add(wall, -kHalf - 0.015, 0.015);
  add(wall, kHalf + 0.015, 0.015);
  add(world.shape<btBoxShape>(at(0.06, 0.015, 0.06)), 0, -0.015);
  world.body(notch, 0, at(0, 0, 0));
  const btRigidBody& beam = *world.body(world.shape<btBoxShape>(at(kHalf, kHalf, 0.045)), 1, at(0, 0.0375, 0));
  for (int step = 0; step < 120; ++step) world.world().stepSimulation(btScalar(1) / 60, 0);
  EXPECT_NEAR(static_cast<double>(beam.getWorldTransform().getOrigin().y()), kHalf, 2e-4);
}

}  // namespace
}  // namespace pd::test
