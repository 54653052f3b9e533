/// @file
/// Every column on pairs whose answer is known by hand, and the laws that hold for all pairs.
#include <cmath>
#include <string>

#include "audit/body_extent.hpp"
#include "audit/exact_depth.hpp"
#include "audit/surface_distance.hpp"
#include "pd/depth/difference_queries.hpp"
#include "protocol/line/json_writer.hpp"
#include "record_text.hpp"
#include "scenes/shape_families.hpp"

namespace pd::test {
namespace {

using audit::Column;

constexpr const char* kCube = R"({"type":"box","half_extents":[1,1,1]})";

/// Two cubes of side 2, B moved by x: L = 2 + x.
audit::Judgement cubes(const std::string& x, const std::string& reported) {
  const Audited audited = audit_text(RecordText()
                                         .shape("s", kCube)
                                         .contact("s", "s", R"(,"pose_b":{"translation":[)" + x + ",0,0]}", reported)
                                         .text());
  EXPECT_EQ(audited.judgements.size(), 1U);
  return audited.judgements.empty() ? audit::Judgement() : audited.judgements.front();
}

TEST(Judge, WhatIsRightHasNoError) {
  const auto judged = cubes("1.5", R"({"depth":0.5,"normal":[-2,0,0],"points":[{"position_a":[1,0.25,0],
      "position_b":[0.5,0.25,0],"depth":0.5}]})");
  EXPECT_TRUE(judged.answered);
  EXPECT_FALSE(judged.missed || judged.phantom);
  EXPECT_EQ(judged.scale, 3.5);
  EXPECT_LE(judged.lower, 0.5);
  EXPECT_GE(judged.upper, 0.5);
  EXPECT_EQ(judged.depth_error, 0.0);
  EXPECT_NEAR(*judged.normal_excess, 0, 1e-15);
  EXPECT_EQ(judged.point_error, 0.0);
}

TEST(Judge, DepthErrorIsSignedAndInThreeUnits) {
  const auto judged = cubes("1.5", R"({"depth":0.375})");
  EXPECT_NEAR(*judged.depth_error, -0.125 / 3.5, 1e-14);
  EXPECT_NEAR(*judged.depth_error_of_smaller, -0.125 / 2, 1e-14);
  EXPECT_NEAR(*judged.depth_error_absolute, -0.125, 1e-14);
  EXPECT_FALSE(judged.normal_excess.has_value());
  EXPECT_FALSE(judged.point_error.has_value());
  EXPECT_NEAR(*cubes("1.5", R"({"depth":0.75})").depth_error, 0.25 / 3.5, 1e-14);
}

TEST(Judge, MissedIsNothingOrAGapWhereBodiesOverlap) {
  EXPECT_TRUE(cubes("1.5", "null").missed);
  EXPECT_FALSE(cubes("1.5", "null").depth_error.has_value());
  EXPECT_TRUE(cubes("1.5", R"({"depth":0})").missed);
  EXPECT_TRUE(cubes("1.5", R"({"depth":-0.1})").missed);
  EXPECT_FALSE(cubes("1.5", R"({"depth":1e-9})").missed) << "it saw the contact, wrong as its depth is";
  EXPECT_FALSE(cubes("1.9999999999999998", "null").missed) << "within the tolerance";
  EXPECT_FALSE(cubes("2", "null").missed);
  EXPECT_FALSE(cubes("2.5", "null").missed);
}

TEST(Judge, PhantomIsADepthWhereBodiesAreApart) {
  const auto judged = cubes("3", R"({"depth":0.25,"normal":[-1,0,0]})");
  EXPECT_TRUE(judged.phantom);
  EXPECT_NEAR(*judged.depth_error, 1.25 / 5, 1e-14);
  EXPECT_FALSE(judged.normal_excess.has_value()) << "only for overlapping bodies";
  EXPECT_FALSE(cubes("3", R"({"depth":-1})").phantom);
  EXPECT_NEAR(*cubes("3", R"({"depth":-1})").depth_error, 0, 1e-15);
  EXPECT_FALSE(cubes("2.0000000000000004", R"({"depth":1e-15})").phantom) << "within the tolerance";
}

