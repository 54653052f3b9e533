/// @file
/// An audit as one page for people: report.html, which needs no network, no script and no other file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "audit/audit_stream.hpp"
#include "audit/fail_conditions.hpp"

namespace pd::audit {

/// Well-formed XHTML in UTF-8: headline figures, the table by kind, a histogram of each error by powers of ten (SVG),
/// the worst contacts with the line that asks again, how to reproduce it. Light and dark, from 320 px on.
/// @param command  that makes it again
[[nodiscard]] std::string audit_report(const Audit& audit, const std::vector<ConditionOutcome>& conditions,
                                       std::string_view record, std::string_view command);

/// Text for XML: markup escaped, control characters replaced.
[[nodiscard]] std::string xml_text(std::string_view text);

}  // namespace pd::audit
