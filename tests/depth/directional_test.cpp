/// @file
/// Directional depth by two methods against each other and against the exact oracle, and the queries on P that never
/// build it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "oracle/depth_oracle.hpp"
#include "oracle/wanted_cases.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

/// How many random cases a test takes: PD_DIRECTIONAL_CASES asks for more.
int cases(int usual) { return test::wanted_cases("PD_DIRECTIONAL_CASES", usual); }

struct Bodies {
  std::vector<Vec3> points_a, points_b;
  ConvexShape a, b;
  Pose pose_a, pose_b;
  Bodies(std::vector<Vec3> pa, const Pose& qa, std::vector<Vec3> pb, const Pose& qb)
      : points_a(std::move(pa)),
        points_b(std::move(pb)),
        a(*ConvexPolytope::from_points(points_a)),
        b(*ConvexPolytope::from_points(points_b)),
        pose_a(qa),
        pose_b(qb) {}
  [[nodiscard]] PosedShape posed_a() const { return {&a, pose_a}; }
  [[nodiscard]] PosedShape posed_b() const { return {&b, pose_b}; }
};

std::vector<Vec3> sphere_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(Vec3{normal(random), normal(random), normal(random)}.normalized());
  return points;
}

std::vector<Vec3> grid_points(std::mt19937_64& random, int n) {
  std::uniform_int_distribution<int> coordinate(-2, 2);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    points.push_back(Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>());
  return points;
}

Pose random_pose(std::mt19937_64& random, double spread) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return *Pose::from_quaternion(q, spread * Vec3{normal(random), normal(random), normal(random)});
}

/// @param facet  also the facet's: a ray through an edge of P leaves through either facet.
void expect_same(const DirectionalDepth& x, const DirectionalDepth& y, bool facet = true) {
  EXPECT_EQ(x.contact, y.contact);
  EXPECT_EQ(x.lower, y.lower);
  EXPECT_EQ(x.upper, y.upper);
  EXPECT_EQ(x.depth, y.depth);
  if (x.contact != ContactClass::overlapping || !facet) return;
  EXPECT_EQ(x.normal, y.normal);
  for (const auto& [p, q] : {std::pair{x.feature_a, y.feature_a}, std::pair{x.feature_b, y.feature_b}}) {
    EXPECT_EQ(p.kind, q.kind);
    EXPECT_EQ(p.first, q.first);
    EXPECT_EQ(p.second, q.second);
  }
}

/// Both methods must give the same neighbouring doubles; the point that they bracket lies inside P before and outside
/// after.
void check(const Bodies& bodies, const Vec3& direction, Scratch& scratch, int& overlapping, bool generic = true) {
  const auto portal = directional_depth(bodies.posed_a(), bodies.posed_b(), direction, scratch);
  const auto overlay =
      directional_depth(bodies.posed_a(), bodies.posed_b(), direction, scratch, DirectionalMethod::overlay);
  ASSERT_TRUE(portal.has_value() && overlay.has_value());
  if (bodies.a.polytope()->affine_dimension() == 3 && bodies.b.polytope()->affine_dimension() == 3) {
    const auto hierarchy =
        directional_depth(bodies.posed_a(), bodies.posed_b(), direction, scratch, DirectionalMethod::hierarchy);
    ASSERT_TRUE(hierarchy.has_value());
    EXPECT_EQ(hierarchy->lower, portal->lower);
    EXPECT_EQ(hierarchy->upper, portal->upper);
    EXPECT_EQ(hierarchy->contact, portal->contact);
  }
  expect_same(*portal, *overlay, generic);  // whose numbers are rounded from exact ones
  if (portal->contact != ContactClass::overlapping) {
    EXPECT_EQ(portal->depth, 0);
    return;
  }
  ++overlapping;
  EXPECT_LE(portal->lower, portal->upper);
  EXPECT_LE(portal->upper, std::nextafter(portal->lower, HUGE_VAL));
  const oracle::Body body_a(bodies.points_a), body_b(bodies.points_b);
  oracle::JudgeSettings settings;
  settings.distance = false;
  const Vec3 unit = direction.stableNormalized();
  for (const double factor : {1 - 1e-9, 1 + 1e-9}) {
    const oracle::ExactPair exact(body_a, bodies.pose_a, body_b, bodies.pose_b, factor * portal->depth * unit);
    const ContactClass contact = oracle::judge(exact, settings).contact;
    EXPECT_EQ(contact, factor < 1 ? ContactClass::overlapping : ContactClass::separated);
  }
}

