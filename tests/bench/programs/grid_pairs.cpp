/// @file
/// `grid_pairs`: judges the library on pairs of small bodies on the integer grid by the hundred million.
///
/// The bodies are built once (`oracle/grid_pool.hpp`); pair number i of a seed is the same on any number of threads,
/// and the oracle decides it in whole numbers of 16 bits (`oracle/grid_oracle.hpp`). The brackets take turns; every
/// pair is asked cold, one in `--laws` also swapped and with its points in another order. The first broken promise of
/// each kind is printed as a line of the protocol, which `pdepth query` answers with `tightest`.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "bench/programs/pair_progress.hpp"
#include "oracle/grid_answer_check.hpp"
#include "oracle/grid_pool.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace {

namespace grid = pd::oracle::grid;

constexpr std::array<pd::Bracket, 3> kBrackets{pd::Bracket::tightest, pd::Bracket::certified, pd::Bracket::contact};
constexpr std::array<const char*, 3> kBracketNames{"tightest", "certified", "contact"};
/// Pairs of kinds, the larger one first: row k (k + 1) / 2 + l.
constexpr std::size_t kRows = grid::kKinds * (grid::kKinds + 1) / 2;

struct Settings {
  std::int64_t pairs = 1000000;
  std::int64_t first = 0;
  double seconds = 0;
  int pool = 6000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::vector<std::string> brackets;
  int laws = 8;
};

struct Tally {
  std::int64_t pairs = 0;
  std::array<std::int64_t, 3> classes{};  ///< separated, touching, overlapping
  std::int64_t flat = 0;                  ///< P lies in a plane
  std::int64_t far = 0;                   ///< stand 2^20 units from the origin, or farther
  std::int64_t next = 0;                  ///< upper is the double after the depth rounded up
  std::int64_t wrong = 0;

  void add(const Tally& t) {
    pairs += t.pairs;
    for (std::size_t k = 0; k < 3; ++k) classes[k] += t.classes[k];
    flat += t.flat;
    far += t.far;
    next += t.next;
    wrong += t.wrong;
  }
};

struct Totals {
  std::array<Tally, kRows> rows{};
  std::array<Tally, kBrackets.size()> brackets{};
  std::array<std::int64_t, grid::kPromises> breaches{};
  std::int64_t laws = 0;  ///< pairs asked swapped and reordered, too
  double seconds = 0;     ///< of processor time

  void add(const Totals& t) {
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].add(t.rows[k]);
    for (std::size_t k = 0; k < brackets.size(); ++k) brackets[k].add(t.brackets[k]);
    for (std::size_t k = 0; k < breaches.size(); ++k) breaches[k] += t.breaches[k];
    laws += t.laws;
    seconds += t.seconds;
  }
};

class Run {
 public:
  Run(const Settings& settings, std::vector<std::size_t> brackets)
      : settings_(settings), brackets_(std::move(brackets)), pool_(settings.pool, settings.seed) {}

  void work() {
    pd::Scratch scratch;
    grid::Judge judge;
    Totals own;
    const double start = pd::bench::processor_seconds();
    constexpr std::int64_t kBatch = 4096;
    while (!out_of_time()) {
      const std::int64_t from = next_.fetch_add(kBatch);
      if (from >= settings_.pairs) break;
      const std::int64_t to = std::min(from + kBatch, settings_.pairs);
      for (std::int64_t i = from; i < to; ++i) judge_one(settings_.first + i, scratch, judge, own);
      progress_.add(to - from);
    }
    own.seconds = pd::bench::processor_seconds() - start;
    const std::lock_guard lock(mutex_);
    totals_.add(own);
  }