TEST(Judge, NormalExcessIsTheDetour) {
  EXPECT_NEAR(*cubes("1.5", R"({"depth":0.5,"normal":[0,1,0]})").normal_excess, 1.5 / 3.5, 1e-14);
  EXPECT_NEAR(*cubes("1.5", R"({"depth":0.5,"normal":[1,0,0]})").normal_excess, 3.0 / 3.5, 1e-14) << "the wrong way";
  // Along (-3, 4, 0) / 5: h_P = 2 * 3/5 + 2 * 4/5 - 1.5 * 3/5.
  EXPECT_NEAR(*cubes("1.5", R"({"depth":0.5,"normal":[-3,4,0]})").normal_excess, (1.9 - 0.5) / 3.5, 1e-14);
}

TEST(Judge, PointErrorIsTheWayToTheSurface) {
  const auto error = [](const std::string& point) {
    return *cubes("1.5", R"({"depth":0.5,"points":[{)" + point + "}]}").point_error * 3.5;
  };
  EXPECT_NEAR(error(R"("position_a":[1.25,0,0])"), 0.25, 1e-15) << "outside";
  EXPECT_NEAR(error(R"("position_a":[0.25,0.5,0])"), 0.5, 1e-15) << "inside";
  EXPECT_NEAR(error(R"("position_a":[1.25,1.25,1.5])"), std::sqrt(0.375), 1e-15) << "beyond a corner";
  EXPECT_NEAR(error(R"("position_a":[1,0,0],"position_b":[0,0,0])"), 0.5, 1e-15) << "the farther of the two";
}

TEST(Judge, RoundedAndCurvedBodies) {
  const Audited audited = audit_text(
      RecordText()
          .shape("ball", R"({"type":"sphere","radius":1})")
          .shape("rod", R"({"type":"cylinder","radius":0.5,"half_height":2,"axis":"z"})")
          .shape("soft", R"({"type":"box","half_extents":[1,1,1],"margin":0.5})")
          .contact("ball", "ball", R"(,"pose_b":{"translation":[0,1.5,0]})",
                   R"({"depth":0.5,"normal":[0,-1,0],"points":[{"position_a":[0,1.25,0]}]})")
          .contact("ball", "rod", R"(,"pose_a":{"translation":[1.25,0,0]})",
                   R"({"depth":0.25,"normal":[1,0,0],"points":[{"position_a":[0.25,0,0],"position_b":[0.5,0,0]}]})")
          .contact(
              "soft", "ball", R"(,"pose_b":{"translation":[2.25,0,0]})",
              R"({"depth":0.25,"normal":[-1,0,0],"points":[{"position_a":[1.5,0.5,0.5],"position_b":[1.25,0,0]}]})")
          .text(),
      {.tolerance = 1e-9});
  ASSERT_EQ(audited.judgements.size(), 3U);
  EXPECT_NEAR(*audited.judgements[0].point_error, 0.25 / 3.5, 1e-14);
  EXPECT_EQ(audited.judgements[0].depth_error, 0.0);
  for (const int i : {1, 2}) {
    const audit::Judgement& judged = audited.judgements[static_cast<std::size_t>(i)];
    EXPECT_TRUE(judged.answered) << i;
    EXPECT_NEAR(*judged.depth_error, 0, 1e-10) << i;
    EXPECT_NEAR(*judged.normal_excess, 0, 1e-10) << i;
    EXPECT_NEAR(*judged.point_error, 0, 1e-10) << i;
  }
}

