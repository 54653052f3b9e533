/// @file
/// `impact_pairs`: judges pd::time_of_impact on any number of moving pairs by bisection of time to 1e-12.
///
/// Pair number i depends on --seed and i only. Exit status 1 where an answer is wrong or a contact was missed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "oracle/moving_pair.hpp"

namespace {

struct Tally {
  int pairs = 0;
  int hits = 0;
  int grazes = 0;
  int wrong = 0;
  long long queries = 0;
  int most_queries = 0;
  double most_lead = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::int64_t pairs = 10000;
  std::uint64_t seed = 1;
  double tolerance = 1e-9;
  CLI::App app{"Judges pd::time_of_impact by bisection of time on random moving pairs."};
  app.add_option("--pairs", pairs)->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--tolerance", tolerance, "the gap that counts as contact")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::map<std::string, Tally> tallies;
  pd::Scratch scratch;
  int wrong = 0;
  for (std::int64_t i = 0; i < pairs; ++i) {
    const pd::oracle::MovingCase pair = pd::oracle::moving_case(seed, static_cast<std::uint64_t>(i));
    const pd::oracle::ImpactJudgement judged = judge(pair, tolerance, scratch);
    Tally& tally = tallies[pair.family];
    ++tally.pairs;
    tally.hits += judged.reference_hit ? 1 : 0;
    tally.grazes += judged.graze ? 1 : 0;
    tally.queries += judged.answer.queries;
    tally.most_queries = std::max(tally.most_queries, judged.answer.queries);
    tally.most_lead = std::max(tally.most_lead, judged.lead);
    if (!judged.complaint.empty()) {
      ++tally.wrong;
      ++wrong;
      std::printf("WRONG seed=%llu pair=%lld (%s): %s; hit %d time %.17g certified %.17g\n",
                  static_cast<unsigned long long>(seed), static_cast<long long>(i), pair.family.c_str(),
                  judged.complaint.c_str(), judged.answer.hit ? 1 : 0, judged.answer.time, judged.answer.certified);
    }
  }
  std::printf("%-36s %7s %7s %7s %6s %13s %6s %10s\n", "family", "pairs", "hits", "grazes", "wrong", "queries, mean",
              "most", "lead, s");
  for (const auto& [family, tally] : tallies) {
    std::printf("%-36s %7d %7d %7d %6d %13.2f %6d %10.2g\n", family.c_str(), tally.pairs, tally.hits, tally.grazes,
                tally.wrong, static_cast<double>(tally.queries) / tally.pairs, tally.most_queries, tally.most_lead);
  }
  return wrong == 0 ? 0 : 1;
}
