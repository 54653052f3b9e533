#include "audit/accuracy_engines.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "files/companion.hpp"

namespace pd::audit {

namespace {

std::vector<std::string> installed_recorders() {
  std::vector<std::string> found;
  for (const char* name : {"record_peers", "record_peers_double", "record_dart"}) {
    if (std::string program = companion_program(name); !program.empty()) found.push_back(std::move(program));
  }
  return found;
}

}  // namespace

std::vector<AccuracyEngine> find_engines(const std::vector<std::string>& programs, const std::vector<std::string>& only,
                                         std::vector<std::string>& complaints) {
  std::vector<AccuracyEngine> engines;
  for (const std::string& program : programs.empty() ? installed_recorders() : programs) {
    const std::vector<std::string> names = engines_of(program);
    if (names.empty()) complaints.push_back(program + ": no recorder: `" + program + " --list` names no engine");
    for (const std::string& name : names) {
      const bool wanted = only.empty() || std::find(only.begin(), only.end(), name) != only.end();
      const bool known =
          std::any_of(engines.begin(), engines.end(), [&](const AccuracyEngine& e) { return e.name == name; });
      if (wanted && !known) engines.push_back({program, name});
    }
  }
  return engines;
}

AccuracyTable run_engines(const std::vector<AccuracyEngine>& engines, const std::vector<AccuracySource>& sources,
                          const AccuracySettings& settings, bool draw, const ContactJudge& judge) {
  AccuracyTable table;
  for (const AccuracySource& source : sources) table.families.push_back(source.family);
  for (const AccuracyEngine& engine : engines) {
    table.engines.push_back(engine.name);
    double worst = draw ? 0 : std::numeric_limits<double>::infinity();
    std::optional<report::PairFigure> figure;
    for (const AccuracySource& source : sources) {
      if (settings.begins) settings.begins(engine.name, source.family);
      table.rows.push_back(run_accuracy(engine.program, engine.name, source, settings, worst, judge));
      AccuracyRow& row = table.rows.back();
      if (!row.figure) continue;
      figure = std::move(row.figure);
      row.figure.reset();
      worst = std::max(worst, row.worst);
    }
    if (figure) table.worst.push_back(std::move(*figure));
  }
  return table;
}

}  // namespace pd::audit
