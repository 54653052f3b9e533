/// @file
/// Engines of recorder programs, and all of them on all families.
#pragma once

#include <string>
#include <vector>

#include "audit/accuracy_report.hpp"

namespace pd::audit {

struct AccuracyEngine {
  std::string program;
  std::string name;
};

/// The engines that the programs name, each name once.
/// @param programs  empty: the recorders beside this program, or installed with it
/// @param only  names that are wanted; empty: all. Where no program knows one of them, none is returned
[[nodiscard]] std::vector<AccuracyEngine> find_engines(const std::vector<std::string>& programs,
                                                       const std::vector<std::string>& only,
                                                       std::vector<std::string>& complaints);

/// Every engine asked about every source. @param draw  the worst contact of each engine, for a page
[[nodiscard]] AccuracyTable run_engines(const std::vector<AccuracyEngine>& engines,
                                        const std::vector<AccuracySource>& sources, const AccuracySettings& settings,
                                        bool draw, const ContactJudge& judge = {});

}  // namespace pd::audit