TEST(DirectionalDepth, RandomSolids) {
  std::mt19937_64 random(test::wanted_seed(21));
  std::normal_distribution<double> normal;
  Scratch scratch;
  int overlapping = 0;
  const int rounds = cases(200);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Bodies bodies{sphere_points(4 + round % 40, random), random_pose(random, 0.4),
                        sphere_points(4 + (3 * round) % 40, random), random_pose(random, 0.4)};
    check(bodies, Vec3{normal(random), normal(random), normal(random)}, scratch, overlapping);
  }
  EXPECT_GT(overlapping, 2 * rounds / 5);
}

TEST(DirectionalDepth, WarmAnswersAreTheColdOnes) {
  // Directions that move a little or a lot, poses too; certificates of other bodies and of nothing at all.
  std::mt19937_64 random(test::wanted_seed(27));
  std::normal_distribution<double> normal;
  Scratch scratch;
  const int rounds = cases(300);
  DirectionalCertificate certificate;
  std::int64_t warm = 0, cold = 0;
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const bool grid = round % 4 == 3;
    const Bodies bodies{grid ? grid_points(random, 30) : sphere_points(40 + round % 400, random),
                        grid ? Pose() : random_pose(random, 0.2),
                        grid ? grid_points(random, 30) : sphere_points(60 + round % 200, random),
                        grid ? Pose() : random_pose(random, 0.2)};
    if (round % 5 == 4) {
      certificate.triangles = static_cast<std::int32_t>(random() % 27);
      for (auto& triangle : certificate.vertices) {
        for (std::int32_t& v : triangle) v = static_cast<std::int32_t>(random() % (round % 2 == 0 ? 40 : 70));
        if (random() % 50 == 0) triangle[3] = -1;
      }
    }
    Vec3 d{normal(random), normal(random), normal(random)};
    for (int turn = 0; turn < 6; ++turn) {
      if (grid && turn % 2 == 0) d = Vec3{double(random() % 5) - 2, double(random() % 5) - 2, 1};
      const auto plain = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch);
      const auto again = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch, DirectionalMethod::portal,
                                           nullptr, &certificate);
      ASSERT_TRUE(plain.has_value() && again.has_value());
      expect_same(*again, *plain);
      if (turn > 0 && !grid) {
        warm += again->statistics.support_calls;
        cold += plain->statistics.support_calls;
      }
      d += (turn == 3 ? 1.0 : 0.01) * Vec3{normal(random), normal(random), normal(random)};
    }
  }
  EXPECT_LT(2 * warm, cold);
}

TEST(DirectionalDepth, GridBodiesAlongGridDirections) {
  // Rays through vertices and along edges and facets of P, and vertices of P at or in line with the origin.
  std::mt19937_64 random(test::wanted_seed(22));
  std::uniform_int_distribution<int> coordinate(-2, 2);
  Scratch scratch;
  int overlapping = 0;
  const int rounds = cases(500);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Bodies bodies{grid_points(random, 2 + round % 8), Pose(), grid_points(random, 4 + round % 7), Pose()};
    Vec3 direction = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (direction.isZero(0)) direction = Vec3::UnitZ();
    check(bodies, direction, scratch, overlapping, false);
  }
  EXPECT_GT(overlapping, 2 * rounds / 5);
}

