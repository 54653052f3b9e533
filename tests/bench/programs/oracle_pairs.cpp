/// @file
/// `oracle_pairs`: judges the library on any number of generated pairs by the exact oracle, and counts.
///
/// Pair number i has a family, a size, a depth class and a seed that depend on i and --seed only, so that a run is the
/// same on any number of threads, and one line of the output is enough to make a failing pair again.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "bench/programs/pair_progress.hpp"
#include "oracle/answer_check.hpp"
#include "oracle/corpus.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace {

using pd::ContactClass;
using pd::scenes::DepthClass;
using pd::scenes::PairFamily;
using Clock = std::chrono::steady_clock;

struct Settings {
  std::int64_t pairs = 20000;
  std::vector<std::string> families;
  std::uint64_t seed = 1;
  int threads = 1;
  std::string method = "auto";
  std::string bracket = "tightest";
  int size = 0;
  double large_share = 0.0;
  std::string dump = "oracle_failures.json";
  int examples = 3;
};

struct Tally {
  std::int64_t pairs = 0;
  std::array<std::int64_t, 3> classes{};  ///< separated, touching, overlapping
  std::int64_t wrong = 0;
  std::int64_t undecided = 0;
  std::int64_t large = 0;  ///< both hulls have at least 512 vertices
  double worst_width = 0;
  std::int64_t filtered = 0;  ///< pairs that no decision of left the floating-point filter
  std::int64_t exact_signs = 0;
  double engine_seconds = 0;
  double oracle_seconds = 0;
  std::array<std::int64_t, pd::oracle::kPromises> breaches{};

  void add(const Tally& t) {
    pairs += t.pairs;
    for (std::size_t k = 0; k < 3; ++k) classes[k] += t.classes[k];
    wrong += t.wrong;
    undecided += t.undecided;
    large += t.large;
    worst_width = std::max(worst_width, t.worst_width);
    filtered += t.filtered;
    exact_signs += t.exact_signs;
    engine_seconds += t.engine_seconds;
    oracle_seconds += t.oracle_seconds;
    for (std::size_t k = 0; k < breaches.size(); ++k) breaches[k] += t.breaches[k];
  }
};

struct Task {
  PairFamily family;
  DepthClass depth;
  int n;
  std::uint64_t seed;
};

/// Families whose bodies keep all their n points as vertices.
constexpr PairFamily kLargeFamilies[] = {PairFamily::sphere, PairFamily::needle, PairFamily::patch, PairFamily::roofs};

class Run {
 public:
  Run(const Settings& settings, std::vector<PairFamily> families)
      : settings_(settings), families_(std::move(families)) {
    depth_settings_.method = settings.method == "expansion"       ? pd::Method::expansion
                             : settings.method == "overlay"       ? pd::Method::overlay
                             : settings.method == "decomposition" ? pd::Method::decomposition
                                                                  : pd::Method::automatic;
    depth_settings_.bracket = settings.bracket == "tightest" ? pd::Bracket::tightest : pd::Bracket::certified;
  }

  void work() {
    pd::Scratch scratch;
    std::array<Tally, pd::scenes::kPairFamilies> own{};
    for (;;) {
      const std::int64_t first = next_.fetch_add(64);
      if (first >= settings_.pairs) break;
      const std::int64_t last = std::min(first + 64, settings_.pairs);
      for (std::int64_t i = first; i < last; ++i) {
        const Task task = make_task(i);
        judge_one(task, scratch, own[static_cast<std::size_t>(task.family)]);
      }
      progress_.add(last - first);
    }
    const std::lock_guard lock(mutex_);
    for (std::size_t f = 0; f < own.size(); ++f) tallies_[f].add(own[f]);
  }

  [[nodiscard]] std::int64_t print_table() const {
    std::printf("%-20s %9s %9s %9s %9s %6s %9s %7s %9s %9s %9s %9s %9s\n", "family", "pairs", "separated", "touching",
                "overlap", "wrong", "undecided", ">=512", "width/L", "filtered%", "exact/pr", "engine us", "oracle us");
    Tally all;
    for (int f = 0; f < pd::scenes::kPairFamilies; ++f) {
      const Tally& t = tallies_[static_cast<std::size_t>(f)];
      if (t.pairs == 0) continue;
      print_row(std::string(pd::scenes::to_string(static_cast<PairFamily>(f))), t);
      all.add(t);
    }
    print_row("all", all);
    std::printf("broken promises:");
    for (std::size_t k = 0; k < all.breaches.size(); ++k) {
      std::printf(" %s %lld", std::string(to_string(static_cast<pd::oracle::Promise>(k))).c_str(),
                  static_cast<long long>(all.breaches[k]));
    }
    std::printf("\n");
    return all.wrong;
  }

