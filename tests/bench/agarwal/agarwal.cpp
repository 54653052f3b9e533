#include "bench/agarwal/agarwal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "bench/measure/processor_time.hpp"
#include "bench/measure/table.hpp"
#include "bench/report/bench_report.hpp"
#ifdef PD_BENCH_WITH_RENDER
#include "bench/plots/claim_plots.hpp"
#endif

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;

struct Chapter {
  std::string_view name;
  void (*measure)(const AgarwalSettings&, ClaimTable&);
};
constexpr Chapter kChapters[] = {
    {"sizes", measure_sizes},
    {"search", measure_search},
    {"decomposition", measure_decomposition},
    {"approximate", measure_approximate},
    {"shallow", measure_shallow},
    {"non_convex", measure_non_convex},
    {"roofs", measure_roofs},
    {"exactness", measure_exactness},
};

constexpr AgarwalFamily kSmooth[] = {AgarwalFamily::lens, AgarwalFamily::patch, AgarwalFamily::low_patch,
                                     AgarwalFamily::flat_patch};
constexpr AgarwalFamily kTilted[] = {AgarwalFamily::tilt_noise, AgarwalFamily::low_tilt_noise,
                                     AgarwalFamily::flat_tilt_noise};

bool asked_for(const AgarwalSettings& settings, std::string_view name) {
  return settings.chapters.empty() ||
         std::find(settings.chapters.begin(), settings.chapters.end(), name) != settings.chapters.end();
}

std::string preamble(const AgarwalSettings& settings) {
  return fmt::format(
      "# The bounds of [A], measured\n\n"
      "Written by `pdepth-bench agarwal{} --seed {} --out ...`. Exponents are least-squares slopes in log-log with "
      "their "
      "95 % intervals (Student's t); times are processor times of the fastest of several runs, in turns. A bound that "
      "does not hold says FAILS.\n",
      settings.quick ? " --quick" : "", settings.seed);
}

bool write_files(const AgarwalSettings& settings, const ClaimTable& table) {
  const std::filesystem::path folder(settings.out);
  const std::vector<Finding> findings = table.by_claim();
  bool written = write_text(folder / "agarwal.csv", to_csv(findings));
  written = write_text(folder / "agarwal_points.csv", points_csv(findings)) && written;
  written = write_text(folder / "agarwal.md", to_markdown(findings, preamble(settings))) && written;
#ifdef PD_BENCH_WITH_RENDER
  written = write_claim_plots(table.findings(), folder) && written;
#else
  fmt::print(stderr, "--out: no plots, this was built without render\n");
#endif
  return written;
}

}  // namespace

std::string agarwal_chapters() {
  std::string names;
  for (const Chapter& chapter : kChapters) names += (names.empty() ? "" : ", ") + std::string(chapter.name);
  return names;
}

std::vector<double> least_times_ns(std::span<const std::function<void()>> tasks, int rounds, bool warm_up) {
  std::vector<double> least(tasks.size(), std::numeric_limits<double>::infinity());
  if (warm_up) {
    for (const auto& task : tasks) task();
  }
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      const double begin = processor_seconds();
      tasks[k]();
      least[k] = std::min(least[k], 1e9 * (processor_seconds() - begin));
    }
  }
  return least;
}

std::vector<int> doublings(int low, int high) {
  std::vector<int> sizes;
  for (int m = low; m <= high; m *= 2) sizes.push_back(m);
  return sizes;
}

std::span<const AgarwalFamily> smooth_families() { return kSmooth; }
std::span<const AgarwalFamily> tilted_families() { return kTilted; }

int run_agarwal(const AgarwalSettings& settings) {
  for (const std::string& name : settings.chapters) {
    if (std::none_of(std::begin(kChapters), std::end(kChapters), [&](const Chapter& c) { return c.name == name; })) {
      fmt::print(stderr, "--chapters: no chapter of this name: {}\n", name);
      return 2;
    }
  }
  ClaimTable table;
  for (const Chapter& chapter : kChapters) {
    if (asked_for(settings, chapter.name)) chapter.measure(settings, table);
  }
  fmt::print("\n{} rows, {} bounds fail\n", table.findings().size(), table.failures());
  bool good = settings.out.empty() || write_files(settings, table);
  good = write_report(settings.report, report_of_claims(table, "The bounds of [A], measured")) && good;
  for (const Finding& f : table.findings()) good = good && !(f.counter == kWrongAnswers && f.figure > 0);
  return good ? 0 : 1;
}

}  // namespace pd::bench
