/// @file
/// Queries that C++ has no single call for, by values that are known: apart, supports, half-spaces, features, pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "c_interface/c_library.hpp"

namespace pd::c_test {
namespace {

class CQueries : public testing::Test {
 protected:
  int apart(double distance) {
    std::int32_t result = -1;
    EXPECT_EQ(pdepth_apart(context_.get(), &question_, distance, &result), PDEPTH_OK) << error_of(context_);
    return result;
  }

  pdepth_support_answer support(const pdepth_shape* shape, const pdepth_pose* pose, const std::array<double, 3>& d) {
    auto answer = sized<pdepth_support_answer>();
    EXPECT_EQ(pdepth_support(context_.get(), shape, pose, d.data(), &answer), PDEPTH_OK) << error_of(context_);
    return answer;
  }

  const std::array<double, 3> half_{0.5, 0.5, 0.5};
  Context context_ = make_context();
  Shape cube_ = make_shape(context_, &pdepth_box, half_.data());
  pdepth_question question_ = question_of(cube_.get(), cube_.get());
};

TEST_F(CQueries, ApartIsCertified) {
  EXPECT_EQ(apart(0), 0);
  question_.pose_b.numbers[0] = 1;
  EXPECT_EQ(apart(0), 0);
  question_.pose_b.numbers[0] = 1.5;
  EXPECT_EQ(apart(0), 1);
  EXPECT_EQ(apart(0.4375), 1);
  EXPECT_EQ(apart(0.5), 0);
  EXPECT_EQ(apart(0.75), 0);
  const pdepth_part part{cube_.get(), {}};
  const Shape whole = make_shape(context_, &pdepth_compound, &part, 1);
  question_.a = whole.get();
  EXPECT_EQ(apart(0.4375), 1);
  EXPECT_EQ(apart(0.75), 0);
}

TEST_F(CQueries, SupportsOfEveryKind) {
  const pdepth_pose aside{PDEPTH_POSE_TRANSLATION, 0, {10, 0, 0}};
  const pdepth_support_answer corner = support(cube_.get(), &aside, {2, 0, 0});
  EXPECT_EQ(corner.value, 21);
  EXPECT_EQ(corner.point[0], 10.5);
  const Shape swept = make_shape(context_, &pdepth_with_margin, cube_.get(), 0.25);
  EXPECT_EQ(support(swept.get(), nullptr, {0, 0, -1}).point[2], -0.75);
  // A curved body whose squares no double holds.
  const std::array<double, 3> radii{1e200, 2e200, 1e200};
  const Shape huge = make_shape(context_, &pdepth_ellipsoid, radii.data());
  const pdepth_support_answer far = support(huge.get(), nullptr, {0, 1, 0});
  EXPECT_DOUBLE_EQ(far.value, 2e200);
  EXPECT_DOUBLE_EQ(far.point[1], 2e200);
  EXPECT_EQ(far.vertex, -1);
  const std::array<pdepth_part, 2> parts{pdepth_part{cube_.get(), {}}, pdepth_part{swept.get(), aside}};
  const Shape whole = make_shape(context_, &pdepth_compound, parts.data(), 2);
  EXPECT_EQ(support(whole.get(), nullptr, {1, 0, 0}).part, 1);
  EXPECT_EQ(support(whole.get(), nullptr, {1, 0, 0}).value, 10.75);
  EXPECT_EQ(support(whole.get(), nullptr, {-1, 0, 0}).part, 0);
}

TEST_F(CQueries, HalfspacesAreTheirSolid) {
  const std::array<double, 24> planes{1, 0,  0, 0.5, -1, 0, 0, 0.5, 0, 2, 0,  1,
                                      0, -1, 0, 0.5, 0,  0, 1, 0.5, 0, 0, -1, 0.5};
  const Shape solid = make_shape(context_, &pdepth_halfspaces, planes.data(), 6);
  auto info = sized<pdepth_shape_info>();
  ASSERT_EQ(pdepth_shape_describe(context_.get(), solid.get(), 0, &info), PDEPTH_OK);
  EXPECT_EQ(info.vertices, 8);
  EXPECT_EQ(info.facets, 6);
  EXPECT_EQ(info.is_convex, 1);
  EXPECT_EQ(info.parts, 1);
  question_.a = solid.get();
  question_.pose_b.numbers[1] = 0.75;
  auto answer = sized<pdepth_answer>();
  ASSERT_EQ(pdepth_depth(context_.get(), &question_, &answer), PDEPTH_OK);
  EXPECT_EQ(answer.depth, 0.25);
}

/// Facets of a solid turn counter-clockwise about their outward normals and share each edge with one other facet.
TEST_F(CQueries, SurfacesAreClosed) {
  const std::array<double, 12> points{0, 0, 1, 1, 0, 0, 0, 1, 0, -1, -1, 0};
  const Shape hull = make_shape(context_, &pdepth_convex_hull, points.data(), 4);
  const std::array<pdepth_part, 2> parts{pdepth_part{hull.get(), {}}, pdepth_part{cube_.get(), {0, 0, {0, 0, 3}}}};
  const Shape whole = make_shape(context_, &pdepth_compound, parts.data(), 2);
  auto info = sized<pdepth_shape_info>();
  ASSERT_EQ(pdepth_shape_describe(context_.get(), whole.get(), 1, &info), PDEPTH_OK);
  std::vector<double> room(3 * static_cast<std::size_t>(info.vertices));
  std::vector<std::int32_t> offsets(static_cast<std::size_t>(info.facets) + 1);
  std::vector<std::int32_t> corners(2 * static_cast<std::size_t>(info.vertices + info.facets - 2));
  auto surface = sized<pdepth_surface>();
  surface.points = room.data();
  surface.offsets = offsets.data();
  surface.corners = corners.data();
  ASSERT_EQ(pdepth_shape_surface(context_.get(), whole.get(), 1, &surface), PDEPTH_OK) << error_of(context_);
  EXPECT_EQ(offsets.front(), 0);
  EXPECT_EQ(offsets.back(), static_cast<std::int32_t>(corners.size()));
  double least = HUGE_VAL;
  for (std::size_t v = 2; v < room.size(); v += 3) least = std::min(least, room[v]);
  EXPECT_EQ(least, 2.5) << "points stand in the frame of the compound";
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    for (std::int32_t k = offsets[f]; k < offsets[f + 1]; ++k) {
      const std::int32_t next = k + 1 < offsets[f + 1] ? k + 1 : offsets[f];
      EXPECT_TRUE(edges.emplace(corners[static_cast<std::size_t>(k)], corners[static_cast<std::size_t>(next)]).second);
    }
  }
  for (const auto& [from, to] : edges) EXPECT_TRUE(edges.contains({to, from}));
  auto nothing = sized<pdepth_surface>();
  EXPECT_EQ(pdepth_shape_surface(context_.get(), whole.get(), 0, &nothing), PDEPTH_OK) << "arrays may be left out";
  EXPECT_EQ(pdepth_shape_surface(context_.get(), whole.get(), 2, &nothing), PDEPTH_OUT_OF_RANGE);
  const Shape round = make_shape(context_, &pdepth_cylinder, 1.0, 1.0, 2);
  EXPECT_EQ(pdepth_shape_surface(context_.get(), round.get(), 0, &nothing), PDEPTH_UNSUPPORTED);
}

/// A feature leads back to the rows of the caller, in whatever order they came.
TEST_F(CQueries, FeaturesAreTheCallersPoints) {
  const std::array<double, 12> points{0, 0, 1, 1, 0, 0, 0, 1, 0, -1, -1, 0};
  const Shape hull = make_shape(context_, &pdepth_convex_hull, points.data(), 4);
  question_.b = hull.get();
  question_.pose_a.numbers[2] = 1.25;  // the cube stands on the apex
  auto answer = sized<pdepth_answer>();
  ASSERT_EQ(pdepth_depth(context_.get(), &question_, &answer), PDEPTH_OK);
  ASSERT_EQ(answer.feature_b.kind, PDEPTH_FEATURE_VERTEX);
  std::int32_t apex = -1, count = 1;
  ASSERT_EQ(pdepth_feature_points(context_.get(), hull.get(), &answer.feature_b, &apex, &count), PDEPTH_OK);
  EXPECT_EQ(apex, 0);
  ASSERT_EQ(answer.feature_a.kind, PDEPTH_FEATURE_FACET);
  std::array<std::int32_t, 4> floor{};
  count = 4;
  ASSERT_EQ(pdepth_feature_points(context_.get(), cube_.get(), &answer.feature_a, floor.data(), &count), PDEPTH_OK);
  std::sort(floor.begin(), floor.end());
  EXPECT_EQ(floor, (std::array<std::int32_t, 4>{0, 1, 2, 3}));  // the corners with z < 0
}

/// The memory of a pair given to another pair of shapes changes no answer.
TEST_F(CQueries, PairsAreNotTrusted) {
  const Pair pair = make_pair(context_);
  const Shape ball = make_shape(context_, &pdepth_sphere, 0.5);
  auto cold = sized<pdepth_answer>(), warm = sized<pdepth_answer>();
  for (const pdepth_shape* b : {cube_.get(), ball.get(), cube_.get()}) {
    question_.b = b;
    question_.pose_b.numbers[0] = 0.75;
    question_.pair = nullptr;
    ASSERT_EQ(pdepth_depth(context_.get(), &question_, &cold), PDEPTH_OK);
    question_.pair = pair.get();
    ASSERT_EQ(pdepth_depth(context_.get(), &question_, &warm), PDEPTH_OK);
    EXPECT_EQ(warm.lower, cold.lower);
    EXPECT_EQ(warm.upper, cold.upper);
  }
  ASSERT_EQ(pdepth_pair_clear(context_.get(), pair.get()), PDEPTH_OK);
  ASSERT_EQ(pdepth_depth(context_.get(), &question_, &warm), PDEPTH_OK);
  EXPECT_EQ(warm.warm, 0);
  EXPECT_EQ(pdepth_version(), 100);
}

}  // namespace
}  // namespace pd::c_test
