/// @file
/// ODE's table of colliders: who answers a pair, and that ODE's own answers come back bit for bit.
#include "pd/ode/install.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "ode/ode_world.hpp"

namespace pd {
namespace {

using test::contacts_of;

class OdeInstall : public testing::Test {
 protected:
  void TearDown() override {
    uninstall_ode();
    for (const dGeomID geom : geoms_) {
      forget_ode_convex(geom);
      dGeomDestroy(geom);
    }
  }
  dGeomID add(dGeomID geom) {
    geoms_.push_back(geom);
    return geom;
  }
  /// One geom of each class, of about a unit.
  std::vector<dGeomID> one_of_each() {
    return {add(dCreateSphere(nullptr, 0.5f)),        add(dCreateBox(nullptr, 0.8f, 1, 1.2f)),
            add(dCreateCapsule(nullptr, 0.3f, 0.8f)), add(dCreateCylinder(nullptr, 0.4f, 0.9f)),
            add(dCreatePlane(nullptr, 0, 0, 1, 0)),   add(hull_.geom(nullptr))};
  }
  /// The numbers of all contacts of all pairs, in both orders, at some poses.
  std::vector<double> all_answers(const std::vector<dGeomID>& geoms) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<double> numbers;
    for (int trial = 0; trial < 4; ++trial) {
      for (const dGeomID geom : geoms) {
        if (dGeomGetClass(geom) == dPlaneClass) continue;
        const Vec3 at = 0.3 * Vec3{normal(random), normal(random), normal(random)};
        test::place(geom, at, Eigen::Quaterniond(normal(random), 1, 0.4, 0.2).normalized().toRotationMatrix());
      }
      for (const dGeomID first : geoms) {
        for (const dGeomID second : geoms) {
          for (const dContactGeom& c : contacts_of(first, second)) {
            EXPECT_EQ(c.g1, first);
            EXPECT_EQ(c.g2, second);
            for (int k = 0; k < 3; ++k) numbers.insert(numbers.end(), {c.pos[k], c.normal[k]});
            numbers.push_back(c.depth);
          }
        }
      }
    }
    return numbers;
  }

  test::OdeLibrary library_;
  test::OdeHull hull_{{{-0.5, -0.4, -0.3}, {0.5, -0.4, -0.3}, {0, 0.6, -0.3}, {0.1, 0, 0.6}}};
  std::vector<dGeomID> geoms_;
};

TEST_F(OdeInstall, OwnAnswersComeBackBitForBit) {
  auto geoms = one_of_each();
  for (const dGeomID geom : one_of_each()) geoms.push_back(geom);  // pairs of one class, too
  const std::vector<double> own = all_answers(geoms);
  ASSERT_GT(own.size(), 100u);
  const auto installed = install_ode();
  ASSERT_TRUE(installed);
  EXPECT_EQ(*installed, 20) << "fifteen pairs of five classes, and five on a plane";
  EXPECT_NE(all_answers(geoms), own);
  EXPECT_GT(ode_report().answered, 100);
  OdeOptions none;
  none.takes_pair = [](dGeomID, dGeomID, void*) { return false; };
  ASSERT_TRUE(install_ode(none)) << "a second time: other options";
  EXPECT_EQ(all_answers(geoms), own) << "pairs that are not taken are ODE's";
  EXPECT_EQ(ode_report().answered, 0);
  uninstall_ode();
  EXPECT_EQ(all_answers(geoms), own);
  uninstall_ode();
  EXPECT_EQ(all_answers(geoms), own);
  const auto again = install_ode();
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, 20);
}

TEST_F(OdeInstall, OverridesOfOthersStayTheirs) {
  dSetColliderOverride(dSphereClass, dBoxClass, [](dGeomID, dGeomID, int, dContactGeom*, int) { return 0; });
  const auto geoms = one_of_each();
  const auto installed = install_ode();
  ASSERT_TRUE(installed);
  EXPECT_EQ(*installed, 19);
  EXPECT_TRUE(contacts_of(geoms[0], geoms[1]).empty());
  EXPECT_FALSE(contacts_of(geoms[1], geoms[3]).empty());
  uninstall_ode();
  EXPECT_TRUE(contacts_of(geoms[0], geoms[1]).empty());
}

TEST_F(OdeInstall, OptionsAreChecked) {
  for (const double delta : {-1e-9, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    const auto installed = install_ode({.delta = delta});
    ASSERT_FALSE(installed);
    EXPECT_EQ(installed.error().where, "delta");
  }
}

TEST_F(OdeInstall, RoomForContacts) {
  const dGeomID low = add(dCreateBox(nullptr, 1, 1, 1)), high = add(dCreateBox(nullptr, 1, 1, 1));
  test::place(high, {0.125, 0, 0.875}, Eigen::AngleAxisd(0.01, Vec3::UnitY()).toRotationMatrix());
  ASSERT_TRUE(install_ode());
  const auto all = contacts_of(low, high);
  ASSERT_EQ(all.size(), 4u);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i].depth, all[i - 1].depth) << "the deepest first";
  const auto one = contacts_of(low, high, 1);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].depth, all[0].depth);
  // Contacts that stand apart in the caller's memory, as those of dContact do.
  std::array<dContact, 8> wide{};
  const int flags = static_cast<int>(CONTACTS_UNIMPORTANT | 8u);
  ASSERT_EQ(dCollide(low, high, flags, &wide[0].geom, sizeof(dContact)), 4);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(wide[i].geom.depth, all[i].depth);
  EXPECT_EQ(wide[1].surface.mu, 0);
}

