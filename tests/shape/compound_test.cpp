/// @file
/// Compounds: where parts stand after their poses were composed, and what is exact about it; star-shaped bodies: what
/// is accepted and what is refused.
#include "pd/shape/compound.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace pd {
namespace {

ConvexShape box(const Vec3& half_extents) { return *ConvexPolytope::box(half_extents); }

Pose translated(const Vec3& t) { return *Pose::from_matrix(Mat3::Identity(), t); }

TEST(Compound, UnderTheIdentityPartsStandAsGiven) {
  scenes::Random random(2);
  const Pose turned = random.pose({0.1, 0.2, 0.3});
  const Compound compound = *Compound::from_parts({{box({1, 1, 1}), turned}, {box({1, 2, 1}), translated({3, 0, 0})}});
  const std::vector<PosedShape> parts = *compound.posed(Pose());
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].pose, turned);
  // A translation that the vertices take exactly is theirs: no pose is left to be composed.
  EXPECT_EQ(parts[1].pose, Pose());
  EXPECT_EQ(parts[1].shape->polytope()->vertex(0), Vec3(2, -2, -1));
  EXPECT_EQ(parts[1].shape->polytope()->vertex(7), Vec3(4, 2, 1));
}

TEST(Compound, AStackOfBoxesStaysOneWhenItIsTurned) {
  scenes::Random random(3);
  std::vector<Compound::Part> list;
  for (const scenes::PointPart& part : scenes::stack(4, 0.5)) {
    list.push_back({*ConvexPolytope::from_points(part.points), part.pose});
  }
  const Compound stack = *Compound::from_parts(list);
  const Pose turned = random.pose({0.3, 0.7, -0.9});
  const std::vector<PosedShape> parts = *stack.posed(turned);
  for (const PosedShape& part : parts) {
    EXPECT_EQ(part.pose, turned);  // one exact pose for all: faces that were common stay common
  }
}

TEST(Compound, ComposedPosesAreTheProductRoundedOnce) {
  scenes::Random random(4);
  for (int k = 0; k < 50; ++k) {
    const Pose outer = random.pose(random.direction());
    const Pose inner = random.pose(random.direction());
    const Pose both = *composed(outer, inner);
    const Vec3 x = random.direction();
    EXPECT_LT((both.apply(x) - outer.apply(inner.apply(x))).norm(), 2e-15);
    EXPECT_EQ(composed(outer, Pose())->translation(), outer.translation());
    EXPECT_EQ(composed(Pose(), inner)->quaternion_wxyz(), inner.quaternion_wxyz());
  }
  EXPECT_EQ(composed(translated({1e300, 0, 0}), translated({1e300, 0, 0})).error().code, ErrorCode::out_of_range);
}

TEST(Compound, NestingComposesAndMarginsAdd) {
  const Compound inner = *Compound::from_parts({{box({1, 1, 1}), translated({1, 0, 0})}});
  const std::array<Compound::Placed, 2> bodies{Compound::Placed{inner, translated({0, 2, 0})},
                                               Compound::Placed{box({1, 1, 1}), Pose()}};
  const Compound outer = *Compound::from_compounds(bodies);
  ASSERT_EQ(outer.parts().size(), 2u);
  EXPECT_EQ(outer.parts()[0].shape.polytope()->vertex(0), Vec3(0, 1, -1));
  const Compound swept = *outer.with_margin(0.5)->with_margin(0.25);
  for (const Compound::Part& part : swept.parts()) EXPECT_EQ(part.shape.margin(), 0.75);
  EXPECT_EQ(outer.with_margin(-1).error().code, ErrorCode::bad_value);
  EXPECT_EQ(Compound::from_parts({}).error().where, "parts");
}

TEST(StarBody, FamiliesAreStars) {
  scenes::Random random(5);
  for (const scenes::Surface& surface :
       {scenes::spiked_star(2), scenes::rough_ball(0, 0.5, random), scenes::rough_ball(2, 0.25, random)}) {
    const auto star = StarBody::from_faces(surface.vertices, surface.faces, surface.centre);
    ASSERT_TRUE(star.has_value()) << star.error().where << ": " << star.error().message;
    const Compound parts = star->tetrahedra();
    ASSERT_EQ(parts.parts().size(), surface.faces.size());
    for (const Compound::Part& part : parts.parts()) EXPECT_EQ(part.shape.polytope()->num_facets(), 4);
  }
}

TEST(StarBody, ASurfaceThatRunsRoundTwiceIsNone) {
  scenes::Surface once = scenes::spiked_star(1), twice = once;
  const auto n = static_cast<std::int32_t>(once.vertices.size());
  for (const Vec3& v : once.vertices) twice.vertices.push_back(2 * v);
  for (const auto& f : once.faces) twice.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  const auto star = StarBody::from_faces(twice.vertices, twice.faces, Vec3::Zero());
  ASSERT_FALSE(star.has_value());
  EXPECT_EQ(star.error().code, ErrorCode::bad_faces);
  EXPECT_EQ(star.error().where, "faces");
  EXPECT_NE(star.error().message.find("2 faces"), std::string::npos) << star.error().message;
}

TEST(StarBody, WhatIsWrongIsNamed) {
  const scenes::Surface good = scenes::spiked_star(1);
  const auto refused = [](const scenes::Surface& s) {
    const auto star = StarBody::from_faces(s.vertices, s.faces, s.centre);
    return star ? std::string() : std::string(to_string(star.error().code)) + " " + star.error().where;
  };
  EXPECT_EQ(refused(good), "");
  scenes::Surface s = good;
  s.faces.pop_back();
  EXPECT_TRUE(refused(s).starts_with("not_closed faces[")) << refused(s);
  s = good;
  std::swap(s.faces[2][0], s.faces[2][1]);
  EXPECT_EQ(refused(s), "bad_faces faces[2]");
  s = good;
  s.centre = {1.5, 1.5, 0};
  EXPECT_TRUE(refused(s).starts_with("bad_faces faces[")) << refused(s);
  s = good;
  s.vertices[3].y() = std::nan("");
  EXPECT_EQ(refused(s), "non_finite vertices[3]");
  s = good;
  s.faces[5][1] = 99;
  EXPECT_EQ(refused(s), "bad_faces faces[5]");
}

}  // namespace
}  // namespace pd
