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

bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

std::vector<AccuracyEngine> find_engines(const std::vector<std::string>& programs, const std::vector<std::string>& only,
                                         std::vector<std::string>& complaints) {
  std::vector<AccuracyEngine> engines;
  std::vector<std::string> all;
  for (const std::string& program : programs.empty() ? installed_recorders() : programs) {
    const std::vector<std::string> names = engines_of(program);
    if (names.empty()) complaints.push_back(program + ": no recorder: `" + program + " --list` names no engine");
    for (const std::string& name : names) {
      if (holds(all, name)) continue;
      all.push_back(name);
      if (only.empty() || holds(only, name)) engines.push_back({program, name});
    }
  }
  for (const std::string& name : only) {
    if (all.empty() || holds(all, name)) continue;
    std::string known;
    for (const std::string& engine : all) known += (known.empty() ? "" : ", ") + engine;
    complaints.push_back("--engines: there is no engine \"" + name + "\"; known: " + known);
    engines.clear();
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