TEST_F(OdeInstall, SpacesAndTransforms) {
  ASSERT_TRUE(install_ode());
  const dSpaceID outer = dSimpleSpaceCreate(nullptr), inner = dHashSpaceCreate(outer);
  const dGeomID low = dCreateBox(inner, 1, 1, 1), high = dCreateBox(outer, 1, 1, 1);
  dGeomSetPosition(high, 0, 0, 0.875f);
  int count = 0;
  dSpaceCollide2(reinterpret_cast<dGeomID>(inner), high, &count, [](void* data, dGeomID a, dGeomID b) {
    *static_cast<int*>(data) += static_cast<int>(contacts_of(a, b).size());
  });
  EXPECT_EQ(count, 4);
  EXPECT_EQ(contacts_of(reinterpret_cast<dGeomID>(inner), high).size(), 4u);
  // ODE discourages transforms and keeps them.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  dGeomSetPosition(low, 5, 0, 0);
  const dGeomID holder = dCreateGeomTransform(outer), held = dCreateBox(nullptr, 1, 1, 1);
  dGeomTransformSetGeom(holder, held);
  dGeomTransformSetCleanup(holder, 1);
#pragma GCC diagnostic pop
  dGeomSetPosition(held, 0, 0, 0.125f);
  dGeomSetPosition(holder, 0, 0, -0.125f);
  const auto through = contacts_of(holder, high);
  ASSERT_EQ(through.size(), 4u);
  EXPECT_NEAR(through[0].depth, 0.125, 1e-12);
  EXPECT_EQ(ode_report().answered, 3);
  dSpaceDestroy(outer);
}

TEST_F(OdeInstall, ChangedGeomsAreConvertedAgain) {
  ASSERT_TRUE(install_ode());
  const dGeomID low = add(dCreateBox(nullptr, 1, 1, 1)), high = add(dCreateBox(nullptr, 1, 1, 1));
  dGeomSetPosition(high, 0, 0, 0.875f);
  EXPECT_NEAR(contacts_of(low, high)[0].depth, 0.125, 1e-12);
  const std::int64_t before = ode_report().conversions;
  EXPECT_NEAR(contacts_of(low, high)[0].depth, 0.125, 1e-12);
  EXPECT_EQ(ode_report().conversions, before);
  dGeomBoxSetLengths(low, 1, 1, 1.5f);
  EXPECT_NEAR(contacts_of(low, high)[0].depth, 0.375, 1e-12);
  EXPECT_EQ(ode_report().conversions, before + 1);
}

TEST_F(OdeInstall, RemembersPairsIfAsked) {
  ASSERT_TRUE(install_ode({.remember_pairs = true}));
  const dGeomID low = add(dCreateBox(nullptr, 1, 1, 1)), high = add(hull_.geom(nullptr));
  for (int i = 0; i < 5; ++i) {
    test::place(high, {0.01 * i, 0, 0.7});
    EXPECT_NEAR(contacts_of(low, high)[0].depth, 0.1, 1e-12);
  }
}

TEST_F(OdeInstall, ThreadsGetTheSameBits) {
  ASSERT_TRUE(install_ode({.delta = 1e-9}));
  const auto answers = [](std::vector<double>& numbers) {
    dAllocateODEDataForThread(dAllocateMaskAll);
    const dGeomID low = dCreateCylinder(nullptr, 0.4f, 0.9f), high = dCreateBox(nullptr, 1, 1, 1);
    for (int i = 0; i < 50; ++i) {
      test::place(high, {0.01 * i, 0.02 * i, 0.8}, Eigen::AngleAxisd(0.1 * i, Vec3::UnitX()).toRotationMatrix());
      for (const dContactGeom& c : contacts_of(low, high))
        numbers.insert(numbers.end(), {c.depth, c.pos[0], c.normal[2]});
    }
    dGeomDestroy(low);
    dGeomDestroy(high);
    dCleanupODEAllDataForThread();
  };
  std::vector<double> alone, together[2];
  std::thread threads[2];
  for (int i = 0; i < 2; ++i) threads[i] = std::thread([&, i] { answers(together[i]); });
  for (std::thread& thread : threads) thread.join();
  answers(alone);
  dAllocateODEDataForThread(dAllocateMaskAll);
  EXPECT_EQ(together[0], alone);
  EXPECT_EQ(together[1], alone);
  EXPECT_EQ(ode_report().answered, 150) << "what threads counted that have ended is still there";
}

}  // namespace
}  // namespace pd