TEST(DirectionalDepth, ALineThatOnlyMeetsAVertexOfTheSum) {
  // The line runs along P's boundary and through a corner of the portal, with P on both sides of each of its sides: a
  // descent once took it for one through the inside.
  const Bodies bodies({{-2, -2, -1}, {0, 0, 2}, {1, 0, -2}, {0, 0, -2}, {-2, 2, 0}, {-1, 2, -2}}, Pose(),
                      {{1, -1, 0}, {0, 2, 2}, {1, 0, 2}, {-1, 2, 2}}, Pose());
  Scratch scratch;
  int overlapping = 0;
  check(bodies, Vec3(-1, 1, 2), scratch, overlapping, false);
  EXPECT_EQ(overlapping, 0);
}

TEST(DirectionalDepth, BoxesByHand) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box(Vec3(1, 1, 1)));
  const Pose aside = *Pose::from_matrix(Mat3::Identity(), Vec3(0.5, 0, 0));
  const auto depth = [&](const Vec3& direction) {
    return directional_depth({&box, aside}, {&box, Pose()}, direction, scratch)->depth;
  };
  EXPECT_EQ(depth(Vec3(3, 0, 0)), 1.5);
  EXPECT_EQ(depth(Vec3(-1e-200, 0, 0)), 2.5);
  EXPECT_EQ(depth(Vec3(0, 1e200, 0)), 2);
  EXPECT_DOUBLE_EQ(depth(Vec3(1, 1, 0)), 1.5 * std::sqrt(2.0));
  EXPECT_EQ(directional_depth({&box, aside}, {&box, Pose()}, Vec3::Zero(), scratch).error().code,
            ErrorCode::zero_direction);
  EXPECT_EQ(directional_depth({&box, aside}, {&box, Pose()}, Vec3(0, NAN, 0), scratch).error().code,
            ErrorCode::non_finite);
  const ConvexShape sphere = *ConvexShape::sphere(1);
  for (const DirectionalMethod method : {DirectionalMethod::overlay, DirectionalMethod::hierarchy}) {
    EXPECT_EQ(directional_depth({&sphere, aside}, {&box, Pose()}, Vec3::UnitX(), scratch, method).error().code,
              ErrorCode::unsupported);
  }
}

TEST(DirectionalDepth, HierarchiesAgreeOnEveryFamily) {
  scenes::Random random(29);
  Scratch scratch;
  for (int family = 0; family < scenes::kPairFamilies; ++family) {
    for (const int n : {6, 60, 120}) {
      const scenes::PointPair points =
          make_pair(static_cast<scenes::PairFamily>(family), n, scenes::DepthClass::deep, 4);
      const Bodies bodies(points.a, points.pose_a, points.b, points.pose_b);
      if (bodies.a.polytope()->affine_dimension() < 3 || bodies.b.polytope()->affine_dimension() < 3) {
        EXPECT_EQ(
            directional_depth(bodies.posed_a(), bodies.posed_b(), Vec3::UnitX(), scratch, DirectionalMethod::hierarchy)
                .error()
                .code,
            ErrorCode::not_full_dimensional);
        continue;
      }
      const PolyhedralHierarchy a = *PolyhedralHierarchy::build(*bodies.a.polytope(), HierarchyKind::inner);
      const PolyhedralHierarchy b = *PolyhedralHierarchy::build(*bodies.b.polytope(), HierarchyKind::inner);
      const DirectionalHierarchies hierarchies{&a, &b};
      for (int ray = 0; ray < 5; ++ray) {
        const Vec3 d = random.direction();
        const auto plain = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch);
        const auto found = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch,
                                             DirectionalMethod::hierarchy, &hierarchies);
        EXPECT_EQ(found->contact, plain->contact);
        EXPECT_EQ(found->lower, plain->lower) << family;
        EXPECT_EQ(found->upper, plain->upper) << family;
      }
    }
  }
}