  /// The number of wrong pairs.
  [[nodiscard]] std::int64_t print_table() const {
    std::printf("| kinds | pairs | separated | touching | overlapping | flat P | far out | upper next | wrong |\n");
    std::printf("|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
    for (int k = 0; k < grid::kKinds; ++k) {
      for (int l = 0; l <= k; ++l) {
        const std::string name = std::string(to_string(static_cast<grid::Kind>(l))) + ", " +
                                 std::string(to_string(static_cast<grid::Kind>(k)));
        print_row(name, totals_.rows[row_of(k, l)]);
      }
    }
    Tally all;
    for (std::size_t k = 0; k < kBrackets.size(); ++k) {
      print_row(std::string("all, ") + kBracketNames[k], totals_.brackets[k]);
      all.add(totals_.brackets[k]);
    }
    print_row("all", all);
    std::printf("\nlaws (swapped, reordered): %lld pairs\nbroken promises:", static_cast<long long>(totals_.laws));
    for (std::size_t k = 0; k < totals_.breaches.size(); ++k) {
      std::printf(" %s %lld", std::string(to_string(static_cast<grid::Promise>(k))).c_str(),
                  static_cast<long long>(totals_.breaches[k]));
    }
    std::printf("\nprocessor time: %.0f s, %.2f us a pair\n", totals_.seconds,
                1e6 * totals_.seconds / static_cast<double>(std::max<std::int64_t>(all.pairs, 1)));
    return all.wrong;
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool out_of_time() const {
    return settings_.seconds > 0 && std::chrono::duration<double>(Clock::now() - start_).count() > settings_.seconds;
  }

  static std::size_t row_of(int k, int l) {
    const int high = std::max(k, l);
    return static_cast<std::size_t>(high * (high + 1) / 2 + std::min(k, l));
  }

  static void print_row(const std::string& name, const Tally& t) {
    if (t.pairs == 0) return;
    std::printf("| %s | %lld | %lld | %lld | %lld | %lld | %lld | %lld | %lld |\n", name.c_str(),
                static_cast<long long>(t.pairs), static_cast<long long>(t.classes[0]),
                static_cast<long long>(t.classes[1]), static_cast<long long>(t.classes[2]),
                static_cast<long long>(t.flat), static_cast<long long>(t.far), static_cast<long long>(t.next),
                static_cast<long long>(t.wrong));
  }

  void judge_one(std::int64_t i, pd::Scratch& scratch, grid::Judge& judge, Totals& own) {
    const grid::DrawnPair pair = pool_.draw(settings_.seed, i);
    const std::size_t which = brackets_[static_cast<std::size_t>(i) % brackets_.size()];
    const pd::DepthSettings settings{.bracket = kBrackets[which], .contact_tolerance = grid::kContactTolerance};
    const auto ask = [&](const pd::ConvexShape& a, const pd::Pose& pose_a, const pd::ConvexShape& b,
                         const pd::Pose& pose_b) {
      return pd::penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, settings);
    };
    const pd::PenetrationDepth answer = ask(pair.a->shape, pair.pose_a, pair.b->shape, pair.pose_b);
    const grid::Verdict& verdict = judge.judge(pair.placed_a, pair.placed_b);
    const grid::Question question{pair.placed_a, pair.placed_b, pair.a->shape.polytope(), pair.b->shape.polytope(),
                                  kBrackets[which]};
    grid::Findings findings = grid::check_answer(judge, verdict, question, answer);
    std::vector<grid::Breach>& wrong = findings.wrong;
    if (settings_.laws > 0 && (i / static_cast<std::int64_t>(brackets_.size())) % settings_.laws == 0) {
      ++own.laws;
      const auto append = [&](std::vector<grid::Breach> more) { wrong.insert(wrong.end(), more.begin(), more.end()); };
      append(grid::check_swapped(judge, answer, ask(pair.b->shape, pair.pose_b, pair.a->shape, pair.pose_a)));
      append(grid::check_reordered(answer, ask(pair.a->reordered, pair.pose_a, pair.b->reordered, pair.pose_b)));
    }
    Tally one;
    one.pairs = 1;
    one.classes[static_cast<std::size_t>(verdict.contact)] = 1;
    one.flat = verdict.flat_difference;
    one.far = std::any_of(pair.placed_a.at.translation.begin(), pair.placed_a.at.translation.end(),
                          [](std::int64_t t) { return std::abs(t) >= std::int64_t{1} << 20; });
    one.next = findings.upper_is_next;
    one.wrong = !wrong.empty();
    own.rows[row_of(static_cast<int>(pair.a->kind), static_cast<int>(pair.b->kind))].add(one);
    own.brackets[which].add(one);
    for (const grid::Breach& w : wrong) ++own.breaches[static_cast<std::size_t>(w.promise)];
    if (!wrong.empty()) report(i, which, pair, wrong);
  }

  void report(std::int64_t i, std::size_t which, const grid::DrawnPair& pair, const std::vector<grid::Breach>& wrong) {
    const std::lock_guard lock(mutex_);
    bool show = false;
    std::string what;
    for (const grid::Breach& w : wrong) {
      bool& shown = shown_[which][static_cast<std::size_t>(w.promise)];
      show = show || !shown;
      shown = true;
      what += (what.empty() ? "" : "; ") + std::string(to_string(w.promise)) + ": " + w.what;
    }
    if (!show) return;
    std::printf("WRONG pair %lld, %s: %s\n%s\n", static_cast<long long>(i), kBracketNames[which], what.c_str(),
                grid::protocol_line(pair).c_str());
    std::fflush(stdout);
  }

  const Settings& settings_;
  const std::vector<std::size_t> brackets_;
  const grid::Pool pool_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::int64_t> next_ = 0;
  pd::bench::PairProgress progress_{settings_.pairs};
  std::mutex mutex_;
  Totals totals_;
  std::array<std::array<bool, grid::kPromises>, kBrackets.size()> shown_{};
};

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Judges pd::penetration_depth by the grid oracle over pairs of small bodies of whole numbers."};
  app.add_option("--pairs", settings.pairs, "number of pairs")->capture_default_str();
  app.add_option("--first", settings.first, "number of the first pair")->capture_default_str();
  app.add_option("--seconds", settings.seconds, "begin no further pairs after this time; 0: no limit")
      ->capture_default_str();
  app.add_option("--pool", settings.pool, "bodies that pairs are drawn from")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", settings.seed)->capture_default_str();
  app.add_option("--threads", settings.threads)->capture_default_str();
  app.add_option("--brackets", settings.brackets, "that take turns (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({"tightest", "certified", "contact"}));
  app.add_option("--laws", settings.laws, "one pair in this many is asked swapped and reordered, too; 0: none")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::vector<std::size_t> brackets;
  for (std::size_t k = 0; k < kBrackets.size(); ++k) {
    const auto& names = settings.brackets;
    if (names.empty() || std::find(names.begin(), names.end(), kBracketNames[k]) != names.end()) brackets.push_back(k);
  }
  std::printf("seed %llu, pairs %lld to %lld, pool %d\n\n", static_cast<unsigned long long>(settings.seed),
              static_cast<long long>(settings.first), static_cast<long long>(settings.first + settings.pairs - 1),
              settings.pool);
  Run run(settings, std::move(brackets));
  pd::bench::on_threads(settings.threads, [&run] { run.work(); });
  return run.print_table() == 0 ? 0 : 1;
}