TEST(Judge, HalfSpaces) {
  RecordText record;
  record.shape("cube", kCube).shape("floor", R"({"type":"plane","normal":[0,3,0],"offset":6})");
  // The floor's surface is y = 2, a cube at y = 2.75 is 0.25 deep; seen from the plane it reaches to 1.75.
  const std::string above = R"(,"pose_a":{"translation":[100,2.75,7]})";
  record.contact("cube", "floor", above, R"({"depth":0.25,"normal":[0,1,0],"points":[{"position_b":[9,2.5,9]}]})");
  record.contact("cube", "floor", above, R"({"depth":0.25,"normal":[0,3,4]})");
  record.contact("cube", "floor", above, R"({"depth":0.25,"normal":[0,-1,0]})");
  record.contact("cube", "floor", above, "null");
  record.contact("floor", "cube", R"(,"pose_b":{"translation":[100,2.75,7]})", R"({"depth":0.5,"normal":[0,-1,0]})");
  // Turned so that its normal is x: the cube is 0.5 away.
  record.contact("cube", "floor",
                 R"(,"pose_a":{"translation":[3.5,5,5]},"pose_b":{"rotation_row_major":[0,1,0,-1,0,0,0,0,1]})",
                 R"({"depth":0.1})");
  const Audited audited = audit_text(record.text());
  ASSERT_EQ(audited.judgements.size(), 6U);
  const auto& judged = audited.judgements;
  for (const audit::Judgement& one : judged) EXPECT_TRUE(one.answered);
  EXPECT_NEAR(judged[0].scale, 1.75, 1e-12);
  EXPECT_NEAR(*judged[0].depth_error, 0, 1e-14);
  EXPECT_NEAR(*judged[0].normal_excess, 0, 1e-14);
  EXPECT_NEAR(*judged[0].point_error, 0.5 / 1.75, 1e-12);
  EXPECT_NEAR(*judged[1].normal_excess, (0.25 / 0.6 - 0.25) / 1.75, 1e-12);
  EXPECT_EQ(*judged[2].normal_excess, audit::kNoWayOut);
  EXPECT_TRUE(judged[3].missed);
  EXPECT_NEAR(*judged[4].depth_error_absolute, 0.25, 1e-12);
  EXPECT_NEAR(*judged[4].depth_error_of_smaller, 0.125, 1e-12);
  EXPECT_NEAR(*judged[4].normal_excess, 0, 1e-14);
  EXPECT_TRUE(judged[5].phantom);
  EXPECT_NEAR(*judged[5].depth_error_absolute, 0.6, 1e-12);
}

TEST(Judge, Unions) {
  const Audited audited = audit_text(
      RecordText()
          .shape("cube", kCube)
          .shape("pair", R"({"type":"compound","parts":[{"shape":{"type":"box","half_extents":[1,1,1]}},
              {"shape":{"type":"box","half_extents":[1,1,1]},"pose":{"translation":[4,0,0]}}]})")
          .contact("pair", "cube", R"(,"pose_b":{"translation":[5.5,0,0]})",
                   R"({"depth":0.5,"normal":[-1,0,0],"points":[{"position_a":[5,0,0],"position_b":[4.75,0,0]}]})")
          .contact("cube", "pair", R"(,"pose_a":{"translation":[2,0,3]})", R"({"depth":-1})")
          .text());
  ASSERT_EQ(audited.judgements.size(), 2U);
  EXPECT_EQ(audited.judgements[0].scale, 7.5);
  EXPECT_NEAR(*audited.judgements[0].depth_error, 0, 1e-14);
  EXPECT_NEAR(*audited.judgements[0].point_error, 0.25 / 7.5, 1e-13);
  EXPECT_TRUE(audited.judgements[1].answered);
  EXPECT_NEAR(*audited.judgements[1].depth_error, 0, 1e-14);
}

std::string points_json(const scenes::Points& points) {
  std::string text = R"({"type":"convex","vertices":[)";
  for (std::size_t i = 0; i < points.size(); ++i) {
    text += i == 0 ? "[" : ",[";
    for (int k = 0; k < 3; ++k) {
      if (k > 0) text += ",";
      query::append_number(text, points[i][k]);
    }
    text += "]";
  }
  return text + "]}";
}

audit::RecordedShape recorded(const scenes::Points& points) {
  const query::Json json = query::Json::parse(points_json(points));
  return audit::read_recorded_shape(query::Node(json), {});
}

