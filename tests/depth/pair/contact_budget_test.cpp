/// @file
/// The cost of `Bracket::contact` is bounded by counts of operations, whatever the pair: supports and facets of the
/// answer. Where the budget ends the search, the answer says so and is certified still.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

/// An expansion of 128 steps, a support and a facet each, its start, and what bounds its nearest faces.
constexpr std::int64_t kOperationsTo128 = 320;
/// The same of 576 steps.
constexpr std::int64_t kOperationsTo2048 = 1240;
/// 128 steps in doubles, 24 on an exact hull, 40 in double-double.
constexpr std::int64_t kOperationsOfCurved = 300;

struct Tally {
  int pairs = 0;
  int wider = 0;
  int beyond = 0;  ///< wider than a thousandth of the depth
  double widest = 0;
  std::int64_t operations = 0;
};

class Budget {
 public:
  void ask(const PosedShape& a, const PosedShape& b, bool judge, const std::string& name) {
    const DepthSettings settings{.bracket = Bracket::contact, .contact_tolerance = 0x1p-30};
    const PenetrationDepth answer = penetration_depth(a, b, scratch_, settings);
    EXPECT_EQ(answer.statistics.exact_signs, 0) << name;
    ++tally.pairs;
    tally.operations = std::max(tally.operations, answer.statistics.support_calls + answer.statistics.facets_visited);
    if (!answer.bracket_reached && answer.contact == ContactClass::overlapping) {
      const double width = (answer.upper - answer.lower) / answer.upper;
      ++tally.wider;
      tally.beyond += width > 1.001e-3;
      tally.widest = std::max(tally.widest, width);
      judge = true;
    }
    if (judge) expect_holds(answer, a, b, name);
  }
  Tally tally;

 private:
  /// The certified bracket of another search meets that of the contact.
  void expect_holds(const PenetrationDepth& answer, const PosedShape& a, const PosedShape& b, const std::string& name) {
    const PenetrationDepth fine = penetration_depth(a, b, scratch_, {.bracket = Bracket::certified});
    const auto lower = [](const PenetrationDepth& d) { return d.distance_lower - d.upper; };
    const auto upper = [](const PenetrationDepth& d) { return d.distance_upper - d.lower; };
    const double slack = 1e-12 * (1 + std::abs(lower(answer)));
    EXPECT_LE(lower(answer), upper(fine) + slack) << name;
    EXPECT_GE(upper(answer), lower(fine) - slack) << name;
  }
  Scratch scratch_;
};

TEST(ContactBudget, PolytopesTo128Vertices) {
  Budget budget;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    const auto family = static_cast<PairFamily>(f);
    // Sizes beyond 2^100 are left to exact numbers.
    if (family == PairFamily::scales) continue;
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const scenes::PointPair pair = scenes::make_pair(family, 128, static_cast<DepthClass>(d), seed);
        const ConvexShape a(*ConvexPolytope::from_points(pair.a)), b(*ConvexPolytope::from_points(pair.b));
        budget.ask({&a, pair.pose_a}, {&b, pair.pose_b}, seed == 1,
                   std::string(scenes::to_string(family)) + " " + std::to_string(d) + " " + std::to_string(seed));
      }
    }
  }
  EXPECT_LE(budget.tally.operations, kOperationsTo128);
  // A pair 1e6 of its size away from the origin, whose depth doubles bracket from one side only. It says so, and its
  // contact is not lost.
  EXPECT_LE(budget.tally.wider, 1);
}

