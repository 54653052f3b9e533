// A body on a half-space against the same body on a box so large that it is one.
#include "pd/contact/halfspace_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "pd/depth/scratch.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Pose;
using pd::Vec3;

constexpr double kThreshold = 0.02;
constexpr double kGround = 200;

std::vector<Vec3> round_points(int count, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(0.4 * Vec3{normal(random), normal(random), normal(random)}.normalized());
  return points;
}

std::vector<ConvexShape> bodies(std::mt19937_64& random) {
  std::vector<ConvexShape> result;
  const ConvexPolytope box = ConvexPolytope::box(Vec3(.4, .3, .2)).value();
  result.emplace_back(box);
  result.push_back(ConvexShape(box).with_margin(.05).value());
  result.emplace_back(ConvexPolytope::from_points(round_points(20, random)).value());
  result.emplace_back(ConvexPolytope::from_points(round_points(200, random)).value());
  result.push_back(ConvexShape::sphere(.3).value());
  result.push_back(ConvexShape::capsule(.2, .3, 1).value());
  result.push_back(ConvexShape::cylinder(.3, .2, 1).value());
  result.push_back(ConvexShape::cone(.3, .25, 2).value().with_margin(.02).value());
  result.push_back(ConvexShape::ellipsoid(Vec3(.1, .2, .3)).value());
  return result;
}

Pose turned(std::mt19937_64& random, const Vec3& at) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond turn{normal(random), normal(random), normal(random), normal(random)};
  return Pose::from_trusted_matrix(turn.normalized().toRotationMatrix(), at);
}

/// The ground is turned, too: {x : <n, x> <= offset}, and the box whose upper face it is.
struct Ground {
  pd::Halfspace3 halfspace;
  ConvexShape box = ConvexShape(ConvexPolytope::box(Vec3::Constant(kGround)).value());
  Pose pose;
};

Ground ground(std::mt19937_64& random) {
  Ground result;
  const Pose pose = turned(random, Vec3(3, -2, 1));
  const Vec3 n = pose.rotation().col(1);
  result.pose = Pose::from_trusted_matrix(pose.rotation(), pose.translation() - kGround * n);
  result.halfspace = {n, n.dot(pose.translation())};
  return result;
}

/// Turned anyhow, so that its lowest point lies `depth` below the ground.
Pose lowered(const ConvexShape& body, const pd::Halfspace3& under, double depth, std::mt19937_64& random,
             pd::ManifoldScratch& buffers) {
  const Pose pose = turned(random, Vec3(3, -2, 1));
  const auto first = pd::halfspace_contact({&body, pose}, under, kThreshold, buffers);
  return Pose::from_trusted_matrix(pose.rotation(), pose.translation() - (first.lower + depth) * under.normal);
}

typedef Eigen::Matrix<long double, 3, 1> Long3;

/// Of the body's lowest point over the ground, in the 64 bits of long doubles; rotations as they are stored.
long double signed_distance(const ConvexShape& body, const Pose& pose, const pd::Halfspace3& under) {
  const Long3 n = under.normal.cast<long double>();
  const Long3 local = pose.rotation().cast<long double>().transpose() * n;
  long double lowest = 0;
  if (const ConvexPolytope* polytope = body.polytope()) {
    lowest = HUGE_VALL;
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      lowest = std::min(lowest, local.dot(polytope->vertex(v).cast<long double>()));
    }
  } else if (const auto* e = std::get_if<pd::Ellipsoid>(&body.core())) {
    lowest = -e->radii.cast<long double>().cwiseProduct(local).norm();
  } else {
    const auto* cylinder = std::get_if<pd::Cylinder>(&body.core());
    const auto* cone = std::get_if<pd::Cone>(&body.core());
    const int axis = cylinder != nullptr ? cylinder->axis : cone->axis;
    Long3 radial = local;
    radial[axis] = 0;
    const long double round = radial.norm() * static_cast<long double>(cylinder ? cylinder->radius : cone->radius);
    lowest = cylinder != nullptr ? -round - std::abs(local[axis]) * static_cast<long double>(cylinder->half_height)
                                 : std::min(-round - local[axis] * static_cast<long double>(cone->half_height),
                                            local[axis] * static_cast<long double>(cone->half_height));
  }
  return lowest + n.dot(pose.translation().cast<long double>()) - static_cast<long double>(body.margin()) -
         static_cast<long double>(under.offset);
}

