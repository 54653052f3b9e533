/// @file
/// Who fails what, as tables and as a page.
#pragma once

#include <string>
#include <vector>

#include "audit/accuracy_run.hpp"
#include "report/page.hpp"

namespace pd::audit {

/// Engines by families. `rows[e * families.size() + f]` is engine e on family f.
struct AccuracyTable {
  std::vector<std::string> engines;
  std::vector<std::string> families;
  std::vector<AccuracyRow> rows;
  std::vector<report::PairFigure> worst;  ///< of each engine that errs, in their order

  [[nodiscard]] const AccuracyRow& at(std::size_t engine, std::size_t family) const {
    return rows[engine * families.size() + family];
  }
  /// Over all families.
  [[nodiscard]] AccuracyRow total(std::size_t engine) const;
  [[nodiscard]] bool any_failed() const;
};

/// For a terminal: engines with their totals, then families down and engines across.
[[nodiscard]] std::string accuracy_text(const AccuracyTable& table);

/// A row for each engine and family, with a head.
[[nodiscard]] std::string accuracy_csv(const AccuracyTable& table);

/// Cards, totals, families by engines with shading, the worst contact of each engine. @param judge  who judged, a
/// sentence
[[nodiscard]] report::Page accuracy_page(const AccuracyTable& table, const AccuracySettings& settings,
                                         const std::string& judge, const std::string& command);

}  // namespace pd::audit
