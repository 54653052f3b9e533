/// @file
/// Bad input of every kind is a named error that says what is wrong and where, and changes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "c_interface/c_library.hpp"

namespace pd::c_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class CErrors : public testing::Test {
 protected:
  void refused(pdepth_status status, pdepth_status expected, const std::string& where) {
    EXPECT_EQ(status, expected) << error_of(context_);
    pdepth_error error{};
    pdepth_last_error(context_.get(), &error);
    EXPECT_EQ(error.status, expected);
    EXPECT_EQ(where, error.where) << error.message;
    EXPECT_GT(std::string(error.message).size(), 10u);
  }

  const std::array<double, 3> half_{0.5, 0.5, 0.5};
  Context context_ = make_context();
  Shape cube_ = make_shape(context_, &pdepth_box, half_.data());
  pdepth_question question_ = question_of(cube_.get(), cube_.get());
  pdepth_answer answer_ = sized<pdepth_answer>();
  pdepth_shape* none_ = nullptr;
};

TEST_F(CErrors, OfShapes) {
  const std::array<double, 3> thin{0.5, 0, 0.5}, unknown{0.5, kNan, 0.5};
  pdepth_context* const c = context_.get();
  refused(pdepth_box(c, thin.data(), &none_), PDEPTH_BAD_VALUE, "half_extents[1]");
  refused(pdepth_box(c, unknown.data(), &none_), PDEPTH_NON_FINITE, "half_extents[1]");
  refused(pdepth_box(c, nullptr, &none_), PDEPTH_NULL_ARGUMENT, "half_extents");
  refused(pdepth_box(c, half_.data(), nullptr), PDEPTH_NULL_ARGUMENT, "shape");
  refused(pdepth_sphere(c, -1, &none_), PDEPTH_BAD_VALUE, "radius");
  refused(pdepth_sphere(c, HUGE_VAL, &none_), PDEPTH_NON_FINITE, "radius");
  refused(pdepth_ellipsoid(c, thin.data(), &none_), PDEPTH_BAD_VALUE, "radii[1]");
  refused(pdepth_capsule(c, 1, 1, 3, &none_), PDEPTH_BAD_VALUE, "axis");
  refused(pdepth_cylinder(c, 1, 0, 2, &none_), PDEPTH_BAD_VALUE, "half_height");
  refused(pdepth_cone(c, 1e300, 1, 2, &none_), PDEPTH_OUT_OF_RANGE, "radius");
  refused(pdepth_with_margin(c, cube_.get(), -1, &none_), PDEPTH_BAD_VALUE, "margin");
  refused(pdepth_with_margin(c, nullptr, 1, &none_), PDEPTH_NULL_ARGUMENT, "body");

  const std::array<double, 6> points{0, 0, 0, 1, kNan, 0};
  refused(pdepth_convex_hull(c, points.data(), 2, &none_), PDEPTH_NON_FINITE, "points[1]");
  refused(pdepth_convex_hull(c, points.data(), 0, &none_), PDEPTH_TOO_FEW_POINTS, "points");
  refused(pdepth_convex_hull(c, points.data(), -1, &none_), PDEPTH_BAD_VALUE, "count");
  refused(pdepth_convex_hull(c, points.data(), 1'000'000'000, &none_), PDEPTH_LIMIT_EXCEEDED, "count");
  refused(pdepth_convex_hull(c, nullptr, 2, &none_), PDEPTH_NULL_ARGUMENT, "points");

  const std::array<double, 16> planes{1, 0, 0, 1, -1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 1};
  refused(pdepth_halfspaces(c, planes.data(), 4, &none_), PDEPTH_ZERO_DIRECTION, "planes[3]");
  refused(pdepth_halfspaces(c, planes.data(), 3, &none_), PDEPTH_TOO_FEW_POINTS, "planes");
  const std::array<double, 4> sphere{0, 0, 0, -1};
  refused(pdepth_hull_of_spheres(c, sphere.data(), 1, &none_), PDEPTH_BAD_VALUE, "spheres[0]");
  EXPECT_EQ(none_, nullptr);
}

TEST_F(CErrors, OfFaces) {
  const std::array<double, 12> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<std::int32_t, 5> offsets{0, 3, 6, 9, 12};
  std::array<std::int32_t, 12> corners{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  auto faces = sized<pdepth_faces>();
  faces.points = points.data(), faces.num_points = 4;
  faces.offsets = offsets.data(), faces.num_faces = 4;
  faces.vertices = corners.data();
  pdepth_context* const c = context_.get();
  EXPECT_NE(make_shape(context_, &pdepth_convex_faces, &faces), nullptr);
  corners[4] = 7;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_BAD_FACES, "faces[1]");
  refused(pdepth_mesh_solid(c, &faces, 0, &none_), PDEPTH_BAD_FACES, "mesh.vertices[4]");
  corners[4] = 1, offsets[2] = 20;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_BAD_FACES, "faces.offsets");
  offsets[2] = 6, offsets[0] = 1;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_BAD_FACES, "faces.offsets");
  refused(pdepth_mesh_solid(c, &faces, 0, &none_), PDEPTH_BAD_FACES, "mesh.offsets");
  offsets[0] = 0, faces.points = nullptr;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_NULL_ARGUMENT, "faces.points");
  faces.points = points.data(), faces.num_points = -1;
  refused(pdepth_mesh_solid(c, &faces, 0, &none_), PDEPTH_BAD_VALUE, "mesh.num_points");
  faces.num_points = 4, faces.reserved = 9;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_BAD_VALUE, "faces.reserved");
  faces.reserved = 0, faces.num_faces = 3;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_NOT_CLOSED, "faces[2]");
  faces.size = 4;
  refused(pdepth_convex_faces(c, &faces, &none_), PDEPTH_BAD_VALUE, "faces.size");
}

