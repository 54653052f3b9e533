#include "audit/fail_conditions.hpp"

#include <charconv>
#include <optional>

namespace pd::audit {

namespace {

/// Empty for an unknown name.
std::optional<double> found_under(const std::string& name, const AuditSummary& summary) {
  const Totals& total = summary.total();
  if (name == "missed") return static_cast<double>(total.missed);
  if (name == "phantom") return static_cast<double>(total.phantom);
  if (name == "unanswered") return static_cast<double>(total.unanswered + summary.refused());
  for (const Column column : kColumns) {
    if (name == to_string(column)) return total.of(column).max();
  }
  return std::nullopt;
}

FailCondition parse_condition(const std::string& word) {
  const std::size_t equals = word.find('=');
  FailCondition condition{word.substr(0, equals), 0};
  if (!found_under(condition.name, AuditSummary(0))) {
    query::refuse("bad_value",
                  "--fail-on: there is no \"" + condition.name +
                      "\"; known: missed, phantom, unanswered, depth_error, depth_error_of_smaller, "
                      "depth_error_absolute, normal_excess, point_error",
                  "");
  }
  const char* const end = word.data() + word.size();
  const char* const begin = equals == std::string::npos ? end : word.data() + equals + 1;
  const auto result = std::from_chars(begin, end, condition.limit);
  if (result.ec != std::errc() || result.ptr != end || !(condition.limit >= 0)) {
    query::refuse("bad_value", "--fail-on: \"" + word + "\": NAME=LIMIT, with a limit of 0 or more", "");
  }
  return condition;
}

}  // namespace

std::vector<FailCondition> parse_fail_conditions(const std::string& text) {
  std::vector<FailCondition> conditions;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    conditions.push_back(parse_condition(text.substr(at, end - at)));
    at = end + 1;
  }
  return conditions;
}

std::vector<ConditionOutcome> check(const std::vector<FailCondition>& conditions, const AuditSummary& summary) {
  std::vector<ConditionOutcome> outcomes;
  for (const FailCondition& condition : conditions) {
    const double found = *found_under(condition.name, summary);
    outcomes.push_back({condition, found, found <= condition.limit});
  }
  return outcomes;
}

}  // namespace pd::audit
