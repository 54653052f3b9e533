// What Bullet's detector does with a solver's answer, row by row of the contract, and what our solver makes of it. The
// detector is the real btGjkPairDetector.
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <thread>

#include "pd/bullet/pair_answer.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"

namespace {

constexpr bool kDouble = sizeof(btScalar) == sizeof(double);
const double kEps = kDouble ? 1e-12 : 2e-6;

/// Answers as told, and remembers what it was asked.
class ScriptedSolver : public btConvexPenetrationDepthSolver {
 public:
  bool answer = true;
  btVector3 v{0, 0, 0};
  btVector3 witness_a{0, 0, 0};
  btVector3 witness_b{0, 0, 0};
  int calls = 0;
  btVector3 v_on_entry{9, 9, 9};
  btVector3 sum_of_origins{9, 9, 9};

  bool calcPenDepth(btSimplexSolverInterface&, const btConvexShape*, const btConvexShape*, const btTransform& ta,
                    const btTransform& tb, btVector3& out_v, btVector3& a, btVector3& b, btIDebugDraw*) override {
    ++calls;
    v_on_entry = out_v;
    sum_of_origins = ta.getOrigin() + tb.getOrigin();
    out_v = v;
    a = witness_a;
    b = witness_b;
    return answer;
  }
};

btPointCollector detect(const btConvexShape& a, const btTransform& ta, const btConvexShape& b, const btTransform& tb,
                        btConvexPenetrationDepthSolver* solver) {
  btVoronoiSimplexSolver simplex;
  btGjkPairDetector detector(&a, &b, &simplex, solver);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = ta;
  input.m_transformB = tb;
  input.m_maximumDistanceSquared = btScalar(1);
  btPointCollector result;
  detector.getClosestPoints(input, result, nullptr);
  return result;
}

btTransform at(btScalar x, btScalar y, btScalar z) {
  return btTransform(btQuaternion::getIdentity(), btVector3(x, y, z));
}

/// Two unit boxes without margin, 0.2 deep along x, far from the origin so that the detector's shift shows.
class TwoBoxes : public ::testing::Test {
 protected:
  TwoBoxes() { box.setMargin(0); }
  btBoxShape box{btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5))};
  btTransform pose_a = at(btScalar(10.8), 5, 0);
  btTransform pose_b = at(10, 5, 0);
};

TEST_F(TwoBoxes, InputsAreAZeroVectorAndAFrameBetweenTheBodies) {
  ScriptedSolver solver;
  detect(box, pose_a, box, pose_b, &solver);
  ASSERT_EQ(solver.calls, 1);
  EXPECT_EQ(solver.v_on_entry.length2(), 0);
  EXPECT_NEAR(static_cast<double>(solver.sum_of_origins.length()), 0, 1e-5);
}

TEST_F(TwoBoxes, TrueTakesTheWitnessesAndPutsTheShiftBack) {
  ScriptedSolver solver;
  // In the shifted frame A stands at +0.4 and B at -0.4: A's deepest point is its left face at -0.1, B's its right at
  // 0.1.
  solver.v = btVector3(0, 1, 0);  // its direction is ignored
  solver.witness_a = btVector3(btScalar(-0.1), 0, 0);
  solver.witness_b = btVector3(btScalar(0.1), 0, 0);
  const btPointCollector result = detect(box, pose_a, box, pose_b, &solver);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_NEAR(static_cast<double>(result.m_distance), -0.2, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_normalOnBInWorld.x()), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_pointInWorld.x()), 10.5, 1e-5);
  EXPECT_NEAR(static_cast<double>(result.m_pointInWorld.y()), 5.0, 1e-5);
}

TEST_F(TwoBoxes, TrueWithCoincidingWitnessesTakesV) {
  ScriptedSolver solver;
  solver.v = btVector3(0, 0, 2);
  const btPointCollector result = detect(box, pose_a, box, pose_b, &solver);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_NEAR(std::abs(static_cast<double>(result.m_normalOnBInWorld.z())), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_distance), 0, 1e-6);
}