TEST(ContactBudget, DeepPairsOf2048Vertices) {
  Budget budget;
  for (const PairFamily family : {PairFamily::sphere, PairFamily::single_precision, PairFamily::near_equal_bodies,
                                  PairFamily::equal_bodies, PairFamily::mixed_scales, PairFamily::roofs}) {
    const scenes::PointPair pair = scenes::make_pair(family, 2048, DepthClass::deep, 1);
    const ConvexShape a(*ConvexPolytope::from_points(pair.a)), b(*ConvexPolytope::from_points(pair.b));
    budget.ask({&a, pair.pose_a}, {&b, pair.pose_b}, true, std::string(scenes::to_string(family)));
  }
  EXPECT_LE(budget.tally.operations, kOperationsTo2048);
  EXPECT_GT(budget.tally.wider, 0) << "the case is what it was";
  // Of two nearly equal balls all facets are tied to a hundredth.
  EXPECT_LE(budget.tally.widest, 0.02);
}

/// Thin and thick cylinders, cones, ellipsoids, boxes and capsules, anyhow turned, every fifth pair about one centre.
TEST(ContactBudget, CurvedPairs) {
  Budget budget;
  scenes::Random random(5);
  const auto extent = [&] {
    const double x = random.uniform(-1, 1);
    return x < 0 ? 1 / (1 - 9 * x) : 1.0;
  };
  const auto shape = [&](int kind) -> ConvexShape {
    const double p = extent();
    const double q = extent();
    const double r = extent();
    switch (kind) {
      case 0:
        return *ConvexShape::cylinder(p, q, 1);
      case 1:
        return *ConvexShape::cone(p, q, 1);
      case 2:
        return *ConvexShape::ellipsoid({p, q, r});
      case 3:
        return ConvexShape(*ConvexPolytope::box({p, q, r}));
      default:
        return *ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{{-p, 0, 0}, {p, 0, 0}})).with_margin(q);
    }
  };
  for (int i = 0; i < 2000; ++i) {
    const ConvexShape a = shape(i % 3);
    const ConvexShape b = shape(i / 3 % 5);
    const auto turn_a = random.quaternion();
    const auto turn_b = random.quaternion();
    const Vec3 direction = random.direction();
    const double u = i % 5 == 0 ? 0 : random.uniform();
    budget.ask({&a, *Pose::from_quaternion(turn_a, Vec3::Zero())},
               {&b, *Pose::from_quaternion(turn_b, 2 * u * u * u * direction)}, i % 20 == 0, std::to_string(i));
  }
  EXPECT_LE(budget.tally.operations, kOperationsOfCurved);
  EXPECT_LE(budget.tally.beyond, budget.tally.pairs / 50);
  EXPECT_LE(budget.tally.widest, 0.03);
  std::printf("%d pairs, %d with a wider bracket, %d beyond a thousandth, %.2g at most, %lld operations at most\n",
              budget.tally.pairs, budget.tally.wider, budget.tally.beyond, budget.tally.widest,
              static_cast<long long>(budget.tally.operations));
}

/// An interval that holds zero and is as wide as the depth was answered as touching, with depth 0.
TEST(ContactBudget, NoContactIsLostInAWideBracket) {
  Scratch scratch;
  int wide = 0;
  for (const int n : {32, 128}) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const scenes::PointPair pair =
            scenes::make_pair(PairFamily::far_translations, n, static_cast<DepthClass>(d), seed);
        const ConvexShape a(*ConvexPolytope::from_points(pair.a)), b(*ConvexPolytope::from_points(pair.b));
        const PosedShape posed_a{&a, pair.pose_a}, posed_b{&b, pair.pose_b};
        const PenetrationDepth exact = penetration_depth(posed_a, posed_b, scratch);
        const PenetrationDepth answer = penetration_depth(posed_a, posed_b, scratch, {.bracket = Bracket::contact});
        if (exact.contact != ContactClass::overlapping || answer.bracket_reached) continue;
        ++wide;
        EXPECT_EQ(answer.contact, ContactClass::overlapping) << n << " " << d << " " << seed;
        EXPECT_GE(answer.depth, exact.lower * (1 - 1e-9)) << n << " " << d << " " << seed;
      }
    }
  }
  EXPECT_GT(wide, 0);
}

}  // namespace
}  // namespace pd