TEST_F(CErrors, OfPosesAndQuestions) {
  const auto ask = [&] { return pdepth_depth(context_.get(), &question_, &answer_); };
  const std::int32_t before = answer_.contact = 77;
  question_.pose_a.numbers[1] = kNan;
  refused(ask(), PDEPTH_NON_FINITE, "question.pose_a.translation[1]");
  question_.pose_a.numbers[1] = 0, question_.pose_b.numbers[2] = 1e301;
  refused(ask(), PDEPTH_OUT_OF_RANGE, "question.pose_b.translation[2]");
  question_.pose_b.numbers[2] = 0, question_.pose_b.form = 9;
  refused(ask(), PDEPTH_BAD_VALUE, "question.pose_b.form");
  question_.pose_b.form = PDEPTH_POSE_MATRIX;
  refused(ask(), PDEPTH_NOT_A_ROTATION, "question.pose_b.rotation");
  question_.pose_b.form = PDEPTH_POSE_QUATERNION_XYZW;
  question_.pose_b.numbers[6] = 2;
  refused(ask(), PDEPTH_NOT_A_ROTATION, "question.pose_b.quaternion");
  question_.pose_b = {}, question_.a = nullptr;
  refused(ask(), PDEPTH_NULL_ARGUMENT, "question.a");
  question_.a = cube_.get(), question_.size = 0;
  refused(ask(), PDEPTH_BAD_VALUE, "question.size");
  question_.size = sizeof question_, question_.reserved = 9;
  refused(ask(), PDEPTH_BAD_VALUE, "question.reserved");
  question_.reserved = 0, question_.pose_a.reserved = 9;
  refused(ask(), PDEPTH_BAD_VALUE, "question.pose_a.reserved");
  // A size that nobody set: the bytes behind the struct stay as they are.
  question_.pose_a.reserved = 0, question_.size = 0x5a5a5a5a;
  refused(ask(), PDEPTH_BAD_VALUE, "question.size");
  question_.size = sizeof question_, answer_.size = 100'000;
  refused(ask(), PDEPTH_BAD_VALUE, "answer.size");
  answer_.size = 8;
  refused(ask(), PDEPTH_BAD_VALUE, "answer.size");
  refused(pdepth_depth(context_.get(), nullptr, &answer_), PDEPTH_BAD_VALUE, "answer.size");
  answer_.size = sizeof answer_;
  refused(pdepth_depth(context_.get(), nullptr, &answer_), PDEPTH_NULL_ARGUMENT, "question");
  refused(pdepth_depth(context_.get(), &question_, nullptr), PDEPTH_NULL_ARGUMENT, "answer");
  EXPECT_EQ(answer_.contact, before);
  EXPECT_EQ(ask(), PDEPTH_OK);
  EXPECT_EQ(answer_.depth, 1);
}