TEST(DirectionalDepth, SweptAndSmoothBodies) {
  Scratch scratch;
  const ConvexShape ball = *ConvexShape::sphere(1), small = *ConvexShape::sphere(0.5);
  const Pose aside = *Pose::from_matrix(Mat3::Identity(), Vec3(0.3, 0.4, 0));
  // Two balls: A's centre moves from (.3, .4, 0) along d until it is 1.5 from the origin.
  scenes::Random random(30);
  for (int i = 0; i < 50; ++i) {
    const Vec3 d = random.direction();
    const Vec3 c(0.3, 0.4, 0);
    const double exact = -c.dot(d) + std::sqrt(c.dot(d) * c.dot(d) + 1.5 * 1.5 - c.squaredNorm());
    const auto found = directional_depth({&small, aside}, {&ball, Pose()}, 3 * d, scratch);
    EXPECT_LE(found->lower, exact * (1 + 1e-15));
    EXPECT_GE(found->upper, exact * (1 - 1e-15));
    EXPECT_NEAR(found->upper, found->lower, 1e-11);
  }
  // A cylinder leaves a box along its axis, and sideways.
  const ConvexShape can = *ConvexShape::cylinder(0.5, 1, 2);
  const ConvexShape box(*ConvexPolytope::box(Vec3(1, 1, 1)));
  EXPECT_NEAR(directional_depth({&can, Pose()}, {&box, Pose()}, Vec3(0, 0, 2), scratch)->depth, 2, 1e-11);
  EXPECT_NEAR(directional_depth({&can, Pose()}, {&box, Pose()}, Vec3(0, 1, 0), scratch)->depth, 1.5, 1e-11);
  EXPECT_NEAR(directional_depth({&can, Pose()}, {&box, Pose()}, Vec3::Constant(5e-324), scratch)->depth,
              directional_depth({&can, Pose()}, {&box, Pose()}, Vec3(1, 1, 1), scratch)->depth, 1e-11);
  const ConvexShape rounded = *ConvexShape(*ConvexPolytope::box(Vec3(1, 1, 1))).with_margin(0.25);
  // Rounded box against a box: along the diagonal it leaves at the corner of the sum, a ball about (2, 2, 2).
  EXPECT_NEAR(directional_depth({&rounded, Pose()}, {&box, Pose()}, Vec3(1, 1, 1), scratch)->depth,
              2 * std::sqrt(3.0) + 0.25, 1e-11);
}

TEST(DirectionalDepth, SupportsGrowSlowly) {
  std::mt19937_64 random(23);
  std::normal_distribution<double> normal;
  Scratch scratch;
  for (const int n : {8, 128, 2048}) {
    const Bodies bodies{sphere_points(n, random), random_pose(random, 0), sphere_points(n, random),
                        random_pose(random, 0.1)};
    const PenetrationDepth alone = [&] {
      DepthSettings roughly;
      roughly.delta = 1;
      return penetration_depth(bodies.posed_a(), bodies.posed_b(), scratch, roughly);
    }();
    std::int64_t most = 0;
    for (int ray = 0; ray < 100; ++ray) {
      const Vec3 d{normal(random), normal(random), normal(random)};
      const auto found = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch);
      most = std::max(most, found->statistics.support_calls - alone.statistics.support_calls);
    }
    EXPECT_LE(most, 10 + 2.5 * std::log2(n)) << n;
  }
}