TEST(HalfspaceContact, TheBracketHoldsTheDistance) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> deep(-1e-14, 1e-14), power(-8, 8);
  pd::ManifoldScratch buffers;
  long double most = 0;
  for (int round = 0; round < 400; ++round) {
    Ground under = ground(random);
    // Far from the origin, too, where what is added up is large beside the distance.
    const double away = std::pow(10, power(random));
    const Vec3 by = away * Vec3(.3, -.5, .8);
    under.halfspace.offset += under.halfspace.normal.dot(by);
    for (const ConvexShape& body : bodies(random)) {
      const Pose pose = lowered(body, under.halfspace, deep(random), random, buffers);
      const auto found = pd::halfspace_contact({&body, pose}, under.halfspace, kThreshold, buffers);
      // Curved cores turn by the nearest rotation, which is the stored one to some units of rounding.
      const long double exact = signed_distance(body, pose, under.halfspace);
      EXPECT_LE(static_cast<long double>(found.lower), exact);
      EXPECT_GE(static_cast<long double>(found.upper), exact);
      const long double middle = (static_cast<long double>(found.lower) + static_cast<long double>(found.upper)) / 2;
      most = std::max(most, 2 * std::abs(exact - middle) / static_cast<long double>(found.upper - found.lower));
    }
  }
  // The bound is used, not only held.
  EXPECT_GT(most, .01L);
}

TEST(HalfspaceContact, IsTheDistanceFromALargeBox) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> deep(-.1, .1);
  pd::Scratch scratch;
  pd::ManifoldScratch buffers;
  int overlapping = 0;
  for (int round = 0; round < 40; ++round) {
    const Ground under = ground(random);
    for (const ConvexShape& body : bodies(random)) {
      const Pose pose = lowered(body, under.halfspace, deep(random), random, buffers);
      const auto found = pd::halfspace_contact({&body, pose}, under.halfspace, kThreshold, buffers);
      const pd::PenetrationDepth answer = pd::penetration_depth({&body, pose}, {&under.box, under.pose}, scratch);
      const double distance = answer.signed_distance();
      // The box's corners are rounded to some 1e-13; curved bodies' answers are as good as was asked for.
      EXPECT_NEAR(found.lower, distance, body.polytope() != nullptr ? 1e-12 : 1e-7);
      EXPECT_GE(found.upper, found.lower);
      EXPECT_LE(found.upper - found.lower, 1e-13);
      EXPECT_EQ(found.contact, answer.contact);
      if (found.manifold.count > 0) {
        EXPECT_GT(found.highest, found.lower + .1);
      }
      overlapping += found.contact == pd::ContactClass::overlapping ? 1 : 0;
      EXPECT_EQ(found.manifold.count > 0, distance <= kThreshold);
    }
  }
  EXPECT_GT(overlapping, 100);
}

