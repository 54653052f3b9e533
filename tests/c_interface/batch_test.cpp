/// @file
/// Batches: the bits of single calls for any strides and number of threads, and errors by row.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <thread>

#include "c_interface/c_library.hpp"
#include "scenes/shape_families.hpp"

namespace pd::c_test {
namespace {

/// A body of an engine: the pose stands among other numbers.
struct EngineBody {
  const pdepth_shape* shape;
  float colour[3];
  double pose[7];
};

class CBatch : public testing::Test {
 protected:
  static constexpr std::int64_t kRows = 150;

  CBatch() {
    scenes::Random random(11);
    const std::array<double, 3> half{0.3, 0.4, 0.5};
    shapes_.push_back(make_shape(context_, &pdepth_box, half.data()));
    shapes_.push_back(
        make_shape(context_, &pdepth_convex_hull, numbers_of(scenes::sphere_hull(30, random)).data(), 30));
    shapes_.push_back(make_shape(context_, &pdepth_capsule, 0.3, 0.4, 1));
    for (std::int64_t i = 0; i < kRows; ++i) {
      EngineBody body{};
      body.shape = shapes_[static_cast<std::size_t>(i) % shapes_.size()].get();
      const Vec3 place = random.point(-0.6, 0.6);
      const auto q = random.quaternion();
      const std::array<double, 7> pose{place.x(), place.y(), place.z(), q[0], q[1], q[2], q[3]};
      std::copy(pose.begin(), pose.end(), body.pose);
      bodies_.push_back(body);
    }
    batch_.count = kRows;
    batch_.a = &bodies_[0].shape;
    batch_.stride_a = sizeof(EngineBody);
    batch_.poses_a = {PDEPTH_POSE_QUATERNION_WXYZ, 0, bodies_[0].pose, sizeof(EngineBody)};
    still_ = shapes_[1].get();
    batch_.b = &still_;
  }

  /// The first bytes of a row, which its size covers.
  static bool same(const pdepth_answer& x, const pdepth_answer& y) { return std::memcmp(&x, &y, sizeof x) == 0; }

  Context context_ = make_context();
  std::vector<Shape> shapes_;
  std::vector<EngineBody> bodies_;
  const pdepth_shape* still_ = nullptr;
  pdepth_batch batch_ = sized<pdepth_batch>();
};

TEST_F(CBatch, HasTheBitsOfSingleCallsForAnyNumberOfThreads) {
  std::vector<pdepth_answer> single;
  for (const EngineBody& body : bodies_) {
    pdepth_question question = question_of(body.shape, still_);
    question.pose_a.form = PDEPTH_POSE_QUATERNION_WXYZ;
    std::copy(std::begin(body.pose), std::end(body.pose), question.pose_a.numbers);
    single.push_back(sized<pdepth_answer>());
    ASSERT_EQ(pdepth_depth(context_.get(), &question, &single.back()), PDEPTH_OK);
  }
  struct Row {
    double before;
    pdepth_answer answer;
    double behind;
  };
  for (const std::int32_t threads : {0, 1, 3}) {
    std::vector<Row> rows(kRows, Row{1, {}, 2});
    rows[0].answer.size = sizeof(pdepth_answer);
    batch_.threads = threads;
    ASSERT_EQ(pdepth_depth_batch(context_.get(), &batch_, &rows[0].answer, sizeof(Row)), PDEPTH_OK);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_TRUE(same(rows[i].answer, single[i])) << i << " on " << threads << " threads";
      EXPECT_EQ(rows[i].before + rows[i].behind, 3);
    }
  }
}

TEST_F(CBatch, NamesTheFirstRowThatFailedAndAnswersTheOthers) {
  bodies_[40].pose[1] = NAN;
  bodies_[90].shape = nullptr;
  for (const std::int32_t threads : {1, 4}) {
    batch_.threads = threads;
    std::vector<pdepth_answer> answers(kRows);
    answers[0].size = sizeof(pdepth_answer);
    EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, answers.data(), sizeof(pdepth_answer)), PDEPTH_NON_FINITE);
    EXPECT_EQ(error_of(context_), "non_finite: a translation must be finite (rows[40].pose_a.translation[1])");
    EXPECT_EQ(answers[40].status, PDEPTH_NON_FINITE);
    EXPECT_EQ(answers[90].status, PDEPTH_NULL_ARGUMENT);
    for (const std::size_t i : {39u, 41u, 149u}) {
      EXPECT_EQ(answers[i].status, PDEPTH_OK);
      EXPECT_GT(std::abs(answers[i].depth) + answers[i].distance, 0);
    }
  }
}