 private:
  static void print_row(const std::string& name, const Tally& t) {
    const auto count = static_cast<double>(std::max<std::int64_t>(t.pairs, 1));
    std::printf(
        "%-20s %9lld %9lld %9lld %9lld %6lld %9lld %7lld %9.2e %9.3f %9.3f %9.2f %9.2f\n", name.c_str(),
        static_cast<long long>(t.pairs), static_cast<long long>(t.classes[0]), static_cast<long long>(t.classes[1]),
        static_cast<long long>(t.classes[2]), static_cast<long long>(t.wrong), static_cast<long long>(t.undecided),
        static_cast<long long>(t.large), t.worst_width, 100 * static_cast<double>(t.filtered) / count,
        static_cast<double>(t.exact_signs) / count, 1e6 * t.engine_seconds / count, 1e6 * t.oracle_seconds / count);
  }

  [[nodiscard]] Task make_task(std::int64_t i) const {
    pd::scenes::Random random(settings_.seed * 0xD1B54A32D192ED03ULL + static_cast<std::uint64_t>(i));
    random.next();
    static constexpr int kSizes[] = {4, 5, 6, 8, 8, 8, 10, 12, 16, 16, 24, 32, 48, 64};
    Task task{families_[static_cast<std::size_t>(i) % families_.size()],
              static_cast<DepthClass>(random.integer(0, pd::scenes::kDepthClasses - 1)),
              kSizes[random.integer(0, static_cast<int>(std::size(kSizes)) - 1)],
              settings_.seed * 1000000007ULL + static_cast<std::uint64_t>(i)};
    if (random.uniform() < 0.01) task.n = 128;
    if (settings_.size > 0) task.n = settings_.size;
    if (random.uniform() < settings_.large_share) {
      task.family = kLargeFamilies[random.integer(0, static_cast<int>(std::size(kLargeFamilies)) - 1)];
      task.n = 520;
    }
    return task;
  }

  void judge_one(const Task& task, pd::Scratch& scratch, Tally& tally) {
    const pd::scenes::PointPair p = pd::scenes::make_pair(task.family, task.n, task.depth, task.seed);
    const auto a = pd::ConvexPolytope::from_points(p.a);
    const auto b = pd::ConvexPolytope::from_points(p.b);
    ++tally.pairs;
    if (!a || !b) {
      ++tally.wrong;
      const std::string& message = a ? b.error().message : a.error().message;
      report(task, p, {{{pd::oracle::Promise::finite, "hull refused: " + message}}, 0}, nullptr);
      return;
    }
    const pd::ConvexShape shape_a(*a);
    const pd::ConvexShape shape_b(*b);
    const auto t0 = Clock::now();
    const pd::PenetrationDepth answer =
        pd::penetration_depth({&shape_a, p.pose_a}, {&shape_b, p.pose_b}, scratch, depth_settings_);
    const auto t1 = Clock::now();
    const pd::oracle::Body body_a(p.a);
    const pd::oracle::Body body_b(p.b);
    const pd::oracle::ExactPair pair(body_a, p.pose_a, body_b, p.pose_b);
    const pd::oracle::Verdict verdict = pd::oracle::judge(pair);
    const pd::oracle::Findings findings =
        pd::oracle::check_answer(pair, verdict, {&*a, &*b, &p.pose_a, &p.pose_b, depth_settings_.bracket}, answer);
    const auto t2 = Clock::now();
    ++tally.classes[static_cast<std::size_t>(verdict.contact)];
    const bool undecided = verdict.contact == ContactClass::separated && !verdict.distance_known;
    tally.undecided += undecided;
    for (const pd::oracle::Breach& w : findings.wrong) ++tally.breaches[static_cast<std::size_t>(w.promise)];
    tally.large += a->num_vertices() >= 512 && b->num_vertices() >= 512;
    tally.worst_width = std::max(tally.worst_width, findings.relative_width);
    tally.filtered += answer.statistics.exact_signs == 0;
    tally.exact_signs += answer.statistics.exact_signs;
    tally.engine_seconds += std::chrono::duration<double>(t1 - t0).count();
    tally.oracle_seconds += std::chrono::duration<double>(t2 - t1).count();
    if (!findings.wrong.empty()) {
      tally.wrong += !undecided || findings.wrong.size() > 1;
      report(task, p, findings, &verdict);
    }
  }

