/// @file
/// What a test of an engine allows: "missed=0,phantom=0,depth_error=1e-4".
#pragma once

#include <string>
#include <vector>

#include "audit/audit_summary.hpp"

namespace pd::audit {

/// At most `limit` of a count, or a column whose largest absolute value is at most `limit`.
struct FailCondition {
  std::string name;
  double limit = 0;
};

/// Counts are missed, phantom and unanswered (refused lines included); columns those of `Column`.
/// @throws query::Refusal bad_value for an unknown name, a missing or negative limit.
[[nodiscard]] std::vector<FailCondition> parse_fail_conditions(const std::string& text);

struct ConditionOutcome {
  FailCondition condition;
  double found = 0;
  bool holds = false;
};

[[nodiscard]] std::vector<ConditionOutcome> check(const std::vector<FailCondition>& conditions,
                                                  const AuditSummary& summary);

}  // namespace pd::audit
