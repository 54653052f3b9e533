/// @file
/// The bench judged itself: order statistics, tables, the comparison of builds, and that the judge knows right from
/// wrong.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "bench/measure/allocation_counter.hpp"
#include "bench/measure/compare.hpp"
#include "bench/measure/stopwatch.hpp"
#include "bench/pairs/judge.hpp"
#include "bench/pairs/pair_source.hpp"
#include "bench/pairs/shuffled.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

TEST(Stopwatch, QuantilesAreNearestRanks) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0), 1);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.99), 5);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_DOUBLE_EQ(geometric_mean({1, 4, kUnknown}), 2);
}

TEST(Table, CsvReadsBack) {
  Row row{"sphere", 32, "mid", "pdepth-auto", 12, 1234.5, 2345.5, 0.25, 1, 0};
  Row unknown = row;
  unknown.ratio_to_bullet = kUnknown;
  const auto rows = from_csv(to_csv({row, unknown}));
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ((*rows)[0].solver, "pdepth-auto");
  EXPECT_EQ((*rows)[0].p50_ns, 1234.5);
  EXPECT_EQ((*rows)[0].ratio_to_bullet, 0.25);
  EXPECT_EQ((*rows)[0].wrong, 1);
  EXPECT_TRUE(std::isnan((*rows)[1].ratio_to_bullet));
  EXPECT_FALSE(from_csv("family,vertices\n"));
  EXPECT_FALSE(from_csv(to_csv({row}) + "sphere,many\n"));
}

// A machine that is twice as slow in one run slows Bullet as well: the ratio of the builds stays.
TEST(Compare, ASlowMachineIsNoSlowBuild) {
  const Row ours{"box", 8, "mid", "pdepth-auto", 12, 500, 600, 0.5, 0, 0};
  Row slowed = ours;
  slowed.p50_ns = 900;
  slowed.ratio_to_bullet = 0.45;
  const std::vector<Comparison> cells = compare_tables({{ours}}, {{slowed}});
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_DOUBLE_EQ(cells[0].ratio, 0.9);
}

TEST(PairSource, DrawsRepeatAndNamesAreChecked) {
  EXPECT_FALSE(choose_cells({"teapots"}, {}, false));
  EXPECT_EQ(choose_cells({"box"}, {}, false)->size(), 3u);
  const Cell cell{PairFamily::roofs, 32, DepthClass::deep};
  const Draw once = *draw(cell, 7, 3);
  const Draw again = *draw(cell, 7, 3);
  EXPECT_EQ(once.pose_b, again.pose_b);
  EXPECT_EQ(vertices_of(once.bodies.a), vertices_of(again.bodies.a));
}

TEST(PairSource, VariantsHaveTheirSizesAndTurningKeepsTheDepth) {
  EXPECT_EQ(choose_cells({"ellipsoid"}, {}, false)->size(), 12u);
  EXPECT_EQ(choose_cells({"flat"}, {}, false)->size(), 12u);
  EXPECT_EQ(choose_cells({"cubes1e-7"}, {}, false)->size(), 3u);
  EXPECT_EQ(choose_cells({"resting"}, {}, false)->size(), 3u);
  EXPECT_FALSE(choose_cells({"cubes1e-7"}, {32}, false));
  Cell cell{PairFamily::grid, 8, DepthClass::deep};
  const auto depth = [&] {
    const Draw d = *draw(cell, 7, 3);
    Scratch scratch;
    return penetration_depth({&d.bodies.a, d.pose_a}, {&d.bodies.b, d.pose_b}, scratch).depth;
  };
  const double upright = depth();
  cell.turned = true;
  EXPECT_GT(upright, 0.05);
  EXPECT_NEAR(depth(), upright, 1e-14);
  cell.from_files = true;
  EXPECT_NEAR(depth(), upright, 1e-6);
  const Vec3 stored = draw(cell, 7, 3)->bodies.a.polytope()->vertex(0);
  EXPECT_EQ(stored, scenes::to_single(stored));
}

TEST(Shuffled, EverySolverAsksThePairsThatItTakes) {
  Solvers solvers;
  add_ours(solvers, false, false);
  add_peers_curved(solvers);
  const std::vector<ShuffledRow> rows = run_shuffled({.pairs = 20, .other_megabytes = 1, .seed = 3}, solvers);
  ASSERT_EQ(rows.size(), solvers.size());
  EXPECT_EQ(rows[0].solver, kOurs);
  EXPECT_EQ(rows[0].pairs, 20);
  EXPECT_GT(rows[0].hot_ns, 0);
  EXPECT_GT(rows[0].shuffled_ns, rows[0].hot_ns);
  EXPECT_GT(rows[0].other_data_ns, rows[0].hot_ns);
  for (const ShuffledRow& row : rows) EXPECT_GT(row.pairs, 0) << row.solver;
}

class Judged : public testing::Test {
 protected:
  Judged() : draw_(*draw({PairFamily::sphere, 32, DepthClass::mid}, 1, 0)), bodies_(draw_.bodies) {
    Scratch scratch;
    const PenetrationDepth depth =
        penetration_depth({&draw_.bodies.a, draw_.pose_a}, {&draw_.bodies.b, draw_.pose_b}, scratch);
    right_ = {true, depth.depth, depth.translation};
  }
  [[nodiscard]] bool wrong(const Answer& answer, Precision precision = Precision::binary64) const {
    return Judge(bodies_, draw_.pose_a, draw_.pose_b).judge(answer, precision).wrong;
  }

  Draw draw_;
  JudgedBodies bodies_;
  Answer right_;
};

TEST(Contest, TheFastestPeerThatIsRightEverywhereCounts) {
  const auto row = [](const char* solver, int pairs, double ns, int wrong) {
    Row r{"box", 8, "mid", solver, pairs, ns};
    r.wrong = wrong;
    return r;
  };
  const std::vector<Row> rows = {row("pdepth-auto", 12, 500, 0), row("wrong-once", 12, 100, 1),
                                 row("skips-one", 11, 200, 0), row("slow", 12, 900, 0), row("right", 12, 400, 0)};
  const std::vector<BestPeer> best = best_peers(rows, {"pdepth-auto", {}});
  ASSERT_EQ(best.size(), 1u);
  ASSERT_NE(best[0].peer, nullptr);
  EXPECT_EQ(best[0].peer->solver, "right");
  EXPECT_TRUE(best[0].lost());
  EXPECT_FALSE(best_peers(rows, {"pdepth-auto", {"slow"}})[0].lost());
  EXPECT_EQ(best_peers(rows, {"pdepth-auto", {"absent"}})[0].peer, nullptr);
}

TEST_F(Judged, RightAnswersPass) {
  EXPECT_FALSE(wrong(right_));
  EXPECT_FALSE(wrong(right_, Precision::binary32));
}

TEST_F(Judged, MissedOffAndNotSeparatedAreWrong) {
  EXPECT_TRUE(wrong({}));
  EXPECT_TRUE(wrong({true, right_.depth * 1.002, right_.translation * 1.002}));
  EXPECT_TRUE(wrong({true, right_.depth, -right_.translation}));
  EXPECT_TRUE(wrong({true, std::nan(""), right_.translation}));
}

TEST(AllocationCounter, SeesOperatorNew) {
  const std::int64_t before = allocations();
  const auto kept = std::make_unique<std::vector<double>>(100, 1.0);
  EXPECT_GE(allocations() - before, 1);
  EXPECT_EQ(kept->size(), 100u);
}

}  // namespace
}  // namespace pd::bench