TEST_F(CBatch, RemembersPairs) {
  std::vector<Pair> owners;
  std::vector<pdepth_pair*> pairs;
  for (std::int64_t i = 0; i < kRows; ++i) {
    owners.push_back(make_pair(context_));
    pairs.push_back(owners.back().get());
  }
  batch_.pairs = pairs.data();
  batch_.stride_pairs = sizeof(pdepth_pair*);
  batch_.threads = 2;
  std::vector<pdepth_answer> answers(kRows);
  answers[0].size = sizeof(pdepth_answer);
  int warm = 0;
  for (int frame = 0; frame < 2; ++frame) {
    ASSERT_EQ(pdepth_depth_batch(context_.get(), &batch_, answers.data(), sizeof(pdepth_answer)), PDEPTH_OK);
    warm = 0;
    for (const pdepth_answer& answer : answers) warm += answer.warm;
  }
  EXPECT_GT(warm, 0);
}

TEST_F(CBatch, OfManifoldsAndDerivatives) {
  std::vector<pdepth_manifold> manifolds(kRows);
  manifolds[0].size = sizeof(pdepth_manifold);
  batch_.threads = 2;
  ASSERT_EQ(pdepth_manifold_batch(context_.get(), &batch_, 0.01, manifolds.data(), sizeof(pdepth_manifold)), PDEPTH_OK);
  int points = 0;
  for (const pdepth_manifold& manifold : manifolds) points += manifold.count;
  EXPECT_GT(points, kRows / 2);
  std::vector<pdepth_derivatives> derivatives(10);
  derivatives[0].size = sizeof(pdepth_derivatives);
  batch_.count = 10;
  ASSERT_EQ(pdepth_derivatives_batch(context_.get(), &batch_, derivatives.data(), sizeof(pdepth_derivatives)),
            PDEPTH_OK);
  EXPECT_EQ(derivatives[9].size, sizeof(pdepth_derivatives));
  EXPECT_NE(derivatives[9].signed_depth, 0);
}

TEST_F(CBatch, RefusesWhatItCannotRead) {
  pdepth_answer answer = sized<pdepth_answer>();
  batch_.threads = 257;
  EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, &answer, sizeof answer), PDEPTH_BAD_VALUE);
  batch_.threads = 1;
  EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, &answer, 8), PDEPTH_BAD_VALUE);
  batch_.count = -1;
  EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, &answer, sizeof answer), PDEPTH_BAD_VALUE);
  batch_.count = 0;
  EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, &answer, sizeof answer), PDEPTH_OK);
  batch_.count = 1, batch_.b = nullptr;
  EXPECT_EQ(pdepth_depth_batch(context_.get(), &batch_, &answer, sizeof answer), PDEPTH_NULL_ARGUMENT);
}

/// A second thread that calls with a context in use is told so; nothing breaks.
TEST_F(CBatch, ContextsBelongToOneThreadAtATime) {
  std::vector<pdepth_answer> answers(kRows);
  answers[0].size = sizeof(pdepth_answer);
  std::atomic<bool> done{false};
  std::jthread other([&] {
    for (int i = 0; i < 20; ++i) {
      const auto status = pdepth_depth_batch(context_.get(), &batch_, answers.data(), sizeof(pdepth_answer));
      EXPECT_TRUE(status == PDEPTH_OK || status == PDEPTH_IN_USE);
    }
    done = true;
  });
  const pdepth_question question = question_of(still_, still_);
  while (!done) {
    auto answer = sized<pdepth_answer>();
    const pdepth_status status = pdepth_depth(context_.get(), &question, &answer);
    EXPECT_TRUE(status == PDEPTH_OK || status == PDEPTH_IN_USE);
  }
}

}  // namespace
}  // namespace pd::c_test