// The exact answer itself passes on every family, and each fault is measured as large as it was made.
TEST(Judge, ExactReportsPassAndFaultsAreMeasured) {
  Scratch scratch;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      const auto family = static_cast<scenes::PairFamily>(f);
      const auto pair = scenes::make_pair(family, 16, static_cast<scenes::DepthClass>(d), 77U + f);
      const audit::RecordedShape a = recorded(pair.a);
      const audit::RecordedShape b = recorded(pair.b);
      audit::RecordedContact contact{"1", &a, &b, pair.pose_a, pair.pose_b, {}};
      const PenetrationDepth exact = *audit::body_depth(contact, 1e-6, scratch);
      audit::Report report{-exact.signed_distance(), exact.normal, {}};
      report.points.push_back({exact.witness_a, exact.witness_b});
      contact.report = report;
      const audit::Judgement right = audit::judge(contact, 1e-12, scratch);
      SCOPED_TRACE(std::string(to_string(family)) + " " + std::to_string(d));
      ASSERT_TRUE(right.answered);
      EXPECT_FALSE(right.missed || right.phantom);
      EXPECT_LE(std::abs(*right.depth_error), 1e-14);
      EXPECT_NEAR(right.normal_excess.value_or(0), 0, 1e-13);
      // Witnesses are rounded where the bodies stand.
      const double far = std::max(exact.witness_a.norm(), exact.witness_b.norm()) / right.scale;
      EXPECT_LE(*right.point_error, 1e-13 + 1e-15 * far);

      const double fault = 0.01 * right.scale;
      contact.report->depth += fault;
      EXPECT_NEAR(*audit::judge(contact, 1e-12, scratch).depth_error, 0.01, 1e-13 + 1e-16 * far);

      std::swap(contact.a, contact.b);
      std::swap(contact.pose_a, contact.pose_b);
      contact.report->normal = -exact.normal;
      const audit::Judgement swapped = audit::judge(contact, 1e-12, scratch);
      EXPECT_NEAR(swapped.scale, right.scale, (1e-14 + 1e-15 * far) * right.scale);
      EXPECT_NEAR(*swapped.depth_error, 0.01, 1e-13 + 1e-16 * far);
      EXPECT_EQ(swapped.normal_excess.has_value(), right.normal_excess.has_value());
    }
  }
}

// Two ways to the same length: facet by facet here, the library's depth of a point there.
TEST(Judge, SurfaceDistanceAgreesWithTheDepthOfAPoint) {
  scenes::Random random(5);
  Scratch scratch;
  const audit::RecordedShape point = recorded({Vec3::Zero()});
  const std::vector<scenes::Points> bodies{scenes::sphere_hull(24, random),
                                           scenes::needle(12, random),
                                           scenes::prism(10),
                                           scenes::polygon(7, random),
                                           {Vec3(0, 0, 0), Vec3(1, 2, 3)}};
  for (const scenes::Points& points : bodies) {
    const audit::RecordedShape body = recorded(points);
    const Pose pose = random.pose(3 * random.direction());
    for (int i = 0; i < 40; ++i) {
      const Vec3 at = pose.apply(random.vector(0, 1.5));
      const audit::RecordedContact contact{"1", &point, &body, *Pose::from_matrix(Mat3::Identity(), at), pose, {}};
      const double expected = std::abs(audit::body_depth(contact, 0.1, scratch)->signed_distance());
      EXPECT_NEAR(audit::surface_distance(body, pose, at, 1e-9, scratch), expected, 4e-15);
    }
  }
}

// L against the supports of P along the axes, and the extent of a body against its own width.
TEST(Judge, ScaleIsTheLargestCoordinateOfTheDifference) {
  scenes::Random random(9);
  for (int i = 0; i < 20; ++i) {
    const audit::RecordedShape a = recorded(scenes::sphere_hull(12, random));
    const audit::RecordedShape b = recorded(scenes::needle(9, random));
    const Pose pose_a = random.pose(random.direction());
    const Pose pose_b = random.pose(random.direction());
    double most = 0;
    for (int k = 0; k < 6; ++k) {
      const Vec3 axis = (k < 3 ? 1.0 : -1.0) * Vec3::Unit(k % 3);
      most = std::max(most, support_of_difference({&a.convex(), pose_a}, {&b.convex(), pose_b}, axis)->value);
    }
    EXPECT_NEAR(audit::contact_scale({"1", &a, &b, pose_a, pose_b, {}}), most, 1e-14);
  }
}

}  // namespace
}  // namespace pd::test
