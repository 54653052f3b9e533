#include "bench/arya/arya.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "bench/agarwal/agarwal.hpp"
#include "bench/measure/table.hpp"
#include "bench/report/bench_report.hpp"
#ifdef PD_BENCH_WITH_RENDER
#include "bench/plots/claim_plots.hpp"
#endif

namespace pd::bench {

namespace {

struct Chapter {
  std::string_view name;
  void (*measure)(const AryaSettings&, ClaimTable&);
};
constexpr Chapter kChapters[] = {
    {"sizes", measure_arya_sizes},     {"promises", measure_arya_promises}, {"theorems", measure_arya_theorems},
    {"kernels", measure_arya_kernels}, {"width", measure_arya_width},       {"intersection", measure_arya_intersection},
    {"queries", measure_arya_queries}, {"macbeath", measure_arya_macbeath}, {"sums", measure_arya_sums},
};

bool write_files(const AryaSettings& settings, const ClaimTable& table) {
  const std::filesystem::path folder(settings.out);
  const std::string preamble = fmt::format(
      "# The bounds of [M], measured\n\nWritten by `pdepth-bench arya{}{}{}{} --seed {} --out ...` on {:%F}. Exponents "
      "are "
      "least-squares "
      "slopes in log-log with their 95 % intervals; times are processor times of the fastest of several runs, in turns "
      "with the peer's. A bound that does not hold says FAILS.\n",
      settings.full ? " --full" : "", settings.pairs > 0 ? fmt::format(" --pairs {}", settings.pairs) : "",
      settings.backend ? fmt::format(" --backend {}", to_string(*settings.backend)) : "",
      settings.chapters.empty() ? "" : fmt::format(" --chapters {}", fmt::join(settings.chapters, ",")), settings.seed,
      fmt::gmtime(std::time(nullptr)));
  const std::vector<Finding> findings = table.by_claim();
  bool written = write_text(folder / "arya.csv", to_csv(findings));
  written = write_text(folder / "arya_points.csv", points_csv(findings)) && written;
  written = write_text(folder / "arya.md", to_markdown(findings, preamble)) && written;
#ifdef PD_BENCH_WITH_RENDER
  written = write_claim_plots(table.findings(), folder) && written;
#else
  fmt::print(stderr, "--out: no plots, this was built without render\n");
#endif
  return written;
}

}  // namespace

std::string arya_chapters() {
  std::string names;
  for (const Chapter& chapter : kChapters) names += (names.empty() ? "" : ", ") + std::string(chapter.name);
  return names;
}

int run_arya(const AryaSettings& settings) {
  const auto named = [&](const Chapter& c) {
    return settings.chapters.empty() ||
           std::find(settings.chapters.begin(), settings.chapters.end(), c.name) != settings.chapters.end();
  };
  for (const std::string& name : settings.chapters) {
    if (std::none_of(std::begin(kChapters), std::end(kChapters), [&](const Chapter& c) { return c.name == name; })) {
      fmt::print(stderr, "--chapters: no chapter of this name: {}\n", name);
      return 2;
    }
  }
  ClaimTable table;
  for (const Chapter& chapter : kChapters) {
    if (named(chapter)) chapter.measure(settings, table);
  }
  fmt::print("\n{} rows, {} bounds fail\n", table.findings().size(), table.failures());
  bool good = settings.out.empty() || write_files(settings, table);
  good = write_report(settings.report, report_of_claims(table, "The bounds of [M], measured")) && good;
  for (const Finding& f : table.findings()) good = good && !(f.counter == kWrongAnswers && f.figure > 0);
  return good ? 0 : 1;
}

}  // namespace pd::bench