TEST_F(TwoBoxes, ZeroVIsNoAnswer) {
  for (const bool answer : {true, false}) {
    ScriptedSolver solver;
    solver.answer = answer;
    solver.witness_a = btVector3(btScalar(-0.1), 0, 0);
    solver.witness_b = btVector3(btScalar(0.1), 0, 0);
    const btPointCollector result = detect(box, pose_a, box, pose_b, &solver);
    // Nothing at the solver's depth: the detector has only what its own distance query had.
    EXPECT_FALSE(result.m_hasResult && result.m_distance < btScalar(-0.15)) << answer;
  }
}

TEST_F(TwoBoxes, FalseTakesCorePointsAndAUnitWorldNormal) {
  ScriptedSolver solver;
  btBoxShape rounded(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  rounded.setMargin(btScalar(0.1));
  // Cores of half width 0.4 at +-0.45: a gap of 0.1 between cores, less than the margins' 0.2, but nearer than GJK
  // thinks only through the degenerate branch; so the cores are made to overlap and the answer is told.
  solver.answer = false;
  solver.v = btVector3(1, 0, 0);
  solver.witness_a = btVector3(btScalar(0.05), 0, 0);
  solver.witness_b = btVector3(btScalar(-0.05), 0, 0);
  const btPointCollector result =
      detect(rounded, at(btScalar(0.39), 0, 0), rounded, at(btScalar(-0.39), 0, 0), &solver);
  ASSERT_EQ(solver.calls, 1);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_NEAR(static_cast<double>(result.m_distance), 0.1 - 0.2, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_normalOnBInWorld.x()), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_pointInWorld.x()), -0.05 + 0.1, 1e-6);  // core point plus B's margin
}

TEST_F(TwoBoxes, SwappedWitnessesFlipTheNormalAndLeaveThePointWrong) {
  ScriptedSolver solver;
  solver.v = btVector3(1, 0, 0);
  solver.witness_a = btVector3(btScalar(0.1), 0, 0);
  solver.witness_b = btVector3(btScalar(-0.1), 0, 0);
  const btPointCollector result = detect(box, pose_a, box, pose_b, &solver);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_NEAR(static_cast<double>(result.m_normalOnBInWorld.x()), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_pointInWorld.x()), 10.3, 1e-5);  // right would be 10.5
}

// ---- our solver in the same rows ----

TEST_F(TwoBoxes, OurOverlap) {
  pd::BulletPenetrationDepthSolver solver;
  const btPointCollector result = detect(box, pose_a, box, pose_b, &solver);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_EQ(solver.statistics().overlapping, 1);
  EXPECT_NEAR(static_cast<double>(result.m_distance), -0.2, 1e-5);
  EXPECT_NEAR(static_cast<double>(result.m_normalOnBInWorld.x()), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.m_pointInWorld.x()), 10.5, 1e-5);
}

TEST_F(TwoBoxes, OurAnswerInItself) {
  pd::BulletPenetrationDepthSolver solver;
  btVoronoiSimplexSolver simplex;
  btVector3 v(0, 0, 0);
  btVector3 a;
  btVector3 b;
  ASSERT_TRUE(
      solver.calcPenDepth(simplex, &box, &box, at(btScalar(0.4), 0, 0), at(btScalar(-0.4), 0, 0), v, a, b, nullptr));
  EXPECT_NEAR(static_cast<double>((b - a - v * btScalar(0.2)).length()), 0, kEps);
  EXPECT_NEAR(static_cast<double>(v.length()), 1, kEps);
  EXPECT_NEAR(static_cast<double>(a.x()), -0.1, kEps);
  EXPECT_NEAR(static_cast<double>(b.x()), 0.1, kEps);
}

