// Impacts with friction whose restitution would add energy.
#include <gtest/gtest.h>

#include <cmath>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::test {
namespace {

const btScalar kStep = btScalar(1.0 / 60);

/// A rod of restitution 1 that leans by 45 degrees and comes down tip first: the floor's impulse turns the tip's slip
/// round, so that friction pushes the way in which the tip came.
class ImpactEnergy : public ::testing::Test {
 protected:
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  btRigidBody* rod = nullptr;

  void throw_rod(double height) {
    install(scene.world(), solver);
    scene.world().setGravity(btVector3(0, 0, 0));
    auto* floor = scene.shape<btBoxShape>(btVector3(5, 1, 5));
    floor->setMargin(0);
    btRigidBody* ground = scene.body(floor, 0, btVector3(0, -1, 0));
    ground->setRestitution(1);
    ground->setFriction(1);
    auto* shape = scene.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.02), btScalar(0.02)));
    shape->setMargin(0);
    const double centre = 0.52 * std::sqrt(0.5) + height;
    rod = scene.body(shape, 1,
                     btTransform(btQuaternion(btVector3(0, 0, 1), -SIMD_HALF_PI / 2),
                                 btVector3(0, static_cast<btScalar>(centre), 0)));
    rod->setRestitution(1);
    rod->setFriction(btScalar(0.5));
    rod->setDamping(0, 0);
    rod->setLinearVelocity(btVector3(-6, -10, 0));
  }
  [[nodiscard]] double energy() const {
    const btVector3 spin = rod->getAngularVelocity() * rod->getWorldTransform().getBasis();
    const btVector3 inverse = rod->getInvInertiaDiagLocal();
    double sum = 0.5 * static_cast<double>(rod->getLinearVelocity().length2());
    for (int i = 0; i < 3; ++i) sum += 0.5 * static_cast<double>(spin[i] * spin[i] / inverse[i]);
    return sum;
  }
};

// Newton's law with friction is Bullet's own: nothing here is cut.
TEST_F(ImpactEnergy, ABouncingRodGainsInAPlainStep) {
  throw_rod(1e-6);
  const double before = energy();
  scene.world().stepSimulation(kStep, 0);
  EXPECT_GT(energy(), 1.02 * before);
}

TEST_F(ImpactEnergy, ABouncingRodGainsNothingInAStepThatIsCut) {
  throw_rod(0.05);
  const double before = energy();
  RollbackStepper stepper(scene.world(), solver);
  const RollbackReport report = stepper.step(kStep);
  EXPECT_EQ(report.contacts.size(), 1);
  EXPECT_LE(energy(), 1.0005 * before);
  EXPECT_GT(energy(), 0.96 * before);
  EXPECT_GT(rod->getAngularVelocity().z(), 10);
}

TEST_F(ImpactEnergy, WhereNoFrictionGainsTheRestitutionIsAsGiven) {
  throw_rod(0.05);
  rod->setFriction(0);
  const double before = energy();
  RollbackStepper stepper(scene.world(), solver);
  const RollbackReport report = stepper.step(kStep);
  EXPECT_EQ(report.contacts.size(), 1);
  EXPECT_NEAR(energy(), before, 1e-4 * before);
}

}  // namespace
}  // namespace pd::test