/// Sizes that lie too far apart have answers that doubles do not hold.
TEST_F(CErrors, OfAnswersPastTheRangeOfDoubles) {
  const double e = 1e-100;
  const std::array<double, 3> half{1.6, 8.9, 1.4};
  const Shape cone = make_shape(context_, &pdepth_cone, e, e, 1), can = make_shape(context_, &pdepth_cylinder, e, e, 1);
  const Shape box = make_shape(context_, &pdepth_box, half.data());
  std::array<pdepth_part, 2> parts{};
  parts[0].shape = cone.get(), parts[1].shape = can.get();
  parts[1].pose.numbers[0] = e, parts[1].pose.numbers[1] = 3 * e;
  const Shape both = make_shape(context_, &pdepth_compound, parts.data(), std::int64_t{2});
  question_.a = both.get(), question_.b = box.get();
  const std::int32_t before = answer_.contact = 77;
  refused(pdepth_depth(context_.get(), &question_, &answer_), PDEPTH_OUT_OF_RANGE, "question");
  EXPECT_EQ(answer_.contact, before);

  const std::array<double, 12> points{1e-100, 0,      1e-100, -2e-100, -1e-100, -1e-100,
                                      1e-100, 2e-100, 1e-100, -2e-100, -1e-100, -2e-100};
  const std::array<double, 12> spheres{-3, 2, 3, 1, 1, 1, 1, 3, 2, -1, -3, 1};
  const Shape speck = make_shape(context_, &pdepth_convex_hull, points.data(), std::int64_t{4});
  const Shape hull = make_shape(context_, &pdepth_hull_of_spheres, spheres.data(), std::int64_t{3});
  const Shape cloud = make_shape(context_, &pdepth_with_margin, hull.get(), 1e100);
  question_.a = speck.get(), question_.b = cloud.get();
  const bool answered = pdepth_depth(context_.get(), &question_, &answer_) == PDEPTH_OK;
  EXPECT_TRUE(!answered || answer_.lower <= answer_.depth);
}

TEST_F(CErrors, OfSettings) {
  auto settings = sized<pdepth_settings>();
  question_.settings = &settings;
  const auto ask = [&] { return pdepth_depth(context_.get(), &question_, &answer_); };
  settings.method = 6;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.method");
  settings.method = 0, settings.bracket = -1;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.bracket");
  settings.bracket = 0, settings.delta = kNan;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.delta");
  settings.delta = 0, settings.contact_tolerance = -1;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.contact_tolerance");
  settings.contact_tolerance = 0, settings.use_beyond = 1, settings.beyond = kNan;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.beyond");
  settings.use_beyond = 0, settings.max_points = -1;
  refused(ask(), PDEPTH_BAD_VALUE, "settings.max_points");
  settings.max_points = 0, settings.method = PDEPTH_METHOD_DECOMPOSITION;
  const Shape ball = make_shape(context_, &pdepth_sphere, 1.0);
  const std::array<double, 3> radii{1, 2, 3};
  const Shape egg = make_shape(context_, &pdepth_ellipsoid, radii.data());
  question_.b = egg.get();
  refused(ask(), PDEPTH_UNSUPPORTED, "settings.method");
  auto width = sized<pdepth_width_answer>();
  refused(pdepth_width(context_.get(), cube_.get(), nullptr, &settings, &width), PDEPTH_UNSUPPORTED, "settings.method");
}

TEST_F(CErrors, OfOtherQueries) {
  pdepth_context* const c = context_.get();
  auto along = sized<pdepth_directional>();
  const std::array<double, 3> nowhere{0, 0, 0}, unknown{1, kNan, 0};
  refused(pdepth_depth_along(c, &question_, nowhere.data(), &along), PDEPTH_ZERO_DIRECTION, "direction");
  refused(pdepth_depth_along(c, &question_, unknown.data(), &along), PDEPTH_NON_FINITE, "direction[1]");
  auto support = sized<pdepth_support_answer>();
  refused(pdepth_support(c, cube_.get(), nullptr, nowhere.data(), &support), PDEPTH_ZERO_DIRECTION, "direction");
  refused(pdepth_support(c, cube_.get(), nullptr, nullptr, &support), PDEPTH_NULL_ARGUMENT, "direction");
  auto manifold = sized<pdepth_manifold>();
  refused(pdepth_contact_manifold(c, &question_, -1, &manifold), PDEPTH_BAD_VALUE, "breaking_threshold");
  std::int32_t apart = 0;
  refused(pdepth_apart(c, &question_, kNan, &apart), PDEPTH_BAD_VALUE, "distance");
  auto movement = sized<pdepth_movement>();
  auto impact = sized<pdepth_impact>();
  movement.duration = -1;
  refused(pdepth_time_of_impact(c, &question_, &movement, &impact, nullptr), PDEPTH_BAD_VALUE, "movement.duration");
  movement.duration = 1e200, movement.b.linear_velocity[0] = 1e149;
  refused(pdepth_time_of_impact(c, &question_, &movement, &impact, nullptr), PDEPTH_OUT_OF_RANGE, "movement.b");
  movement.b.linear_velocity[0] = kNan;
  refused(pdepth_time_of_impact(c, &question_, &movement, &impact, nullptr), PDEPTH_NON_FINITE,
          "movement.b.linear_velocity[0]");

  const pdepth_part part{cube_.get(), {}};
  const Shape whole = make_shape(context_, &pdepth_compound, &part, 1);
  const pdepth_part empty{};
  refused(pdepth_compound(c, &empty, 1, &none_), PDEPTH_NULL_ARGUMENT, "parts[0].shape");
  refused(pdepth_compound(c, &part, 0, &none_), PDEPTH_TOO_FEW_POINTS, "parts");
  question_.a = whole.get();
  refused(pdepth_contact_manifold(c, &question_, 0, &manifold), PDEPTH_UNSUPPORTED, "question.a");
  auto derivatives = sized<pdepth_derivatives>();
  refused(pdepth_depth_derivatives(c, &question_, &derivatives, nullptr), PDEPTH_UNSUPPORTED, "question.a");
}

