/// @file
/// An audit in the forms that people and programs read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "audit/audit_stream.hpp"
#include "audit/exact_depth.hpp"
#include "audit/fail_conditions.hpp"

namespace pd::audit {

/// The JSON answer of the protocol's "Contact records", one line without a newline. Quantiles of nothing are null.
[[nodiscard]] std::string audit_json(const Audit& audit, const std::vector<ConditionOutcome>& conditions);

/// A table for a terminal, of at most 110 columns, and the worst contacts below it.
/// @param record  its name
/// @param drawn  a page draws the worst contacts: the table need not tell how to get one
[[nodiscard]] std::string audit_table(const Audit& audit, const std::vector<ConditionOutcome>& conditions,
                                      std::string_view record, bool drawn = false);

/// What a recorder rather than an engine seems to have got wrong, a sentence each: more than half of all normals, or of
/// all depths that are far off, fit with the other sign.
[[nodiscard]] std::vector<std::string> recorder_hints(const AuditSummary& summary);

/// A JUnit file: one test for every condition, and one that says whether every line was judged.
[[nodiscard]] std::string audit_junit(const Audit& audit, const std::vector<ConditionOutcome>& conditions,
                                      std::string_view record);

/// The columns of a file of comma-separated values, one row a contact; both end with a newline.
[[nodiscard]] std::string csv_header();
[[nodiscard]] std::string csv_row(const RecordedContact& contact, const Judgement& judgement, std::int64_t line);

/// The exact signed depth of a contact that was judged.
[[nodiscard]] SignedDepth worst_interval(const WorstContact& worst, double tolerance);

/// A line for `pdepth query` that asks the exact side again; empty for a half-space, which is no shape of a query.
[[nodiscard]] std::string query_line(const WorstContact& worst, double tolerance);

}  // namespace pd::audit
