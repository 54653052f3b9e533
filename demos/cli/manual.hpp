/// @file
/// Manual pages and shell completion, written from the options that the command parses: `pdepth help --man FOLDER` and
/// `pdepth help --completion bash`. Installing the command runs both.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace pd::cli {

/// Writes pdepth.1, and pdepth-NAME.1 for each subcommand, into a folder. @return an exit code
int write_manual_pages(const CLI::App& app, const std::string& folder);

/// A script for bash that completes subcommands, options and the words that options take.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

}  // namespace pd::cli
