/// @file
/// The grid oracle against the rational one, and against the hulls of the library; and that each of its checks can
/// fail.

#include "oracle/grid_oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "oracle/depth_oracle.hpp"
#include "oracle/exact_sum.hpp"
#include "oracle/grid_answer_check.hpp"
#include "oracle/grid_pool.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::oracle::grid {
namespace {

constexpr std::uint64_t kSeed = 5;

std::vector<Vec3> doubles(const std::vector<Int3>& points) {
  std::vector<Vec3> result;
  for (const Int3& p : points) result.push_back(p.to_vec3());
  return result;
}

ExactLength root_of(const Fraction& square) { return {Integer(square.numerator), Integer(square.denominator), 0}; }

/// n and some direction of the set are parallel, not opposite.
template <class Vector, class Set, class Cross, class Dot>
bool holds(const Set& set, const Vector& n, const Cross& parallel, const Dot& along) {
  return std::any_of(set.begin(), set.end(), [&](const auto& m) { return parallel(m, n) && along(m, n) > 0; });
}

TEST(GridOracle, EqualsTheRationalOracle) {
  const Pool pool(400, kSeed);
  Judge judge;
  int classes[3] = {};
  int flat = 0;
  for (int i = 0; i < 4000; ++i) {
    const DrawnPair p = pool.draw(kSeed, i);
    SCOPED_TRACE(protocol_line(p));
    const oracle::Body a(doubles(p.a->body.points));
    const oracle::Body b(doubles(p.b->body.points));
    const ExactPair pair(a, p.pose_a, b, p.pose_b);
    const oracle::Verdict wanted = oracle::judge(pair);
    const Verdict& got = judge.judge(p.placed_a, p.placed_b);
    ASSERT_EQ(got.contact, wanted.contact);
    ASSERT_EQ(got.flat_difference, wanted.flat_difference);
    ASSERT_EQ(wanted.depth.compare(root_of(got.depth_squared)), 0);
    ASSERT_EQ(got.depth_squared.numerator > 0, got.contact == ContactClass::overlapping);
    if (got.contact == ContactClass::separated) {
      ASSERT_TRUE(wanted.distance_known);
      ASSERT_EQ(wanted.distance.compare(root_of(got.distance_squared)), 0);
      ASSERT_EQ(root_down(got.distance_squared), wanted.distance.round_down());
      ASSERT_EQ(root_up(got.distance_squared), wanted.distance.round_up());
    }
    if (got.contact == ContactClass::overlapping) {
      ASSERT_EQ(root_down(got.depth_squared), wanted.depth.round_down());
      ASSERT_EQ(root_up(got.depth_squared), wanted.depth.round_up());
    }
    // The same optimal directions.
    const auto big = [](const Int3& n) { return IVec{n.x, n.y, n.z}; };
    const auto parallel = [&](const IVec& m, const IVec& n) { return is_zero(oracle::cross(m, n)); };
    const auto along = [&](const IVec& m, const IVec& n) { return oracle::dot(m, n).sign(); };
    if (!got.flat_difference) {
      std::vector<IVec> ours;
      for (const Int3& n : got.normals) ours.push_back(big(n));
      // Where the bodies touch, directions between the facet normals lead out at once, too.
      if (got.contact == ContactClass::overlapping) {
        for (const IVec& n : ours) ASSERT_TRUE(holds(wanted.normals, n, parallel, along));
      }
      for (const IVec& n : wanted.normals) ASSERT_TRUE(holds(ours, n, parallel, along));
    }
    ++classes[static_cast<int>(got.contact)];
    flat += got.flat_difference;
  }
  std::printf("%d separated, %d touching, %d overlapping, %d flat\n", classes[0], classes[1], classes[2], flat);
  EXPECT_GT(*std::min_element(std::begin(classes), std::end(classes)), 500);
  EXPECT_GT(flat, 200);
}

TEST(GridOracle, KnowsItsBodies) {
  const Pool pool(1000, kSeed);
  int kinds[kKinds] = {};
  for (const PooledBody& p : pool.bodies()) {
    const ConvexPolytope& hull = *p.shape.polytope();
    ++kinds[static_cast<int>(p.kind)];
    ASSERT_EQ(p.body.dimension, hull.affine_dimension());
    ASSERT_EQ(static_cast<int>(p.body.vertices.size()), hull.num_vertices());
    ASSERT_EQ(static_cast<int>(p.body.normals.size()), hull.num_facets());
    for (int v = 0; v < hull.num_vertices(); ++v) {
      const Vec3 x = hull.vertex(v);
      ASSERT_TRUE(
          std::any_of(p.body.vertices.begin(), p.body.vertices.end(), [&](const Int3& q) { return q.to_vec3() == x; }));
    }
    ASSERT_EQ(p.reordered.polytope()->num_vertices(), hull.num_vertices());
  }
  for (const int count : kinds) EXPECT_GT(count, 30);
}

TEST(GridOracle, TheAxisRotationsAreTwentyFour) {
  for (const AxisRotation& r : axis_rotations()) {
    EXPECT_EQ(r.matrix().determinant(), 1);
    EXPECT_EQ(r.apply({1, 2, 3}).to_vec3(), r.matrix() * Vec3(1, 2, 3));
    const auto same = [&](const AxisRotation& other) { return other.matrix() == r.matrix(); };
    EXPECT_EQ(std::count_if(axis_rotations().begin(), axis_rotations().end(), same), 1);
  }
}

TEST(GridOracle, SumsKeepTheirLastBit) {
  ExactSum<8> sum;
  sum.add_product(1 + 0x1p-52, 1 + 0x1p-52);  // 1 + 2^-51 + 2^-104
  sum.add(-1);
  sum.add(-0x1p-51);
  EXPECT_EQ(sum.sign(), 1);
  sum.add(-0x1p-104);
  EXPECT_EQ(sum.sign(), 0);
  sum.add(0x1p60);
  sum.add(-0x1p-300);
  sum.add(-0x1p60);
  EXPECT_EQ(sum.sign(), -1);
  EXPECT_EQ(compare_square(3, {9, 1}), 0);
  EXPECT_EQ(compare_square(std::nextafter(3.0, 4.0), {9, 1}), 1);
  EXPECT_EQ(compare_square(1.0 / 3, {1, 9}), -1);  // the double lies below the third
  EXPECT_EQ(compare_square(0x1p-250, {1, 9}), -1);
  EXPECT_EQ(compare_square(0x1p-250, {0, 9}), 1);
}

/// An answer that keeps every promise, and what it answers.
struct Answered {
  DrawnPair pair;
  Question question;
  PenetrationDepth answer;
};

class GridAnswerCheck : public ::testing::TestWithParam<Bracket> {
 protected:
  PenetrationDepth ask(const PosedShape& a, const PosedShape& b) {
    return penetration_depth(a, b, scratch_, {.bracket = GetParam(), .contact_tolerance = kContactTolerance});
  }