// Large bodies: vertices that are only nearly extreme push the portal outwards as long as they can, and the answers are
// those of the hierarchies bit by bit.
TEST(DirectionalDepth, LargeBodiesAreClimbedOnlyNearTheBoundary) {
  scenes::Random random(77);
  const ConvexPolytope large = ConvexPolytope::from_points(scenes::sphere_hull(40'000, random)).value();
  const ConvexPolytope drum = ConvexPolytope::from_points(scenes::prism(1000)).value();
  const PolyhedralHierarchy levels_a = PolyhedralHierarchy::build(large, HierarchyKind::inner).value();
  Scratch scratch;
  for (const ConvexPolytope* q : {&large, &drum}) {
    const PolyhedralHierarchy levels_b = PolyhedralHierarchy::build(*q, HierarchyKind::inner).value();
    const DirectionalHierarchies both{&levels_a, &levels_b};
    const ConvexShape a(large), b(*q);
    const Pose moved = Pose::from_quaternion(random.quaternion(), Vec3(0.2, -0.1, 0.3)).value();
    std::int64_t supports = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3 d = i % 2 == 0 ? random.direction() : Vec3(i % 3 - 1, i % 5 - 2, 1);
      const auto found = directional_depth({&a, moved}, {&b, Pose()}, d, scratch).value();
      const auto expected =
          directional_depth({&a, moved}, {&b, Pose()}, d, scratch, DirectionalMethod::hierarchy, &both).value();
      ASSERT_EQ(found.contact, ContactClass::overlapping);
      ASSERT_EQ(found.lower, expected.lower);
      ASSERT_EQ(found.upper, expected.upper);
      ASSERT_EQ(found.normal, expected.normal);
      supports += found.statistics.support_calls;
    }
    EXPECT_LE(supports, 200 * 3);  // 23 each where every one is climbed to
  }
}

TEST(DifferenceQueries, SupportsAreExactAndLowest) {
  std::mt19937_64 random(24);
  std::uniform_int_distribution<int> coordinate(-3, 3);
  for (int round = 0; round < 300 && !HasFailure(); ++round) {
    const Bodies bodies{grid_points(random, 1 + round % 12), Pose(), grid_points(random, 1 + round % 9), Pose()};
    Vec3 d = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (d.isZero(0)) d = Vec3::UnitX();
    const auto support = support_of_difference(bodies.posed_a(), bodies.posed_b(), d);
    const ConvexPolytope& a = *bodies.a.polytope();
    const ConvexPolytope& b = *bodies.b.polytope();
    int lowest_a = 0, lowest_b = 0;
    for (int v = 0; v < a.num_vertices(); ++v) {
      if (a.vertex(v).dot(d) < a.vertex(lowest_a).dot(d)) lowest_a = v;
    }
    for (int v = 0; v < b.num_vertices(); ++v) {
      if (b.vertex(v).dot(d) > b.vertex(lowest_b).dot(d)) lowest_b = v;
    }
    EXPECT_EQ(support->vertex_a, lowest_a);
    EXPECT_EQ(support->vertex_b, lowest_b);
    EXPECT_EQ(support->value, (b.vertex(lowest_b) - a.vertex(lowest_a)).dot(d));
  }
}

TEST(DifferenceQueries, PointClassesAreExact) {
  std::mt19937_64 random(25);
  std::uniform_int_distribution<int> coordinate(-4, 4);
  Scratch scratch;
  oracle::JudgeSettings settings;
  settings.distance = false;
  int counts[3] = {0, 0, 0};
  for (int round = 0; round < 2000 && !HasFailure(); ++round) {
    // A translation whose sum with the point is no double, on half of the rounds.
    const Vec3 far = round % 2 ? Vec3(1e9 + 0.1, -3e7 + 0.3, 1e-9) : Vec3(Vec3::Zero());
    const Pose pose = *Pose::from_matrix(Mat3::Identity(), far);
    const Bodies bodies{grid_points(random, 1 + round % 9), pose, grid_points(random, 1 + round % 7), pose};
    const Vec3 x = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    const auto found = point_in_difference(bodies.posed_a(), bodies.posed_b(), x, scratch);
    const oracle::Body body_a(bodies.points_a), body_b(bodies.points_b);
    const oracle::ExactPair exact(body_a, bodies.pose_a, body_b, bodies.pose_b, x);
    ASSERT_EQ(*found, oracle::judge(exact, settings).contact) << round;
    ++counts[static_cast<int>(*found)];
  }
  for (const int count : counts) EXPECT_GT(count, 30);
  const ConvexShape sphere = *ConvexShape::sphere(1);
  EXPECT_EQ(*point_in_difference({&sphere, Pose()}, {&sphere, Pose()}, Vec3(2, 0, 0), scratch), ContactClass::touching);
  EXPECT_EQ(*point_in_difference({&sphere, Pose()}, {&sphere, Pose()}, Vec3(1.9, 0, 0), scratch),
            ContactClass::overlapping);
}

TEST(DifferenceQueries, PointsAreTakenUpToTheLargestCoordinate) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box({1, 1, 1}));
  const PosedShape posed{&box, Pose()};
  EXPECT_EQ(*point_in_difference(posed, posed, Vec3(kMaxCoordinate, 0, 0), scratch), ContactClass::separated);
  const Vec3 beyond(0, -std::nextafter(kMaxCoordinate, HUGE_VAL), 0);
  EXPECT_EQ(point_in_difference(posed, posed, beyond, scratch).error().where, "point");
  EXPECT_TRUE(line_in_difference(posed, posed, Vec3(kMaxCoordinate, 0, 0), Vec3(1, 0, 0)));
  EXPECT_EQ(line_in_difference(posed, posed, beyond, Vec3(1, 0, 0)).error().where, "point");
}

