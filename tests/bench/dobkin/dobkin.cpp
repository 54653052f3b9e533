#include "bench/dobkin/dobkin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "bench/agarwal/agarwal.hpp"
#include "bench/measure/table.hpp"
#include "bench/report/bench_report.hpp"

namespace pd::bench {

namespace {

struct Chapter {
  std::string_view name;
  void (*measure)(const DobkinSettings&, ClaimTable&);
};
constexpr Chapter kChapters[] = {
    {"hierarchy", measure_hierarchy}, {"convex", measure_convex_polygons},    {"searches", measure_searches},
    {"climb", measure_against_climb}, {"boundary", measure_polygon_boundary}, {"rays", measure_polygon_rays},
};

bool write_files(const DobkinSettings& settings, const ClaimTable& table) {
  const std::filesystem::path folder(settings.out);
  const std::string preamble = fmt::format(
      "# The bounds of [D], measured\n\nWritten by `pdepth-bench dobkin{} --seed {} --out ...`. Exponents are "
      "least-squares slopes in log-log with their 95 % intervals. A bound that does not hold says FAILS.\n",
      settings.full ? " --full" : "", settings.seed);
  const std::vector<Finding> findings = table.by_claim();
  bool written = write_text(folder / "dobkin.csv", to_csv(findings));
  written = write_text(folder / "dobkin_points.csv", points_csv(findings)) && written;
  return write_text(folder / "dobkin.md", to_markdown(findings, preamble)) && written;
}

}  // namespace

std::string dobkin_chapters() {
  std::string names;
  for (const Chapter& chapter : kChapters) names += (names.empty() ? "" : ", ") + std::string(chapter.name);
  return names;
}

int run_dobkin(const DobkinSettings& settings) {
  for (const std::string& name : settings.chapters) {
    if (std::none_of(std::begin(kChapters), std::end(kChapters), [&](const Chapter& c) { return c.name == name; })) {
      fmt::print(stderr, "--chapters: no chapter of this name: {}\n", name);
      return 2;
    }
  }
  ClaimTable table;
  for (const Chapter& chapter : kChapters) {
    const auto& asked = settings.chapters;
    if (asked.empty() || std::find(asked.begin(), asked.end(), chapter.name) != asked.end()) {
      chapter.measure(settings, table);
    }
  }
  fmt::print("\n{} rows, {} bounds fail\n", table.findings().size(), table.failures());
  bool good = settings.out.empty() || write_files(settings, table);
  good = write_report(settings.report, report_of_claims(table, "The bounds of [D], measured")) && good;
  for (const Finding& f : table.findings()) good = good && !(f.counter == kWrongAnswers && f.figure > 0);
  return good ? 0 : 1;
}

}  // namespace pd::bench