  /// The first pair of the class of two bodies near the origin whose P is solid; the judge holds its verdict.
  Answered find(ContactClass contact) {
    for (int i = 0;; ++i) {
      const DrawnPair p = pool_.draw(kSeed, i);
      if (p.a == p.b || p.pose_a.translation().norm() > 10) continue;
      verdict_ = &judge_.judge(p.placed_a, p.placed_b);
      if (verdict_->contact != contact || verdict_->flat_difference) continue;
      Answered found{p, {p.placed_a, p.placed_b, p.a->shape.polytope(), p.b->shape.polytope(), GetParam()}, {}};
      found.answer = ask({&p.a->shape, p.pose_a}, {&p.b->shape, p.pose_b});
      EXPECT_TRUE(check(found).empty());
      return found;
    }
  }

  std::vector<Breach> check(const Answered& answered) {
    return check_answer(judge_, *verdict_, answered.question, answered.answer).wrong;
  }

  /// The check of the falsified answer names the promise.
  void expect_found(Answered answered, Promise promise, const std::function<void(PenetrationDepth&)>& falsify) {
    falsify(answered.answer);
    const std::vector<Breach> wrong = check(answered);
    const auto named = [&](const Breach& b) { return b.promise == promise; };
    EXPECT_TRUE(std::any_of(wrong.begin(), wrong.end(), named)) << to_string(promise);
  }

  Pool pool_{200, kSeed};
  Judge judge_;
  Scratch scratch_;
  const Verdict* verdict_ = nullptr;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
double next_up(double x) { return std::nextafter(x, kInfinity); }
double next_down(double x) { return std::nextafter(x, -kInfinity); }

TEST_P(GridAnswerCheck, FindsWhatIsFalseOfOverlappingBodies) {
  const Answered a = find(ContactClass::overlapping);
  const bool tightest = GetParam() == Bracket::tightest;
  expect_found(a, Promise::finite, [](auto& x) { x.witness_a.x() = std::nan(""); });
  expect_found(a, Promise::contact, [](auto& x) { x.contact = ContactClass::touching; });
  expect_found(a, Promise::bracket, [&](auto& x) { x.lower = next_up(root_up(verdict_->depth_squared)); });
  expect_found(a, Promise::bracket, [&](auto& x) { x.upper = next_down(root_down(verdict_->depth_squared)); });
  expect_found(a, Promise::bracket, [](auto& x) { x.depth = x.upper * (1 + 1e-12); });
  expect_found(a, Promise::width, [&](auto& x) { x.upper *= tightest ? 1 + 0x1p-51 : 1 + 1e-10; });
  expect_found(a, Promise::width, [&](auto& x) { x.lower *= tightest ? 1 - 0x1p-51 : 1 - 1e-10; });
  expect_found(a, Promise::width, [](auto& x) { x.bracket_reached = false; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal *= 1 + 0x1p-48; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal = -x.normal; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal = (x.normal + Vec3(0, 1e-6, 2e-6)).normalized(); });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_a.z() += 1e-9; });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_a.x() += 20, x.witness_b.x() += 20; });
  expect_found(a, Promise::zero, [](auto& x) { x.distance = 1e-300; });
  if (GetParam() == Bracket::contact) {
    expect_found(a, Promise::translation, [](auto& x) { x.upper *= 1 - 1e-9; });
    return;
  }
  // As stored: of the tightest the last bits count.
  expect_found(a, Promise::translation, [&](auto& x) { x.translation *= tightest ? 1 - 0x1p-49 : 1 - 1e-12; });
  expect_found(a, Promise::translation, [](auto& x) { x.translation *= 1 + 1e-10; });
  if (tightest) {
    expect_found(a, Promise::feature, [](auto& x) { x.feature_a.kind = Feature::Kind::none; });
    expect_found(a, Promise::feature, [](auto& x) { x.feature_b = {Feature::Kind::vertex, 1 << 20, -1}; });
    // A vertex of A in the far face, and a facet where the other's vertex is meant.
    const ConvexPolytope& hull = *a.question.hull_a;
    const Mat3 back = a.pair.pose_a.rotation().transpose();
    int far = 0;
    for (int v = 0; v < hull.num_vertices(); ++v) {
      if ((back * a.answer.normal).dot(hull.vertex(v) - hull.vertex(far)) > 0) far = v;
    }
    expect_found(a, Promise::feature, [&](auto& x) { x.feature_a = {Feature::Kind::vertex, far, -1}; });
  }
}

