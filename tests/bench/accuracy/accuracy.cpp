#include "bench/accuracy/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "audit/accuracy_engines.hpp"
#include "bench/measure/table.hpp"
#include "bench/peers/solver.hpp"
#include "oracle/answer_check.hpp"
#include "oracle/depth_oracle.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

namespace {

/// The points as the record writes them: no hull of the core stands in between. Empty where the shape is no hull.
scenes::Points points_of(const audit::RecordedShape& shape) {
  scenes::Points points;
  const auto json = nlohmann::json::parse(shape.text);
  if (json.value("margin", 0.0) != 0) return points;
  if (json.at("type") == "box") {
    const auto half = json.at("half_extents").get<std::array<double, 3>>();
    return scenes::box({half[0], half[1], half[2]});
  }
  if (json.at("type") != "convex") return points;
  for (const auto& vertex : json.at("vertices").get<std::vector<std::array<double, 3>>>()) {
    points.emplace_back(vertex[0], vertex[1], vertex[2]);
  }
  return points;
}

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (int f = 0; f < scenes::kPairFamilies; ++f) names.emplace_back(to_string(static_cast<scenes::PairFamily>(f)));
  return names;
}

/// The depth, or minus the distance; false where the oracle does not know it.
bool signed_depth(const oracle::Verdict& verdict, double& x) {
  x = 0;
  if (verdict.contact == ContactClass::overlapping) x = verdict.depth.approximate();
  if (verdict.contact != ContactClass::separated) return true;
  if (verdict.distance_known) x = -verdict.distance.approximate();
  return verdict.distance_known;
}

}  // namespace

audit::Judgement judge_by_oracle(const audit::RecordedContact& contact, double tolerance) {
  audit::Judgement judgement;
  const scenes::Points a = points_of(*contact.a);
  const scenes::Points b = points_of(*contact.b);
  if (a.empty() || b.empty()) return judgement;
  const oracle::Body body_a(a);
  const oracle::Body body_b(b);
  const oracle::ExactPair pair(body_a, contact.pose_a, body_b, contact.pose_b);
  double x = 0;
  judgement.answered = signed_depth(oracle::judge(pair), x);
  if (!judgement.answered) return judgement;
  const double extent = oracle::difference_extent(pair);
  judgement.lower = judgement.upper = x;
  judgement.scale = extent > 0 ? extent : 1;
  const bool reported = contact.report && contact.report->depth > 0;
  judgement.missed = x > tolerance * judgement.scale && !reported;
  judgement.phantom = x < -tolerance * judgement.scale && reported;
  if (!contact.report) return judgement;
  judgement.depth_error = (contact.report->depth - x) / judgement.scale;
  if (!contact.report->normal || x <= 0) return judgement;
  const Vec3 normal = contact.report->normal->stableNormalized();
  judgement.normal_excess = (std::ldexp(pair.support(normal), pair.scale()) - x) / judgement.scale;
  return judgement;
}

int run_accuracy_by_oracle(const AccuracyOptions& options) {
  const std::vector<std::string> known = all_families();
  std::vector<audit::AccuracySource> sources;
  for (const std::string& family : options.families.empty() ? known : options.families) {
    if (std::find(known.begin(), known.end(), family) == known.end()) {
      fmt::print(stderr, "--families: no family of this name: {}\n", family);
      return 2;
    }
    sources.push_back({family, {}});
  }
  if (!options.cases.empty()) {
    sources.push_back({std::filesystem::path(options.cases).stem(), std::filesystem::absolute(options.cases)});
  }
  std::vector<std::string> complaints;
  const auto engines = audit::find_engines({}, options.engines, complaints);
  for (const std::string& complaint : complaints) fmt::print(stderr, "{}\n", complaint);
  const auto judge = [&](const audit::RecordedContact& contact) {
    return judge_by_oracle(contact, options.settings.tolerance);
  };
  const auto table = audit::run_engines(engines, sources, options.settings, !options.report.empty(), judge);
  fmt::print("judged by the tests' oracle, in exact arithmetic\n{}", audit::accuracy_text(table));
  bool good = options.csv.empty() || write_text(options.csv, audit::accuracy_csv(table));
  for (const audit::AccuracyRow& row : table.rows) good = good && (row.engine != kOurs || row.wrong() == 0);
  if (options.report.empty()) return good ? 0 : 1;
  const char* said =
      "Recorder programs asked each engine; an oracle that shares no code with pdepth judged them all in "
      "exact arithmetic, pdepth like the others.";
  const std::string command =
      fmt::format("pdepth-bench accuracy --pairs {} --vertices {} --seed {}{}{}{} --report '{}'",
                  options.settings.pairs, options.settings.vertices, options.settings.seed,
                  options.families.empty() ? "" : fmt::format(" --families {}", fmt::join(options.families, ",")),
                  options.engines.empty() ? "" : fmt::format(" --engines {}", fmt::join(options.engines, ",")),
                  options.cases.empty() ? "" : fmt::format(" --cases '{}'", options.cases), options.report);
  good = report::write_page(options.report, audit::accuracy_page(table, options.settings, said, command)) && good;
  return good ? 0 : 1;
}

}  // namespace pd::bench
