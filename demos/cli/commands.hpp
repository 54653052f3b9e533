/// @file
/// The subcommands of `pdepth`. Each adds itself to the application and, once parsed, runs to an exit code.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace pd::cli {

/// Exit codes of every subcommand.
enum ExitCode : int {
  kDone = 0,
  kFailed = 1,          ///< the work could not be finished: no room on the disk, no GL context
  kBadUsage = 2,        ///< an unknown option, or input that cannot be read
  kConditionFails = 3,  ///< `audit`: a condition of --fail-on does not hold; `check`: one of its faults is there;
                        ///< `decompose`: the error was not reached
  kInterrupted = 130,   ///< Ctrl-C
};

/// What to run after the arguments are parsed.
using Action = std::function<int()>;

void add_depth_command(CLI::App& app, Action& action);
void add_check_command(CLI::App& app, Action& action);
void add_polygon_command(CLI::App& app, Action& action);
void add_query_command(CLI::App& app, Action& action);
void add_minimise_command(CLI::App& app, Action& action);
void add_simplify_command(CLI::App& app, Action& action);
void add_decompose_command(CLI::App& app, Action& action);
void add_audit_command(CLI::App& app, Action& action);
void add_accuracy_command(CLI::App& app, Action& action);
void add_demo_command(CLI::App& app, Action& action);

}  // namespace pd::cli