TEST(DifferenceQueries, LinesAgreeWithPointClasses) {
  std::mt19937_64 random(26);
  std::uniform_int_distribution<int> coordinate(-5, 5);
  Scratch scratch;
  int crossed = 0, missed = 0;
  for (int round = 0; round < 600 && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Bodies bodies{grid_points(random, 2 + round % 8), Pose(), grid_points(random, 4 + round % 7), Pose()};
    const Vec3 x = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    Vec3 d = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (d.isZero(0)) d = Vec3::UnitX();
    const LineCrossing line = *line_in_difference(bodies.posed_a(), bodies.posed_b(), x, d);
    const Vec3 unit = d.normalized();
    const auto contact = [&](double t) {
      return *point_in_difference(bodies.posed_a(), bodies.posed_b(), x + t * unit, scratch);
    };
    if (line.crosses) {
      ++crossed;
      EXPECT_LE(line.enter_lower, line.enter_upper);
      EXPECT_LT(line.enter_upper, line.leave_lower);
      EXPECT_LE(line.leave_lower, line.leave_upper);
      EXPECT_EQ(contact((line.enter_upper + line.leave_lower) / 2), ContactClass::overlapping);
      EXPECT_EQ(contact(line.enter_lower - 1e-9), ContactClass::separated);
      EXPECT_EQ(contact(line.enter_upper + 1e-9), ContactClass::overlapping);
      EXPECT_EQ(contact(line.leave_upper + 1e-9), ContactClass::separated);
      EXPECT_EQ(contact(line.leave_lower - 1e-9), ContactClass::overlapping);
    } else {
      ++missed;
      // Multiples that are exact: a line along the boundary must not be pushed off it.
      for (double t = -12; t <= 12; t += 0.125) {
        EXPECT_NE(*point_in_difference(bodies.posed_a(), bodies.posed_b(), x + t * d, scratch),
                  ContactClass::overlapping);
      }
    }
    // From the origin the line leaves where the ray does.
    const auto ray = directional_depth(bodies.posed_a(), bodies.posed_b(), d, scratch);
    if (ray->contact != ContactClass::overlapping) continue;
    const LineCrossing through = *line_in_difference(bodies.posed_a(), bodies.posed_b(), Vec3::Zero(), d);
    EXPECT_TRUE(through.crosses);
    EXPECT_LE(through.leave_lower, ray->upper);
    EXPECT_GE(through.leave_upper, ray->lower);
    EXPECT_LT(through.enter_upper, 0);
  }
  EXPECT_GT(crossed, 100);
  EXPECT_GT(missed, 100);
  const ConvexShape sphere = *ConvexShape::sphere(1);
  const PosedShape ball{&sphere, Pose()};
  EXPECT_EQ(line_in_difference(ball, ball, Vec3::Zero(), Vec3::UnitX()).error().code, ErrorCode::unsupported);
  EXPECT_EQ(line_in_difference(ball, ball, Vec3::Zero(), Vec3::Zero()).error().code, ErrorCode::zero_direction);
}

