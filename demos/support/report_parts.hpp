/// @file
/// What demos add to a page (`pdepth demo NAME --report DIR`).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "report/pair_figure.hpp"
#include "support/demo_options.hpp"

namespace pd::demo {

/// A file of the demo's folder, as the page names it.
[[nodiscard]] std::string page_file(const DemoOptions& options, const std::filesystem::path& file);

/// A pair with its exact answer; the line is there for polytopes, with or without a margin.
/// @param file_name  of the line, without its ending
[[nodiscard]] report::PairFigure answered_pair(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                               const std::string& title, const std::string& file_name);

/// A contact record of one contender, and what to call it.
struct RecordOfRun {
  std::filesystem::path file;
  std::string contender;
};

/// The records audited: a table of the contenders (contacts, missed, phantom, errors), printed, too, and the worst
/// contacts of each that has any beyond the tolerance, drawn. Records that cannot be read are named in it.
[[nodiscard]] std::string audited_records(const DemoOptions& options, const std::vector<RecordOfRun>& records);

}  // namespace pd::demo
