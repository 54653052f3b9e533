/// @file
/// Every exact engine against the exact oracle, over all families: every promise of the answer, and the bracket to the
/// last bit.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <thread>

#include "bench/agarwal/agarwal.hpp"
#include "oracle/answer_check.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {

namespace {

using scenes::DepthClass;

const Claim kExact{"Exactness",
                   "every answer of every exact engine equals the brute-force oracle; at most 64 vertices"};

constexpr std::array kEngineNames{"auto", "expansion", "overlay", "decomposition", "shallow"};
constexpr std::array kEngineMethods{Method::automatic, Method::expansion, Method::overlay, Method::decomposition,
                                    Method::shallow};
constexpr std::size_t kEngines = kEngineMethods.size();

struct Pair {
  std::string family;
  scenes::Points a;
  scenes::Points b;
  Pose pose_a;
  Pose pose_b;
};

scenes::Points vertices_of(const ConvexPolytope& body) {
  scenes::Points points;
  for (int v = 0; v < body.num_vertices(); ++v) points.push_back(body.vertex(v));
  return points;
}

/// Pair number i is a function of i and the seed alone, whatever thread takes it.
Pair make(std::int64_t i, std::uint64_t seed) {
  const auto families = static_cast<std::int64_t>(scenes::agarwal_families().size());
  scenes::Random random(seed * 0xD1B54A32D192ED03ULL + static_cast<std::uint64_t>(i));
  random.next();
  const auto depth = static_cast<DepthClass>(random.integer(0, scenes::kDepthClasses - 1));
  const std::uint64_t own_seed = seed * 1000000007ULL + static_cast<std::uint64_t>(i);
  const std::int64_t which = i % (scenes::kPairFamilies + families);
  if (which < scenes::kPairFamilies) {
    static constexpr int kSizes[] = {4, 5, 6, 8, 8, 8, 10, 12, 16, 16, 24, 32, 48, 64};
    const auto family = static_cast<scenes::PairFamily>(which);
    scenes::PointPair pair =
        scenes::make_pair(family, kSizes[random.integer(0, static_cast<int>(std::size(kSizes)) - 1)], depth, own_seed);
    return {std::string(to_string(family)), std::move(pair.a), std::move(pair.b), pair.pose_a, pair.pose_b};
  }
  const scenes::AgarwalFamily family =
      scenes::agarwal_families()[static_cast<std::size_t>(which - scenes::kPairFamilies)];
  const bool grid = scenes::is_quadratic(family);
  // 2 m + 10 vertices at most on grids and patches, 2 m - 4 of those with m facets, m of hulls.
  const scenes::PolytopePair pair =
      scenes::make_agarwal_pair(family, random.integer(4, grid ? 27 : 64), depth, own_seed);
  return {std::string(to_string(family)), vertices_of(pair.a), vertices_of(pair.b), pair.pose_a, pair.pose_b};
}

struct Tally {
  std::array<std::int64_t, kEngines> wrong{};
  std::array<std::int64_t, kEngines> brackets_apart{};  ///< not the bits of the first engine's
  std::int64_t overlapping = 0;
};

class Run {
 public:
  Run(std::int64_t pairs, std::uint64_t seed) : pairs_(pairs), seed_(seed) {}

  void work() {
    Scratch scratch;
    Tally own;
    for (std::int64_t i = next_++; i < pairs_; i = next_++) judge_one(i, scratch, own);
    const std::lock_guard lock(mutex_);
    for (std::size_t e = 0; e < kEngines; ++e) {
      tally_.wrong[e] += own.wrong[e];
      tally_.brackets_apart[e] += own.brackets_apart[e];
    }
    tally_.overlapping += own.overlapping;
  }
  [[nodiscard]] const Tally& tally() const { return tally_; }

 private:
  void judge_one(std::int64_t i, Scratch& scratch, Tally& tally) {
    const Pair p = make(i, seed_);
    const ConvexPolytope a = *ConvexPolytope::from_points(p.a), b = *ConvexPolytope::from_points(p.b);
    const ConvexShape shape_a(a), shape_b(b);
    const oracle::Body body_a(p.a), body_b(p.b);
    const oracle::ExactPair pair(body_a, p.pose_a, body_b, p.pose_b);
    const oracle::Verdict verdict = oracle::judge(pair);
    tally.overlapping += verdict.contact == ContactClass::overlapping ? 1 : 0;
    double lower = 0, upper = 0;
    for (std::size_t e = 0; e < kEngines; ++e) {
      const PenetrationDepth answer = penetration_depth({&shape_a, p.pose_a}, {&shape_b, p.pose_b}, scratch,
                                                        {.method = kEngineMethods[e], .bracket = Bracket::tightest});
      const oracle::Findings findings =
          oracle::check_answer(pair, verdict, {&a, &b, &p.pose_a, &p.pose_b, Bracket::tightest}, answer);
      if (!findings.wrong.empty()) {
        ++tally.wrong[e];
        say(i, p, kEngineNames[e], findings.wrong.front());
      }
      if (e == 0) {
        lower = answer.lower;
        upper = answer.upper;
      }
      tally.brackets_apart[e] += answer.lower != lower || answer.upper != upper ? 1 : 0;
    }
  }

  void say(std::int64_t i, const Pair& p, std::string_view engine, const oracle::Breach& breach) {
    const std::lock_guard lock(mutex_);
    if (said_++ < 20) {
      fmt::print("WRONG {} on pair {} ({}): {}: {}\n", engine, i, p.family, oracle::to_string(breach.promise),
                 breach.what);
    }
  }

  std::int64_t pairs_;
  std::uint64_t seed_;
  std::atomic<std::int64_t> next_ = 0;
  std::mutex mutex_;
  Tally tally_;
  int said_ = 0;
};

}  // namespace

void measure_exactness(const AgarwalSettings& settings, ClaimTable& table) {
  const std::int64_t pairs = settings.pairs > 0 ? settings.pairs : settings.quick ? 2000 : 100'000;
  Run run(pairs, settings.seed);
  std::vector<std::thread> threads;
  for (unsigned t = 1; t < std::thread::hardware_concurrency(); ++t) threads.emplace_back([&run] { run.work(); });
  run.work();
  for (std::thread& thread : threads) thread.join();
  const std::string range = fmt::format("{} pairs, {} overlap", pairs, run.tally().overlapping);
  for (std::size_t e = 0; e < kEngines; ++e) {
    const std::string name = fmt::format("all families by {}", kEngineNames[e]);
    table.add_value(kExact, name, std::string(kWrongAnswers), range, static_cast<double>(run.tally().wrong[e]), 0);
    table.add_value(kExact, name, "brackets not those of auto, bit for bit", range,
                    static_cast<double>(run.tally().brackets_apart[e]), 0);
  }
}

}  // namespace pd::bench