TEST(HalfspaceContact, HasThePointsOfALargeBox) {
  std::mt19937_64 random(6);
  pd::Scratch scratch;
  pd::ManifoldScratch buffers;
  for (int round = 0; round < 40; ++round) {
    const Ground under = ground(random);
    const Vec3& n = under.halfspace.normal;
    for (const ConvexShape& body : bodies(random)) {
      const Pose pose = lowered(body, under.halfspace, .01, random, buffers);
      const auto found = pd::halfspace_contact({&body, pose}, under.halfspace, kThreshold, buffers);
      const pd::PenetrationDepth answer = pd::penetration_depth({&body, pose}, {&under.box, under.pose}, scratch);
      const pd::ContactManifold wanted = pd::contact_manifold({&body, pose}, {&under.box, under.pose}, answer,
                                                              kThreshold, buffers, pd::DeepestPoint::as_lifted);
      ASSERT_GT(found.manifold.count, 0);
      EXPECT_NEAR((found.manifold.normal - n).norm(), 0, 1e-15);
      double deepest = -1;
      for (int i = 0; i < found.manifold.count; ++i) {
        const pd::ContactPoint& point = found.manifold.points[static_cast<std::size_t>(i)];
        deepest = std::max(deepest, point.depth);
        EXPECT_NEAR(n.dot(point.position_b) - under.halfspace.offset, 0, 1e-13);
        EXPECT_NEAR((point.position_b - point.position_a - point.depth * n).norm(), 0, 1e-13);
        EXPECT_GE(point.depth, -kThreshold);
      }
      EXPECT_NEAR(deepest, -found.lower, kThreshold * 1e-3 + 1e-12);
      if (body.polytope() == nullptr) continue;
      // The same corners; a face that lies flush has more than four, of which either may choose.
      EXPECT_EQ(found.manifold.count, wanted.count);
      std::set<std::int64_t> ids;
      for (int i = 0; i < wanted.count; ++i) ids.insert(wanted.points[static_cast<std::size_t>(i)].feature_id);
      if (wanted.count < 4) {
        for (int i = 0; i < found.manifold.count; ++i) {
          EXPECT_EQ(ids.count(found.manifold.points[static_cast<std::size_t>(i)].feature_id), 1U);
        }
      }
    }
  }
}

TEST(HalfspaceContact, ABoxAtRestHasItsFourCorners) {
  const ConvexShape box = ConvexShape(ConvexPolytope::box(Vec3(.46, .46, .46)).value()).with_margin(.04).value();
  pd::ManifoldScratch buffers;
  const Pose pose = Pose::from_trusted_matrix(pd::Mat3::Identity(), Vec3(7, .4990, -3));
  const auto found = pd::halfspace_contact({&box, pose}, {Vec3::UnitY(), 0}, kThreshold, buffers);
  EXPECT_EQ(found.contact, pd::ContactClass::overlapping);
  EXPECT_NEAR(found.lower, -.001, 1e-13);
  EXPECT_NEAR(found.highest, .999, 1e-13);
  ASSERT_EQ(found.manifold.count, 4);
  std::set<std::pair<double, double>> places;
  for (const pd::ContactPoint& point : found.manifold.points) {
    EXPECT_NEAR(point.depth, .001, 1e-13);
    EXPECT_NEAR(std::abs(point.position_b.x() - 7), .46, 1e-13);
    EXPECT_NEAR(std::abs(point.position_b.z() + 3), .46, 1e-13);
    places.insert({point.position_b.x(), point.position_b.z()});
  }
  EXPECT_EQ(places.size(), 4U);
}

TEST(HalfspaceContact, ACylinderThatLeansTouchesWithItsLowestPoint) {
  // Between two of the sixteen points of its rim.
  const ConvexShape cylinder = ConvexShape::cylinder(.5, .5, 1).value();
  const pd::Mat3 turn =
      (Eigen::AngleAxisd(.3, Vec3::UnitX()) * Eigen::AngleAxisd(.2, Vec3::UnitY())).toRotationMatrix();
  pd::ManifoldScratch buffers;
  const auto found = pd::halfspace_contact({&cylinder, Pose::from_trusted_matrix(turn, Vec3(0, 1, 0))},
                                           {Vec3::UnitY(), .4}, kThreshold, buffers);
  const double lowest = 1 - .5 * std::cos(.3) - .5 * std::sin(.3);
  EXPECT_NEAR(found.lower, lowest - .4, 1e-13);
  double deepest = -1;
  for (int i = 0; i < found.manifold.count; ++i) {
    deepest = std::max(deepest, found.manifold.points[static_cast<std::size_t>(i)].depth);
  }
  EXPECT_NEAR(deepest, .4 - lowest, 1e-13);
}

}  // namespace