// A face is a loop that is stored, however many corners it has: 200,000 of them looked for one by one took seconds.
TEST(DirectionalDepth, FacesOfThousandsOfCorners) {
  const ConvexShape drum(*ConvexPolytope::from_points(scenes::prism(20'000)));
  const Pose above = Pose::from_trusted_matrix(Mat3::Identity(), Vec3(0.25, 0.125, 0.5));
  Scratch scratch;
  const auto found = directional_depth({&drum, Pose()}, {&drum, above}, Vec3::UnitZ(), scratch);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->contact, ContactClass::overlapping);
  EXPECT_LE(found->lower, 1.5);
  EXPECT_GE(found->upper, 1.5);
  EXPECT_LE(found->upper - found->lower, 0x1p-51);
  EXPECT_EQ(found->feature_b.kind, Feature::Kind::facet);
  EXPECT_EQ(found->normal, Vec3::UnitZ());
  // By hierarchies, too, whose growth with the corners `pdepth-bench dobkin --chapters hierarchy --families prisms`
  // shows.
  const PolyhedralHierarchy levels = PolyhedralHierarchy::build(*drum.polytope(), HierarchyKind::inner).value();
  const DirectionalHierarchies both{&levels, &levels};
  const auto descended =
      directional_depth({&drum, Pose()}, {&drum, above}, Vec3::UnitZ(), scratch, DirectionalMethod::hierarchy, &both);
  ASSERT_TRUE(descended.has_value());
  EXPECT_EQ(descended->lower, found->lower);
  EXPECT_EQ(descended->upper, found->upper);
  EXPECT_EQ(descended->normal, found->normal);
  EXPECT_EQ(descended->feature_b.kind, Feature::Kind::facet);
}

TEST(DirectionalDepth, BracketsOfCurvedBodiesAreNarrowAlongPlanesOfSymmetryToo) {
  const std::vector<ConvexShape> shapes = {*ConvexShape::ellipsoid(Vec3(1, 2, 3)),
                                           *ConvexShape::ellipsoid(Vec3::Ones()),
                                           *ConvexShape::cylinder(1, 2, 2),
                                           *ConvexShape::cone(1, 1, 1),
                                           *ConvexShape::capsule(0.5, 1, 0),
                                           *ConvexShape(*ConvexPolytope::box(Vec3(1, 0.01, 1))).with_margin(0.1),
                                           ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()}))};
  const std::vector<Vec3> directions = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(),   Vec3::UnitZ(),
                                        -Vec3::UnitZ(), Vec3(1, 1, 0),  Vec3(1, 1, 1), Vec3(1e-9, 0, 1), Vec3(1, 2, 3)};
  Scratch scratch;
  int overlapping = 0;
  for (const ConvexShape& a : shapes) {
    for (const ConvexShape& b : shapes) {
      for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(0.5, 0.1, 0.2)}) {
        for (const Vec3& direction : directions) {
          const auto found = directional_depth({&a, Pose()}, {&b, Pose::from_trusted_matrix(Mat3::Identity(), offset)},
                                               direction, scratch);
          if (found->contact != ContactClass::overlapping) continue;
          ++overlapping;
          EXPECT_LE(found->lower, found->depth);
          EXPECT_LE(found->depth, found->upper);
          EXPECT_LE(found->upper, (1 + 1e-8) * found->lower) << direction.transpose();
        }
      }
    }
  }
  EXPECT_GT(overlapping, 500);
  // Known ones: ellipsoids' radii add up along their axes.
  const auto along_z = directional_depth({&shapes[0], Pose()}, {&shapes[0], Pose()}, Vec3::UnitZ(), scratch);
  EXPECT_LE(along_z->lower, 6);
  EXPECT_GE(along_z->upper, 6);
}

}  // namespace
}  // namespace pd
