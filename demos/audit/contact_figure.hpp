/// @file
/// A contact as a figure of a page: the bodies where the engine had them, the exact answer and what was reported.
#pragma once

#include "audit/audit_summary.hpp"
#include "report/pair_figure.hpp"

namespace pd::audit {

/// @param tolerance  of the audit. Time: one exact query, and O(facets of P) up to some thousands.
[[nodiscard]] report::PairFigure contact_figure(const WorstContact& worst, double tolerance);

}  // namespace pd::audit