TEST_F(TwoBoxes, OurTouchGivesANormal) {
  pd::BulletPenetrationDepthSolver solver;
  const btPointCollector result = detect(box, at(btScalar(0.5), 0, 0), box, at(btScalar(-0.5), 0, 0), &solver);
  ASSERT_EQ(solver.statistics().touching, 1);
  ASSERT_TRUE(result.m_hasResult);
  EXPECT_NEAR(static_cast<double>(result.m_distance), 0, kEps);
  EXPECT_NEAR(static_cast<double>(result.m_normalOnBInWorld.x()), 1, kEps);
}

TEST_F(TwoBoxes, OurSeparationIsInCorePointsAndWorldAxes) {
  btBoxShape rounded(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  rounded.setMargin(btScalar(0.1));
  pd::BulletPenetrationDepthSolver solver;
  btVoronoiSimplexSolver simplex;
  btVector3 v(0, 0, 0);
  btVector3 a;
  btVector3 b;
  // A is turned about x by a quarter: its local frame differs from the world's, its extent along x does not.
  btTransform turned(btQuaternion(btVector3(1, 0, 0), SIMD_HALF_PI), btVector3(btScalar(0.55), 0, 0));
  ASSERT_FALSE(solver.calcPenDepth(simplex, &rounded, &rounded, turned, at(btScalar(-0.55), 0, 0), v, a, b, nullptr));
  EXPECT_NEAR(static_cast<double>(v.x()), 1, kEps);
  EXPECT_NEAR(static_cast<double>((a - b).length()) - 0.2, 0.1, 10 * kEps);
  EXPECT_NEAR(static_cast<double>(a.x()), 0.15, 10 * kEps);
  EXPECT_NEAR(static_cast<double>(b.x()), -0.15, 10 * kEps);
}

TEST_F(TwoBoxes, NotFiniteIsNoAnswer) {
  pd::BulletPenetrationDepthSolver solver;
  btVoronoiSimplexSolver simplex;
  btVector3 v(0, 0, 0);
  btVector3 a(0, 0, 0);
  btVector3 b(0, 0, 0);
  const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
  EXPECT_FALSE(solver.calcPenDepth(simplex, &box, &box, at(nan, 0, 0), pose_b, v, a, b, nullptr));
  EXPECT_EQ(v.length2(), 0);
  EXPECT_EQ(solver.statistics().refused_poses, 1);
}

/// Bullet's EPA with a count.
class CountedEpa : public btGjkEpaPenetrationDepthSolver {
 public:
  int calls = 0;
  bool calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                    const btTransform& pose_a, const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                    btVector3& witness_b, btIDebugDraw* draw) override {
    ++calls;
    return btGjkEpaPenetrationDepthSolver::calcPenDepth(simplex, a, b, pose_a, pose_b, v, witness_a, witness_b, draw);
  }
};

TEST(Fallback, IsBulletsOwnUnlessAnotherIsGiven) {
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, btScalar(0.5)};
  btMultiSphereShape unequal(centres, radii, 2);
  unequal.setLocalScaling(btVector3(1, 1, btScalar(1.5)));
  const btSphereShape sphere(1);
  CountedEpa epa;
  for (CountedEpa* given : {static_cast<CountedEpa*>(nullptr), &epa}) {
    pd::BulletSolverSettings settings;
    settings.warning = nullptr;
    settings.fallback = given;
    pd::BulletPenetrationDepthSolver solver(settings);
    btVoronoiSimplexSolver simplex;
    btVector3 v(0, 0, 0);
    btVector3 a;
    btVector3 b;
    EXPECT_TRUE(
        solver.calcPenDepth(simplex, &unequal, &sphere, at(0, 0, 0), at(0, btScalar(1.5), 0), v, a, b, nullptr));
    EXPECT_EQ(solver.statistics().unsupported, 1);
    EXPECT_EQ(solver.statistics().fallback, 1);
    EXPECT_NEAR(static_cast<double>((b - a).length()), 0.5, 1e-2);
  }
  EXPECT_EQ(epa.calls, 1);
}

