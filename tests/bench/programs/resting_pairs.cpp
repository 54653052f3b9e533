/// @file
/// `resting_pairs`: judges the library on any number of rounded bodies within a hair of contact by the exact oracle.
///
/// Pair number i depends on --seed and i only. One line of the output is enough to make a failing pair again.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include "oracle/contact_check.hpp"
#include "oracle/resting_pair.hpp"

namespace {

struct Counts {
  std::int64_t classes[3] = {};
  std::int64_t wrong = 0;
  std::int64_t missed = 0;     ///< brackets of Bracket::contact wider than asked
  std::int64_t undecided = 0;  ///< the oracle could not certify a distance
  double seconds = 0;          ///< in the library
  double slowest = 0;
};

class Run {
 public:
  Run(std::int64_t pairs, std::uint64_t seed) : pairs_(pairs), seed_(seed) {}

  void work() {
    pd::Scratch scratch;
    Counts own;
    for (std::int64_t i = next_++; i < pairs_; i = next_++) {
      judge_one(seed_ * 1000000007ULL + static_cast<std::uint64_t>(i), scratch, own);
    }
    const std::lock_guard lock(mutex_);
    for (int k = 0; k < 3; ++k) counts_.classes[k] += own.classes[k];
    counts_.wrong += own.wrong;
    counts_.undecided += own.undecided;
    counts_.missed += own.missed;
    counts_.seconds += own.seconds;
    counts_.slowest = std::max(counts_.slowest, own.slowest);
  }

  [[nodiscard]] bool report() const {
    const Counts& c = counts_;
    std::printf("answers: %lld separated, %lld touching, %lld overlapping; %lld wrong, %lld undecided by the oracle\n",
                static_cast<long long>(c.classes[0]), static_cast<long long>(c.classes[1]),
                static_cast<long long>(c.classes[2]), static_cast<long long>(c.wrong),
                static_cast<long long>(c.undecided));
    std::printf("%lld brackets wider than asked\n", static_cast<long long>(c.missed));
    std::printf("mean %.2f us, slowest %.0f us\n", 1e6 / 3 * c.seconds / static_cast<double>(pairs_), 1e6 * c.slowest);
    return c.wrong == 0;
  }

 private:
  void judge_one(std::uint64_t seed, pd::Scratch& scratch, Counts& counts) {
    const pd::oracle::RestingPair rest = pd::oracle::make_resting_pair(seed, scratch);
    const pd::oracle::JudgedPair pair(rest.cores);
    const auto a = pair.a().shape->with_margin(rest.margin_a);
    const auto b = pair.b().shape->with_margin(rest.margin_b);
    pd::PenetrationDepth exact;
    for (const pd::Bracket bracket : {pd::Bracket::tightest, pd::Bracket::certified, pd::Bracket::contact}) {
      pd::DepthSettings settings;
      settings.bracket = bracket;
      const double farthest = std::max(pair.a().pose.translation().norm(), pair.b().pose.translation().norm());
      settings.contact_tolerance = std::ldexp(farthest + 0.01, -30);
      const auto start = std::chrono::steady_clock::now();
      const pd::PenetrationDepth answer =
          penetration_depth({&*a, pair.a().pose}, {&*b, pair.b().pose}, scratch, settings);
      const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      counts.seconds += taken;
      counts.slowest = std::max(counts.slowest, taken);
      ++counts.classes[static_cast<int>(answer.contact)];
      if (bracket == pd::Bracket::tightest) exact = answer;
      const double allowed =
          std::max(2e-14 * (pair.size_of_numbers() + rest.margin_a + rest.margin_b), settings.contact_tolerance);
      const std::string complaint =
          bracket == pd::Bracket::contact
              ? pd::oracle::check_contact({&*a, pair.a().pose}, {&*b, pair.b().pose}, answer, exact, allowed, scratch)
              : pd::oracle::check_rounded(pair, rest.margin_a, rest.margin_b, answer, bracket);
      counts.missed += !answer.bracket_reached;
      if (complaint.empty()) continue;
      if (complaint.starts_with("oracle")) {
        ++counts.undecided;
        continue;
      }
      ++counts.wrong;
      const std::lock_guard lock(mutex_);
      std::printf("WRONG seed=%llu %s: %s\n", static_cast<unsigned long long>(seed),
                  bracket == pd::Bracket::tightest    ? "tightest"
                  : bracket == pd::Bracket::certified ? "certified"
                                                      : "contact",
                  complaint.c_str());
    }
  }

  std::int64_t pairs_;
  std::uint64_t seed_;
  std::atomic<std::int64_t> next_ = 0;
  std::mutex mutex_;
  Counts counts_;
};

}  // namespace

int main(int argc, char** argv) {
  std::int64_t pairs = 20000;
  std::uint64_t seed = 1;
  int threads = 1;
  CLI::App app{"Judges pd::penetration_depth by the exact oracle on rounded bodies within a hair of contact."};
  app.add_option("--pairs", pairs, "number of pairs, each asked tightest, certified and for contact")
      ->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  Run run(pairs, seed);
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back([&run] { run.work(); });
  run.work();
  for (std::thread& t : others) t.join();
  return run.report() ? 0 : 1;
}
