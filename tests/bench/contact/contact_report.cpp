#include "bench/contact/contact_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/measure/table.hpp"

namespace pd::bench {

namespace {

using scenes::ContactGoal;

/// Share of the height that a bounce should keep.
constexpr double kBounceError = 0.05;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool from_bullet(const std::string& run) { return run.starts_with("bullet"); }

/// Least value of a figure over the rows that `wanted` chooses.
template <class Wanted>
double least(const std::vector<ContactRow>& block, double ContactFigures::*field, Wanted&& wanted) {
  double result = kInfinity;
  for (const ContactRow& row : block) {
    if (wanted(row)) {
      result = std::min(result, row.figures.*field);
    }
  }
  return result;
}

/// A scene that should stand ends for a run when it has fallen: what it shows then is that of another, shorter scene.
bool ended_early(const ContactRow& row) {
  return row.goal == ContactGoal::stand && row.figures.fall_seconds < row.seconds;
}

class Judge {
 public:
  Judge(const std::vector<ContactRow>& block, std::vector<ContactVerdict>& verdicts)
      : block_(block), verdicts_(verdicts) {
    for (const ContactRow& row : block) {
      ours_ = row.run == "pdepth" ? &row : ours_;
    }
  }

  void judge() {
    if (ours_ == nullptr || block_.size() < 2) {
      return;
    }
    const auto bullet = [](const ContactRow& row) { return from_bullet(row.run) && !ended_early(row); };
    const auto others = [](const ContactRow& row) { return !row.run.starts_with("pdepth") && !ended_early(row); };
    if (ours_->goal == ContactGoal::stand) {
      judge_fall();
      if (ended_early(*ours_)) {
        return;
      }
    }
    at_most("ms a step p50", &ContactFigures::step_p50_ms, bullet, 1.0, 0);
    at_most("ms a step p99", &ContactFigures::step_p99_ms, bullet, 1.5, 0);
    at_most("ms a step max", &ContactFigures::step_max_ms, bullet, 1.5, 0);
    at_most("deepest", &ContactFigures::deepest_late, bullet, ours_->goal == ContactGoal::rest ? 0.5 : 1.1, 1e-4);
    if (ours_->goal == ContactGoal::stand) {
      at_most("drift", &ContactFigures::drift, others, 1.1, 1e-4);
      at_most("tail speed", &ContactFigures::tail_speed, others, 1.1, 1e-4);
    }
    if (ours_->goal == ContactGoal::keep) {
      const double error = std::abs(ours_->figures.final_speed - ours_->wanted_speed);
      double best = kInfinity;
      for (const ContactRow& row : block_) {
        best = others(row) ? std::min(best, std::abs(row.figures.final_speed - row.wanted_speed)) : best;
      }
      push("speed error", error, best, std::max(0.01, 1.1 * best), error <= std::max(0.01, 1.1 * best));
    }
    if (ours_->goal == ContactGoal::rebound) {
      const double best = least(block_, &ContactFigures::bounce_error, others);
      push("bounce error", ours_->figures.bounce_error, best, kBounceError,
           ours_->figures.bounce_error <= kBounceError);
    }
    if (ours_->goal == ContactGoal::land) at_most("toppled", &ContactFigures::toppled, others, 1, 0);
    at_most("energy gained", &ContactFigures::energy_gained, others, 1.1, 1e-2);
    push("lost", ours_->figures.lost, least(block_, &ContactFigures::lost, others), 0, ours_->figures.lost == 0);
  }

 private:
  void judge_fall() {
    double longest = 0;
    for (const ContactRow& row : block_) {
      longest = row.run.starts_with("pdepth") ? longest : std::max(longest, row.figures.fall_seconds);
    }
    push("fall time", ours_->figures.fall_seconds, longest, 0.9 * longest,
         ours_->figures.fall_seconds >= 0.9 * longest);
  }
  template <class Wanted>
  void at_most(const char* name, double ContactFigures::*field, Wanted&& wanted, double factor, double slack) {
    const double best = least(block_, field, wanted);
    if (std::isfinite(best)) {
      const double ours = ours_->figures.*field;
      push(name, ours, best, factor * best + slack, ours <= factor * best + slack);
    }
  }
  void push(const char* name, double ours, double best, double threshold, bool good) {
    verdicts_.push_back({ours_->scene, ours_->steps_per_second, ours_->setting, name, ours, best, threshold, good});
  }

