/// @file
/// `derivative_pairs`: judges pd::depth_derivatives by central differences of pd::penetration_depth on any number of
/// random pairs, and its flags on constructed ties.
///
/// Pair number i depends on --seed and i only. Exit status 1 where an error exceeds its bound or a flag is wrong.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "oracle/derivative_cases.hpp"

namespace {

using pd::oracle::DerivativeFamily;

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

struct Options {
  std::int64_t pairs = 10000;
  std::int64_t curved = 1000;
  std::int64_t ties = 10000;
  std::uint64_t seed = 1;
  double gap = 1e-3;
  double step = 1e-5;
  double show_features = 1e300;
};

/// @return pairs beyond the bound.
int judge_family(DerivativeFamily family, const Options& options, pd::Scratch& scratch) {
  const bool curved = family == DerivativeFamily::curved;
  const double bound = curved ? 1e-4 : 1e-6;
  std::vector<double> errors, feature_errors, bent_features;
  std::string kind;
  int wrong = 0;
  std::int64_t flagged = 0, left_out = 0;
  double seconds = 0, query_seconds = 0;
  const auto wanted = static_cast<std::size_t>(curved ? options.curved : options.pairs);
  for (std::uint64_t i = 0; errors.size() < wanted; ++i) {
    const pd::oracle::PosedPairCase pair = pd::oracle::derivative_case(family, options.seed, i);
    kind = pair.kind;
    if (runner_up_within(pair, options.gap, options.step, scratch)) continue;
    const auto judged = judge_gradient(pair, options.step, scratch);
    if (curved && !judged.one_slope) {
      ++left_out;
      continue;
    }
    errors.push_back(judged.gradient_error);
    if (judged.derivatives.stable_features) {
      (judged.one_feature_slope ? feature_errors : bent_features).push_back(judged.feature_error);
    }
    if (judged.feature_error > options.show_features && judged.one_feature_slope) {
      std::printf("FEATURES %s seed=%llu pair=%llu error %.3g\n", kind.c_str(),
                  static_cast<unsigned long long>(options.seed), static_cast<unsigned long long>(i),
                  judged.feature_error);
    }
    const bool flag = !judged.derivatives.unique_direction || !judged.derivatives.unique_witness;
    if (flag) ++flagged;
    // Of curved bodies nobody knows the runner-up: a flag is no mistake there.
    if (judged.gradient_error > bound || (flag && !curved)) {
      ++wrong;
      std::printf("WRONG %s seed=%llu pair=%llu error %.3g flags %d %d\n", kind.c_str(),
                  static_cast<unsigned long long>(options.seed), static_cast<unsigned long long>(i),
                  judged.gradient_error, judged.derivatives.unique_direction, judged.derivatives.unique_witness);
    }
    const auto start = std::chrono::steady_clock::now();
    (void)penetration_depth(pair.posed_a(), pair.posed_b(), scratch);
    const auto between = std::chrono::steady_clock::now();
    (void)depth_derivatives(pair.posed_a(), pair.posed_b(), scratch);
    const auto end = std::chrono::steady_clock::now();
    query_seconds += std::chrono::duration<double>(between - start).count();
    seconds += std::chrono::duration<double>(end - between).count();
  }
  if (errors.empty()) return 0;
  std::printf("%-20s %8zu %8lld %7lld %10.1e %10.1e %8.0e %8zu %8zu %10.1e %10.1e %8.1f %8.1f %6d\n", kind.c_str(),
              errors.size(), static_cast<long long>(left_out), static_cast<long long>(flagged), quantile(errors, .99),
              quantile(errors, 1), bound, feature_errors.size(), bent_features.size(), quantile(feature_errors, .99),
              quantile(feature_errors, 1), 1e6 * query_seconds / static_cast<double>(wanted),
              1e6 * seconds / static_cast<double>(wanted), wrong);
  return wrong;
}

int judge_ties(const Options& options, pd::Scratch& scratch) {
  struct Tally {
    int cases = 0;
    int wrong = 0;
  };
  std::map<std::string, Tally> tallies;
  int wrong = 0;
  for (std::int64_t i = 0; i < options.ties; ++i) {
    const auto tie = pd::oracle::tie_case(options.seed, static_cast<std::uint64_t>(i));
    const auto d = depth_derivatives(tie.pair.posed_a(), tie.pair.posed_b(), scratch);
    const bool right = d.unique_direction == tie.unique_direction && d.unique_witness == tie.unique_witness;
    Tally& tally = tallies[tie.pair.kind];
    ++tally.cases;
    tally.wrong += right ? 0 : 1;
    wrong += right ? 0 : 1;
    if (!right) {
      std::printf("WRONG flags %d %d of tie %lld (%s)\n", d.unique_direction, d.unique_witness,
                  static_cast<long long>(i), tie.pair.kind.c_str());
    }
  }
  std::printf("\n%-50s %7s %11s\n", "tie", "cases", "wrong flags");
  for (const auto& [kind, tally] : tallies) std::printf("%-50s %7d %11d\n", kind.c_str(), tally.cases, tally.wrong);
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Judges pd::depth_derivatives by central differences on random pairs, and its flags on built ties."};
  app.add_option("--pairs", options.pairs, "of each family of polytopes, rounded polytopes, balls")
      ->capture_default_str();
  app.add_option("--curved", options.curved, "pairs with a curved body")->capture_default_str();
  app.add_option("--ties", options.ties)->capture_default_str();
  app.add_option("--seed", options.seed)->capture_default_str();
  app.add_option("--gap", options.gap, "least distance of the runner-up facet from the nearest")->capture_default_str();
  app.add_option("--step", options.step, "of the central differences")->capture_default_str();
  app.add_option("--show-features", options.show_features, "names pairs whose normal and witnesses err by more");
  CLI11_PARSE(app, argc, argv);
  pd::Scratch scratch;
  std::printf("%-20s %8s %8s %7s %10s %10s %8s %8s %8s %10s %10s %8s %8s %6s\n", "family", "pairs", "left out",
              "flagged", "error p99", "error max", "bound", "stable", "bent", "feat. p99", "feat. max", "query us",
              "deriv us", "wrong");
  int wrong = 0;
  for (const auto family :
       {DerivativeFamily::polytopes, DerivativeFamily::rounded, DerivativeFamily::round, DerivativeFamily::curved}) {
    wrong += judge_family(family, options, scratch);
  }
  wrong += judge_ties(options, scratch);
  return wrong > 0 ? 1 : 0;
}
