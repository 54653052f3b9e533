/// @file
/// The C interface as the tests call it: owners of its handles, and bodies made through C and C++ alike.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pd/shape/compound.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pdepth/pdepth.h"

namespace pd::c_test {

struct Release {
  void operator()(pdepth_context* context) const { pdepth_context_destroy(context); }
  void operator()(pdepth_shape* shape) const { pdepth_shape_release(shape); }
  void operator()(pdepth_pair* pair) const { pdepth_pair_destroy(pair); }
};
using Context = std::unique_ptr<pdepth_context, Release>;
using Shape = std::unique_ptr<pdepth_shape, Release>;
using Pair = std::unique_ptr<pdepth_pair, Release>;

inline Context make_context(const pdepth_allocator* allocator = nullptr) {
  pdepth_context* context = nullptr;
  EXPECT_EQ(pdepth_context_create(allocator, &context), PDEPTH_OK);
  return Context(context);
}

/// The word, message and place of the last error.
inline std::string error_of(const Context& context) {
  pdepth_error error{};
  EXPECT_EQ(pdepth_last_error(context.get(), &error), PDEPTH_OK);
  return std::string(pdepth_status_name(error.status)) + ": " + error.message + " (" + error.where + ")";
}

/// A shape from a factory of C, whose last argument is where the shape goes.
template <class Factory, class... Arguments>
Shape make_shape(const Context& context, Factory factory, Arguments... arguments) {
  pdepth_shape* shape = nullptr;
  EXPECT_EQ(factory(context.get(), arguments..., &shape), PDEPTH_OK) << error_of(context);
  return Shape(shape);
}

inline Pair make_pair(const Context& context) {
  pdepth_pair* pair = nullptr;
  EXPECT_EQ(pdepth_pair_create(context.get(), &pair), PDEPTH_OK);
  return Pair(pair);
}

/// A struct of zeros that knows its size.
template <class Struct>
Struct sized() {
  Struct zeros{};
  zeros.size = sizeof zeros;
  return zeros;
}

inline pdepth_question question_of(const pdepth_shape* a, const pdepth_shape* b) {
  auto question = sized<pdepth_question>();
  question.a = a;
  question.b = b;
  return question;
}

inline pdepth_pose pose_of(const Pose& pose) {
  pdepth_pose out{};
  for (int k = 0; k < 3; ++k) out.numbers[k] = pose.translation()[k];
  if (pose.is_quaternion()) {
    out.form = PDEPTH_POSE_QUATERNION_WXYZ;
    for (std::size_t k = 0; k < 4; ++k) out.numbers[3 + k] = pose.quaternion_wxyz()[k];
  } else {
    out.form = PDEPTH_POSE_MATRIX;
    for (int k = 0; k < 9; ++k) out.numbers[3 + k] = pose.rotation()(k / 3, k % 3);
  }
  return out;
}

/// A body through both doors.
struct Twin {
  Compound whole;
  bool is_convex;
  Shape shape;

  [[nodiscard]] const ConvexShape& convex() const { return whole.parts().front().shape; }
};

inline std::vector<double> numbers_of(const std::vector<Vec3>& points) {
  std::vector<double> numbers;
  for (const Vec3& point : points) numbers.insert(numbers.end(), {point.x(), point.y(), point.z()});
  return numbers;
}

inline Twin hull_twin(const Context& context, const std::vector<Vec3>& points) {
  return {Compound(ConvexShape(*ConvexPolytope::from_points(points))), true,
          make_shape(context, &pdepth_convex_hull, numbers_of(points).data(), static_cast<int64_t>(points.size()))};
}

inline Twin margin_twin(const Context& context, const Twin& from, double margin) {
  return {*from.whole.with_margin(margin), from.is_convex,
          make_shape(context, &pdepth_with_margin, from.shape.get(), margin)};
}

inline Twin box_twin(const Context& context, const std::array<double, 3>& h) {
  return {Compound(ConvexShape(*ConvexPolytope::box({h[0], h[1], h[2]}))), true,
          make_shape(context, &pdepth_box, h.data())};
}

}  // namespace pd::c_test
