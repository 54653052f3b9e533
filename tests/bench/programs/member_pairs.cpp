/// @file
/// `member_pairs`: judges the answers of any number of pairs of all kinds of shapes by laws: witnesses and points of
/// manifolds lie on both bodies, powers of two scale every bit, swaps and rigid motions keep the depth.
///
/// Pair number i depends on --seed and i only. One line of the output is enough to make a failing pair again.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <string>
#include <vector>

#include "bench/programs/pair_progress.hpp"
#include "oracle/member_laws.hpp"

namespace {

using pd::oracle::BrokenLaw;
using pd::oracle::kMemberLaws;
using pd::oracle::MemberCounts;
using pd::oracle::MemberJudge;
using pd::oracle::MemberPair;

class Run {
 public:
  Run(std::int64_t pairs, std::uint64_t seed, int examples)
      : pairs_(pairs), seed_(seed), examples_(examples), progress_(pairs) {}

  void work() {
    MemberJudge judge;
    constexpr std::int64_t kBlock = 64;
    for (std::int64_t first = next_.fetch_add(kBlock); first < pairs_; first = next_.fetch_add(kBlock)) {
      const std::int64_t last = std::min(first + kBlock, pairs_);
      for (std::int64_t i = first; i < last; ++i) judge_one(i, judge);
      progress_.add(last - first);
    }
    const std::lock_guard lock(mutex_);
    add(judge.counts());
  }

  [[nodiscard]] bool report() const {
    const auto whole = [](std::int64_t x) { return static_cast<long long>(x); };
    std::printf("%lld pairs: %lld separated, %lld touching, %lld overlapping; %lld points of manifolds\n",
                whole(pairs_), whole(counts_.classes[0]), whole(counts_.classes[1]), whole(counts_.classes[2]),
                whole(counts_.manifold_points));
    std::printf(
        "worst, of the size: witness %.2g off, point of a manifold %.2g off, brackets %.2g apart after a motion\n",
        counts_.worst_witness, counts_.worst_manifold, counts_.widest_motion);
    std::printf("broken laws:");
    std::int64_t all = 0;
    for (std::size_t k = 0; k < kMemberLaws; ++k) {
      std::printf(" %s %lld", std::string(to_string(static_cast<pd::oracle::MemberLaw>(k))).c_str(), whole(broken_[k]));
      all += broken_[k];
    }
    std::printf("\n");
    return all == 0;
  }

 private:
  void judge_one(std::int64_t i, MemberJudge& judge) {
    const std::uint64_t seed = seed_ * 1000000007ULL + static_cast<std::uint64_t>(i);
    const MemberPair pair = pd::oracle::make_member_pair(seed);
    static constexpr std::array<pd::Bracket, 3> kBrackets{pd::Bracket::tightest, pd::Bracket::certified,
                                                          pd::Bracket::contact};
    pd::DepthSettings settings;
    settings.bracket = kBrackets[seed % kBrackets.size()];
    const std::vector<BrokenLaw> broken = judge.judge(pair.posed_a(), pair.posed_b(), settings, seed);
    if (broken.empty()) return;
    const std::lock_guard lock(mutex_);
    for (const BrokenLaw& b : broken) {
      if (broken_[static_cast<std::size_t>(b.law)]++ >= examples_) continue;
      std::printf("BROKEN %s, seed %llu, bracket %d, law of %s: %s\n", pair.name.c_str(),
                  static_cast<unsigned long long>(seed), static_cast<int>(settings.bracket),
                  std::string(to_string(b.law)).c_str(), b.what.c_str());
    }
  }

  void add(const MemberCounts& own) {
    for (std::size_t k = 0; k < own.classes.size(); ++k) counts_.classes[k] += own.classes[k];
    counts_.manifold_points += own.manifold_points;
    counts_.worst_witness = std::max(counts_.worst_witness, own.worst_witness);
    counts_.worst_manifold = std::max(counts_.worst_manifold, own.worst_manifold);
    counts_.widest_motion = std::max(counts_.widest_motion, own.widest_motion);
  }

  std::int64_t pairs_;
  std::uint64_t seed_;
  int examples_;
  pd::bench::PairProgress progress_;
  std::atomic<std::int64_t> next_ = 0;
  std::mutex mutex_;
  MemberCounts counts_;
  std::array<std::int64_t, kMemberLaws> broken_{};
};

}  // namespace

int main(int argc, char** argv) {
  std::int64_t pairs = 2000;
  std::uint64_t seed = 1;
  int threads = 1, examples = 5;
  CLI::App app{"Judges pd::penetration_depth and pd::contact_manifold by laws, over pairs of all kinds of shapes."};
  app.add_option("--pairs", pairs, "number of pairs")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str();
  app.add_option("--examples", examples, "broken pairs shown of each law")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  Run run(pairs, seed, examples);
  pd::bench::on_threads(threads, [&run] { run.work(); });
  return run.report() ? 0 : 1;
}