  const std::vector<ContactRow>& block_;
  std::vector<ContactVerdict>& verdicts_;
  const ContactRow* ours_ = nullptr;
};

/// Rows of one scene, step length and setting stand together.
bool same_block(const ContactRow& a, const ContactRow& b) {
  return a.scene == b.scene && a.steps_per_second == b.steps_per_second && a.setting == b.setting;
}

}  // namespace

const std::vector<FigureColumn>& figure_columns() {
  static const std::vector<FigureColumn> columns{{"step_p50_ms", &ContactFigures::step_p50_ms},
                                                 {"step_p99_ms", &ContactFigures::step_p99_ms},
                                                 {"step_max_ms", &ContactFigures::step_max_ms},
                                                 {"query_ns", &ContactFigures::query_ns},
                                                 {"deepest", &ContactFigures::deepest},
                                                 {"deepest_late", &ContactFigures::deepest_late},
                                                 {"drift", &ContactFigures::drift},
                                                 {"fall_s", &ContactFigures::fall_seconds},
                                                 {"tail_speed", &ContactFigures::tail_speed},
                                                 {"final_speed", &ContactFigures::final_speed},
                                                 {"bounce_error", &ContactFigures::bounce_error},
                                                 {"toppled", &ContactFigures::toppled},
                                                 {"energy_gained", &ContactFigures::energy_gained},
                                                 {"contacts", &ContactFigures::contacts},
                                                 {"new_points", &ContactFigures::new_points},
                                                 {"lost", &ContactFigures::lost},
                                                 {"queries", &ContactFigures::queries},
                                                 {"exact_signs", &ContactFigures::exact_signs},
                                                 {"wider", &ContactFigures::wider}};
  return columns;
}

void print_block(const scenes::ContactScene& scene, const std::vector<ContactRow>& block) {
  const ContactRow& first = block.front();
  fmt::print("{}: {}, {:.0f} Hz, {} settings, {:.0f} s, {} start(s)\n", scene.name, scene.title, first.steps_per_second,
             first.setting, first.seconds, first.starts);
  fmt::print("  {:<16}{:>9}{:>9}{:>9}{:>9}{:>10}{:>10}{:>10}{:>7}{:>10}{:>9}{:>8}{:>8}{:>10}{:>9}{:>7}{:>6}\n", "run",
             "p50 ms", "p99 ms", "max ms", "ns/query", "deepest", "late", "drift", "fell s", "tail m/s", "vx m/s",
             "bounce", "toppled", "energy", "contacts", "new %", "lost");
  for (const ContactRow& row : block) {
    const ContactFigures& f = row.figures;
    fmt::print(
        "  {:<16}{:>9.4f}{:>9.4f}{:>9.3f}{:>9.0f}{:>10.2g}{:>10.2g}{:>10.2g}{:>7}{:>10.2g}{:>9.4f}"
        "{:>8.2g}{:>8.2g}{:>10.2g}{:>9.1f}{:>7.2f}{:>6.0f}\n",
        row.run, f.step_p50_ms, f.step_p99_ms, f.step_max_ms, f.query_ns, f.deepest, f.deepest_late, f.drift,
        f.fall_seconds >= row.seconds ? "-" : fmt::format("{:.1f}", f.fall_seconds), f.tail_speed, f.final_speed,
        f.bounce_error, f.toppled, f.energy_gained, f.contacts, 100 * f.new_points, f.lost);
  }
  fmt::print("\n");
  std::fflush(stdout);
}

std::vector<ContactVerdict> judge_contact(const std::vector<ContactRow>& rows) {
  std::vector<ContactVerdict> verdicts;
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto end = std::find_if(begin, rows.end(), [&](const ContactRow& row) { return !same_block(*begin, row); });
    const std::vector<ContactRow> block(begin, end);
    Judge(block, verdicts).judge();
    begin = end;
  }
  return verdicts;
}

void print_verdicts(const std::vector<ContactRow>& rows) {
  const std::vector<ContactVerdict> verdicts = judge_contact(rows);
  int good = 0;
  fmt::print("{:<18}{:>6} {:<12} {:<14}{:>12}{:>12}{:>12}\n", "verdicts", "Hz", "settings", "figure", "ours",
             "best other", "may be");
  for (const ContactVerdict& v : verdicts) {
    good += v.good ? 1 : 0;
    if (!v.good) {
      fmt::print("{:<18}{:>6.0f} {:<12} {:<14}{:>12.4g}{:>12.4g}{:>12.4g}  MISSED\n", v.scene, v.steps_per_second,
                 v.setting, v.figure, v.ours, v.best, v.threshold);
    }
  }
  fmt::print("{} of {} hold\n", good, verdicts.size());
}

std::string to_csv(const std::vector<ContactRow>& rows) {
  std::string text = "scene,steps_per_second,settings,run,starts,seconds";
  for (const FigureColumn& column : figure_columns()) {
    text += fmt::format(",{}", column.name);
  }
  text += "\n";
  for (const ContactRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{}", row.scene, row.steps_per_second, row.setting, row.run, row.starts,
                        row.seconds);
    for (const FigureColumn& column : figure_columns()) {
      text += fmt::format(",{:.6g}", row.figures.*column.field);
    }
    text += "\n";
  }
  return text;
}

}  // namespace pd::bench
