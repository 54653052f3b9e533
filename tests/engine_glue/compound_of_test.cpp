/// @file
/// Unions of convex parts as compounds of Bullet: the parts' own numbers, their mass, and what is refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pd/bullet/compound.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/solid/convex_decomposition.hpp"

namespace pd::test {
namespace {

/// A prism along z over a polygon, from z = 0 to 1, as a solid.
MeshSolid prism(const std::vector<std::array<double, 2>>& base) {
  const auto n = static_cast<std::int32_t>(base.size());
  std::vector<Vec3> points;
  std::vector<std::int32_t> offsets{0}, corners;
  for (const double z : {0.0, 1.0}) {
    for (const auto& p : base) points.emplace_back(p[0], p[1], z);
  }
  const auto close = [&] { offsets.push_back(static_cast<std::int32_t>(corners.size())); };
  for (std::int32_t i = n; i-- > 0;) corners.push_back(i);
  close();
  for (std::int32_t i = 0; i < n; ++i) corners.push_back(n + i);
  close();
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t next = (i + 1) % n;
    corners.insert(corners.end(), {i, next, n + next, n + i});
    close();
  }
  return *MeshSolid::from_faces(MeshView{points, offsets, corners});
}

Compound boxes(const std::vector<std::pair<Vec3, Vec3>>& halves_and_places) {
  std::vector<Compound::Part> parts;
  for (const auto& [half, place] : halves_and_places) {
    parts.push_back({ConvexShape(*ConvexPolytope::box(half)), *Pose::from_matrix(Mat3::Identity(), place)});
  }
  return *Compound::from_parts(std::move(parts));
}

TEST(CompoundOf, ADecomposedSolidKeepsItsPartsAndItsMass) {
  // An L of three unit squares: its centre of mass is that of the squares.
  const MeshSolid solid = prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  const auto found = decompose(solid, {.error = 1e-6});
  ASSERT_TRUE(found && found->error_reached);
  ASSERT_EQ(found->parts.parts().size(), 2U);
  const auto made = compound_of(found->parts, {.margin = 0.25});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(made->volume, 3, 1e-14);
  EXPECT_TRUE(made->centre_of_mass.isApprox(Vec3(5.0 / 6, 5.0 / 6, 0.5), 1e-14)) << made->centre_of_mass;
  EXPECT_EQ(made->rounding, 0) << "whole numbers are floats";
  ASSERT_EQ(made->shape->getNumChildShapes(), 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(made->shape->getChildShape(i), made->children[static_cast<std::size_t>(i)].get());
    EXPECT_EQ(to_pd(made->shape->getChildTransform(i).getOrigin()), Vec3(-made->origin));
    const auto body = to_convex_shape(*made->children[static_cast<std::size_t>(i)]);
    ASSERT_TRUE(body);
    EXPECT_EQ(body->margin(), 0.25);
    const ConvexPolytope& part = *found->parts.parts()[static_cast<std::size_t>(i)].shape.polytope();
    ASSERT_EQ(body->polytope()->num_vertices(), part.num_vertices());
    for (int v = 0; v < part.num_vertices(); ++v) EXPECT_EQ(body->polytope()->vertex(v), part.vertex(v));
  }
  const auto unmoved = compound_of(found->parts, {.at_centre_of_mass = false});
  ASSERT_TRUE(unmoved);
  EXPECT_EQ(unmoved->origin, Vec3::Zero());
  EXPECT_EQ(unmoved->children[0]->getMargin(), btScalar(0));
  EXPECT_NEAR(unmoved->centre_of_mass.x(), 5.0 / 6, 1e-14);
}

TEST(CompoundOf, InertiaIsThatOfTheBoxAlsoFarFromTheOrigin) {
  // Two halves of a box with half extents 1, 2, 3, each turned by nothing, 1e6 away.
  for (const double far : {0.0, 1e6}) {
    const auto made =
        compound_of(boxes({{Vec3(0.5, 2, 3), Vec3(far - 0.5, 0, 0)}, {Vec3(0.5, 2, 3), Vec3(far + 0.5, 0, 0)}}));
    ASSERT_TRUE(made);
    EXPECT_TRUE(made->centre_of_mass.isApprox(Vec3(far, 0, 0), 1e-14) || far == 0) << made->centre_of_mass;
    const Mat3 expected = Vec3(13.0 / 3, 10.0 / 3, 5.0 / 3).asDiagonal();
    EXPECT_TRUE(made->inertia.isApprox(expected, 1e-12)) << made->inertia;
  }
}

TEST(CompoundOf, RoundingIsToldAndPartsWithoutFormAreRefused) {
  const auto tenth = compound_of(boxes({{Vec3(0.1, 0.1, 0.1), Vec3(0, 0, 0)}}));
  ASSERT_TRUE(tenth);
  const double moved = std::abs(static_cast<double>(static_cast<btScalar>(0.1)) - 0.1) * std::sqrt(3);
  EXPECT_NEAR(tenth->rounding, moved, 1e-20);

  const auto expect_refused = [](const Expected<BulletCompound>& made, ErrorCode code, const char* where) {
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, code) << made.error().message;
    EXPECT_EQ(made.error().where, where);
  };
  const ConvexShape box(*ConvexPolytope::box({1, 1, 1}));
  const auto with = [&](ConvexShape second) {
    return *Compound::from_parts({{box, Pose()}, {std::move(second), Pose()}});
  };
  expect_refused(compound_of(with(*ConvexShape::cone(1, 1, 2))), ErrorCode::unsupported, "parts[1]");
  // A sphere is a point with a margin.
  expect_refused(compound_of(with(*ConvexShape::sphere(1))), ErrorCode::not_full_dimensional, "parts[1]");
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  expect_refused(compound_of(with(ConvexShape(*ConvexPolytope::from_points(square)))), ErrorCode::not_full_dimensional,
                 "parts[1]");
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_refused(compound_of(Compound(box), {.margin = bad}), ErrorCode::bad_value, "margin");
  }
  const ConvexShape huge(*ConvexPolytope::box({1e150, 1e150, 1e150}));
  expect_refused(compound_of(Compound(huge)), ErrorCode::out_of_range, "parts[0]");
}

}  // namespace
}  // namespace pd::test
