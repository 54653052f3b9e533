/// @file
/// An audit as one page for people: report.html, which needs no network and no other file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "audit/audit_stream.hpp"
#include "audit/fail_conditions.hpp"
#include "report/page.hpp"

namespace pd::audit {

/// Headline figures, the worst contacts drawn with the line that asks again, the table by kind, a histogram of each
/// error by powers of ten, how to reproduce it.
/// @param command  that makes it again
[[nodiscard]] report::Page audit_report(const Audit& audit, const std::vector<ConditionOutcome>& conditions,
                                        std::string_view record, std::string_view command);

}  // namespace pd::audit