btTransform random_pose(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  btQuaternion q{static_cast<btScalar>(normal(random)), static_cast<btScalar>(normal(random)),
                 static_cast<btScalar>(normal(random)), static_cast<btScalar>(normal(random))};
  q.normalize();
  std::uniform_real_distribution<double> uniform(-reach, reach);
  return btTransform(q, pd::to_bullet(pd::Vec3{uniform(random), uniform(random), uniform(random)}));
}

TEST(SmallBodies, FiveMillimetreBoxesAreAnsweredAtTheirOwnScale) {
  // Bullet's EPA has absolute tolerances of 1e-4: at half a centimetre most of its answers are off by more than 1 %.
  // Truth for two boxes: the least overlap over the 15 axes of the separating axis test.
  const double h = 0.005;
  btBoxShape box(pd::to_bullet(pd::Vec3::Constant(h)));
  box.setMargin(0);
  const double half = static_cast<double>(box.getImplicitShapeDimensions().x());
  std::mt19937 random(11);
  pd::BulletPenetrationDepthSolver solver;
  int overlapping = 0;
  for (int i = 0; i < 500; ++i) {
    const btTransform ta = random_pose(random, 0.6 * h);
    const btTransform tb = random_pose(random, 0.6 * h);
    const pd::Mat3 ra = pd::to_pd(ta.getBasis());
    const pd::Mat3 rb = pd::to_pd(tb.getBasis());
    const pd::Vec3 offset = pd::to_pd(ta.getOrigin()) - pd::to_pd(tb.getOrigin());
    double least = HUGE_VAL;
    const auto axis = [&](const pd::Vec3& direction) {
      const double length = direction.norm();
      if (length > 1e-3) {
        const pd::Vec3 n = direction / length;
        least = std::min(least, half * ((ra.transpose() * n).cwiseAbs().sum() + (rb.transpose() * n).cwiseAbs().sum()) -
                                    std::abs(n.dot(offset)));
      }
    };
    for (int k = 0; k < 3; ++k) {
      axis(ra.inverse().transpose().col(k));
      axis(rb.inverse().transpose().col(k));
      for (int j = 0; j < 3; ++j) {
        axis(ra.col(k).cross(rb.col(j)));
      }
    }
    const auto answer = solver.query(box, ta, box, tb);
    ASSERT_TRUE(answer.has_value());
    if (least > 0) {
      ++overlapping;
      EXPECT_NEAR(answer->depth.depth, least, 1e-6 * h) << i;
    } else {
      EXPECT_EQ(answer->depth.contact, pd::ContactClass::separated) << i;
    }
  }
  EXPECT_GT(overlapping, 200);
}

TEST(Threads, SameBitsFromEveryThread) {
  btConvexHullShape hull;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 30; ++i) {
    hull.addPoint(pd::to_bullet(pd::Vec3{normal(random), normal(random), normal(random)}.normalized()));
  }
  const btCylinderShape cylinder(btVector3(1, 1, 1));
  std::vector<std::pair<btTransform, btTransform>> poses;
  for (int i = 0; i < 60; ++i) {
    poses.push_back({random_pose(random, 0.6), random_pose(random, 0.6)});
  }
  pd::BulletPenetrationDepthSolver solver;
  const auto run = [&](std::vector<pd::Vec3>& out) {
    for (const auto& [ta, tb] : poses) {
      out.push_back(solver.query(hull, ta, hull, tb)->depth.translation);
      out.push_back(solver.query(hull, ta, cylinder, tb)->depth.translation);
    }
  };
  std::vector<pd::Vec3> serial;
  run(serial);
  std::vector<std::vector<pd::Vec3>> parallel(4);
  std::vector<std::thread> threads;
  for (auto& out : parallel) {
    threads.emplace_back([&run, &out] { run(out); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const auto& out : parallel) {
    EXPECT_EQ(out, serial);
  }
  EXPECT_EQ(solver.statistics().calls, static_cast<std::int64_t>(5 * 2 * poses.size()));
}

}  // namespace