  void report(const Task& task, const pd::scenes::PointPair& p, const pd::oracle::Findings& findings,
              const pd::oracle::Verdict* verdict) {
    const std::lock_guard lock(mutex_);
    // A few of each kind of each family are enough to work on.
    bool show = false;
    std::string what;
    for (const pd::oracle::Breach& w : findings.wrong) {
      int& shown = shown_[static_cast<std::size_t>(task.family)][static_cast<std::size_t>(w.promise)];
      show = show || shown < settings_.examples;
      ++shown;
      what += (what.empty() ? "" : "; ") + std::string(to_string(w.promise)) + ": " + w.what;
    }
    if (!show) return;
    const std::string name = std::string(pd::scenes::to_string(task.family)) + " n=" + std::to_string(task.n) + " " +
                             std::string(pd::scenes::to_string(task.depth)) + " seed=" + std::to_string(task.seed);
    std::printf("WRONG %s: %s\n", name.c_str(), what.c_str());
    std::fflush(stdout);
    pd::oracle::PairText text =
        pd::oracle::describe(name, std::string(pd::scenes::to_string(task.family)), p.a, p.pose_a, p.b, p.pose_b);
    if (verdict != nullptr) {
      text.contact = std::string(pd::to_string(verdict->contact));
      const bool overlapping = verdict->contact == ContactClass::overlapping;
      const double value = overlapping ? -verdict->depth.approximate() : verdict->distance.approximate();
      std::array<char, 40> buffer{};
      std::snprintf(buffer.data(), buffer.size(), "%.17g", value);
      text.signed_distance_text = buffer.data();
    }
    pd::oracle::append_pair(settings_.dump, text, what);
  }

  const Settings& settings_;
  std::vector<PairFamily> families_;
  pd::DepthSettings depth_settings_;
  std::atomic<std::int64_t> next_ = 0;
  pd::bench::PairProgress progress_{settings_.pairs};
  std::mutex mutex_;
  std::array<Tally, pd::scenes::kPairFamilies> tallies_{};
  std::array<std::array<int, pd::oracle::kPromises>, pd::scenes::kPairFamilies> shown_{};
};

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Judges pd::penetration_depth by the exact oracle over generated families of pairs."};
  app.add_option("--pairs", settings.pairs, "number of pairs")->capture_default_str();
  app.add_option("--families", settings.families, "names of families (default: all)")->delimiter(',');
  app.add_option("--seed", settings.seed)->capture_default_str();
  app.add_option("--threads", settings.threads)->capture_default_str();
  app.add_option("--method", settings.method)
      ->check(CLI::IsMember({"auto", "expansion", "overlay", "decomposition"}))
      ->capture_default_str();
  app.add_option("--bracket", settings.bracket)->check(CLI::IsMember({"certified", "tightest"}))->capture_default_str();
  app.add_option("--size", settings.size, "points a body (default: a mixture of 4 to 128)");
  app.add_option("--large-share", settings.large_share, "share of pairs with at least 512 vertices on each side")
      ->capture_default_str();
  app.add_option("--dump", settings.dump, "file that failing pairs are appended to")->capture_default_str();
  app.add_option("--examples", settings.examples, "failing pairs shown and dumped of each kind and family")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::vector<PairFamily> families;
  for (int f = 0; f < pd::scenes::kPairFamilies; ++f) {
    const auto family = static_cast<PairFamily>(f);
    const auto named = [&](const std::string& name) { return name == pd::scenes::to_string(family); };
    if (settings.families.empty() || std::any_of(settings.families.begin(), settings.families.end(), named)) {
      families.push_back(family);
    }
  }
  if (families.empty()) {
    std::fprintf(stderr, "no family of that name\n");
    return 2;
  }
  std::printf("seed %llu, method %s, bracket %s\n", static_cast<unsigned long long>(settings.seed),
              settings.method.c_str(), settings.bracket.c_str());
  Run run(settings, families);
  pd::bench::on_threads(settings.threads, [&run] { run.work(); });
  return run.print_table() == 0 ? 0 : 1;
}