TEST_P(GridAnswerCheck, FindsWhatIsFalseOfTouchingBodies) {
  const Answered a = find(ContactClass::touching);
  expect_found(a, Promise::contact, [](auto& x) { x.contact = ContactClass::separated; });
  expect_found(a, Promise::zero, [](auto& x) { x.depth = 1e-300; });
  expect_found(a, Promise::zero, [](auto& x) { x.translation.x() = 1e-300; });
  expect_found(a, Promise::zero, [](auto& x) { x.distance_lower = 1e-300; });
  expect_found(a, Promise::width, [](auto& x) { x.upper = 1e-9; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal = -x.normal; });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_b.y() += 1e-9; });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_a.x() += 20, x.witness_b.x() += 20; });
}

TEST_P(GridAnswerCheck, FindsWhatIsFalseOfSeparatedBodies) {
  const Answered a = find(ContactClass::separated);
  const bool tightest = GetParam() == Bracket::tightest;
  expect_found(a, Promise::contact, [](auto& x) { x.contact = ContactClass::overlapping; });
  expect_found(a, Promise::bracket, [&](auto& x) { x.distance_lower = next_up(root_up(verdict_->distance_squared)); });
  expect_found(a, Promise::bracket,
               [&](auto& x) { x.distance_upper = next_down(root_down(verdict_->distance_squared)); });
  expect_found(a, Promise::bracket, [](auto& x) { x.distance *= 1 + 1e-12; });
  expect_found(a, Promise::width, [&](auto& x) { x.distance_upper *= tightest ? 1 + 0x1p-51 : 1 + 1e-10; });
  expect_found(a, Promise::zero, [](auto& x) { x.upper = 1e-300; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal *= 1 + 0x1p-48; });
  expect_found(a, Promise::normal, [](auto& x) { x.normal = -x.normal; });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_a.x() += 1e-9; });
  expect_found(a, Promise::witness, [](auto& x) { x.witness_a.x() += 20, x.witness_b.x() += 20; });
}

TEST_P(GridAnswerCheck, FindsBrokenLaws) {
  for (const ContactClass contact : {ContactClass::separated, ContactClass::touching, ContactClass::overlapping}) {
    const Answered a = find(contact);
    const DrawnPair& p = a.pair;
    PenetrationDepth swapped = ask({&p.b->shape, p.pose_b}, {&p.a->shape, p.pose_a});
    EXPECT_TRUE(check_swapped(judge_, a.answer, swapped).empty());
    swapped.normal.x() = next_up(swapped.normal.x());
    EXPECT_FALSE(check_swapped(judge_, a.answer, swapped).empty());
    swapped = a.answer;
    swapped.normal = -swapped.normal;
    swapped.translation = -swapped.translation;
    EXPECT_TRUE(check_swapped(judge_, a.answer, swapped).empty());
    swapped.upper = next_up(swapped.upper);
    EXPECT_FALSE(check_swapped(judge_, a.answer, swapped).empty());

    PenetrationDepth reordered = ask({&p.a->reordered, p.pose_a}, {&p.b->reordered, p.pose_b});
    EXPECT_TRUE(check_reordered(a.answer, reordered).empty());
    reordered.witness_b.z() = next_up(reordered.witness_b.z());
    EXPECT_FALSE(check_reordered(a.answer, reordered).empty());
    reordered = a.answer;
    reordered.feature_a.first += 1;
    EXPECT_FALSE(check_reordered(a.answer, reordered).empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Brackets, GridAnswerCheck,
                         ::testing::Values(Bracket::tightest, Bracket::certified, Bracket::contact), [](const auto& p) {
                           return p.param == Bracket::tightest    ? "tightest"
                                  : p.param == Bracket::certified ? "certified"
                                                                  : "contact";
                         });

}  // namespace
}  // namespace pd::oracle::grid