TEST_F(CErrors, OfFeatures) {
  EXPECT_EQ(pdepth_depth(context_.get(), &question_, &answer_), PDEPTH_OK);
  std::array<std::int32_t, 4> points{};
  std::int32_t count = 4;
  pdepth_feature feature{PDEPTH_FEATURE_FACET, 0, 0, -1};
  EXPECT_EQ(pdepth_feature_points(context_.get(), cube_.get(), &feature, points.data(), &count), PDEPTH_OK);
  EXPECT_EQ(count, 4);
  count = 0;
  EXPECT_EQ(pdepth_feature_points(context_.get(), cube_.get(), &feature, nullptr, &count), PDEPTH_OK);
  EXPECT_EQ(count, 4);
  feature.first = 6;
  refused(pdepth_feature_points(context_.get(), cube_.get(), &feature, points.data(), &count), PDEPTH_OUT_OF_RANGE,
          "feature.first");
  feature = {PDEPTH_FEATURE_EDGE, 0, 1, -1};
  refused(pdepth_feature_points(context_.get(), cube_.get(), &feature, points.data(), &count), PDEPTH_OUT_OF_RANGE,
          "feature.second");
  feature.part = 1;
  refused(pdepth_feature_points(context_.get(), cube_.get(), &feature, points.data(), &count), PDEPTH_OUT_OF_RANGE,
          "feature.part");
}

TEST_F(CErrors, OfContexts) {
  EXPECT_EQ(pdepth_depth(nullptr, &question_, &answer_), PDEPTH_NULL_ARGUMENT);
  EXPECT_EQ(pdepth_context_create(nullptr, nullptr), PDEPTH_NULL_ARGUMENT);
  EXPECT_EQ(pdepth_last_error(context_.get(), nullptr), PDEPTH_NULL_ARGUMENT);
  pdepth_context_destroy(nullptr);
  pdepth_shape_retain(nullptr);
  pdepth_shape_release(nullptr);
  pdepth_pair_destroy(nullptr);
  for (int status = -3; status < 110; ++status) EXPECT_NE(pdepth_status_name(status), nullptr);
  EXPECT_STREQ(pdepth_status_name(PDEPTH_NOT_A_ROTATION), "not_a_rotation");
  EXPECT_STREQ(pdepth_status_name(4711), "unknown");
}

/// Structs of a newer header: fields that the library does not know are refused unless they are 0.
TEST_F(CErrors, OfNewerHeaders) {
  struct Newer {
    pdepth_question question;
    double unknown;
  } newer{question_, 0};
  struct NewerAnswer {
    pdepth_answer answer;
    double unknown;
  } newer_answer{answer_, 5};
  newer.question.size = sizeof newer;
  newer_answer.answer.size = sizeof newer_answer;
  EXPECT_EQ(pdepth_depth(context_.get(), &newer.question, &newer_answer.answer), PDEPTH_OK);
  EXPECT_EQ(newer_answer.answer.size, sizeof newer_answer);
  EXPECT_EQ(newer_answer.unknown, 0);
  newer.unknown = 1;
  refused(pdepth_depth(context_.get(), &newer.question, &newer_answer.answer), PDEPTH_UNSUPPORTED, "question");
}

}  // namespace
}  // namespace pd::c_test
