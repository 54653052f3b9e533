/// @file
/// The command `pdepth`: arguments in, subcommand out.
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

#include "commands.hpp"
#include "files/companion.hpp"
#include "manual.hpp"
#include "report/page.hpp"
#include "report/page_files.hpp"
#include "support/complain.hpp"
#include "support/refusal.hpp"
#include "usage.hpp"

namespace {

constexpr const char* kFooter = R"(Examples:
  pdepth depth part.obj fixture.stl --pose-a 0,0,0.25
  pdepth depth a.ply b.off --json
  pdepth check part.stl --fail-on solid
  pdepth polygon plate.svg tool.json --direction 0,1
  pdepth query lines.jsonl --threads 4 > answers.jsonl
  echo '{"id":1,"query":"depth","a":{"type":"box","half_extents":[1,1,1]},
         "b":{"type":"sphere","radius":1},"pose_b":{"translation":[1.5,0,0]}}' | tr -d '\n' | pdepth query
  pdepth audit contacts.jsonl --fail-on missed=0,phantom=0,depth_error=1e-4
  pdepth simplify scan.ply --epsilon 1e-3 -o hull.obj
  pdepth decompose gear.obj --error 1e-3 -o parts.obj
  pdepth demo stacking --out frames

Exit codes:
  0    done; for `query`: every line has its answer (an error object is one)
  1    the work could not be finished (output that cannot be written, no graphics)
  2    bad usage, or input that cannot be read; for `audit`: not all could be judged
  3    for `audit`: a condition of --fail-on does not hold; for `check`: a fault of --fail-on is there;
       for `decompose`: the error was not reached
  130  stopped by Ctrl-C
  141  in a pipe, the program that reads the output has ended, as `head` does (the signal SIGPIPE)

`pdepth SUBCOMMAND --help` says more; `pdepth help --man FOLDER` writes manual pages, and
`pdepth help --completion bash` prints a script that completes what is typed.)";

std::string licenses() {
  return fmt::format(
      "pdepth: zlib License, Copyright (c) 2026 the pdepth authors\n\nthree.js, in pages and in pdepth itself:\n\n{}",
      pd::report::kThreeLicense);
}

std::vector<std::string> subcommands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// `help --man FOLDER` or `help --completion bash`.
bool asks_for_manual(const std::vector<std::string>& words) {
  return words.size() == 3 && words[0] == "help" &&
         (words[1] == "--man" || (words[1] == "--completion" && words[2] == "bash"));
}

/// The complaint about `help ...`; empty where nothing is wrong.
std::string wrong_in_help(const std::vector<std::string>& words) {
  if (words.size() < 2 || words[0] != "help" || asks_for_manual(words)) return {};
  if (words[1] == "--man") return "--man needs one folder for the pages";
  if (words[1] == "--completion") return "--completion takes one word: bash";
  if (words[1].starts_with('-') && words[1] != "--help" && words[1] != "-h") {
    return "help has no option " + words[1] + "; it takes the name of a subcommand, --man or --completion";
  }
  return words.size() > 2 ? words[2] + " is one word too many behind `help`" : "";
}

int write_manual(const CLI::App& app, const std::vector<std::string>& words) {
  if (words[1] == "--man") return pd::cli::write_manual_pages(app, words[2]);
  fmt::print("{}", pd::cli::bash_completion(app));
  return pd::cli::kDone;
}

/// The words that were typed, with `help X` as `X --help`.
std::vector<std::string> words_of(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help" || asks_for_manual(words)) return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

/// A command without a renderer and Bullet starts the one that has them, where it is installed. Returns where it is
/// not: then the subcommand says what is missing.
void hand_over_pictures([[maybe_unused]] const std::vector<std::string>& words, [[maybe_unused]] char** argv) {
#ifndef PDEPTH_WITH_DEMOS
  const bool draws =
      !words.empty() && (words.front() == "demo" || std::any_of(words.begin(), words.end(), [](const auto& word) {
                           return word == "--picture" || word.starts_with("--picture=");
                         }));
  if (!draws) return;
  const std::string program = pd::companion_program("pdepth-pictures");
  if (!program.empty()) ::execv(program.c_str(), argv);
#endif
}

/// A standard stream that is closed would be the first file to be opened. In its place stands one that cannot be used,
/// so that writing to it fails.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

/// @return an exit code
int work(const pd::cli::Action& action) {
  try {
    return action();
  } catch (const pd::query::Refusal& refusal) {
    pd::complain("{}{}", refusal.message, refusal.where.empty() ? "" : " at " + refusal.where);
    return pd::cli::kBadUsage;
  } catch (const std::exception& error) {
    // `main` says it of standard output.
    if (std::ferror(stdout) == 0) pd::complain("{}", error.what());
    return pd::cli::kFailed;
  }
}

/// Parses and runs. @return an exit code
int run(CLI::App& app, std::vector<std::string> words, const pd::cli::Action& action) {
  if (words.empty()) {
    fmt::print("{}", app.help());
    return pd::cli::kBadUsage;
  }
  const std::string& first = words.front();
  const std::string meant = pd::cli::nearest_word(subcommands(app), first);
  if (!first.starts_with('-') && meant != first) {
    pd::complain("there is no subcommand \"{}\"; {}", first,
                 meant.empty() ? "`pdepth --help` lists them" : "did you mean \"" + meant + "\"?");
    return pd::cli::kBadUsage;
  }
  try {
    std::reverse(words.begin(), words.end());  // as the parser wants them
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
      pd::cli::complain_of_usage(app, error);
      return pd::cli::kBadUsage;
    }
    std::ostringstream out, err;
    (void)app.exit(error, out, err);
    fmt::print("{}", out.str());
    return pd::cli::kDone;
  }
  return pd::cli::complain_of_empty_word(app) ? pd::cli::kBadUsage : work(action);
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  const std::vector<std::string> typed(argv + std::min(argc, 1), argv + argc);
  const std::vector<std::string> words = words_of(typed);
  hand_over_pictures(words, argv);
  // Whole lines and whole files are written at once, so that what stands there by then is complete.
  std::signal(SIGINT, [](int) { std::_Exit(pd::cli::kInterrupted); });
  CLI::App app("Penetration depth of convex bodies, exact and certified.", "pdepth");
  app.set_version_flag("--version", "pdepth " + pd::report::program_version());
  app.footer(kFooter);
  app.add_flag_callback(
      "--licenses", [] { throw CLI::CallForVersion(licenses(), 0); }, "Print the licences of what pdepth contains");
  app.require_subcommand(1);
  pd::cli::Action action;
  pd::cli::add_depth_command(app, action);
  pd::cli::add_check_command(app, action);
  pd::cli::add_polygon_command(app, action);
  pd::cli::add_query_command(app, action);
  pd::cli::add_minimise_command(app, action);
  pd::cli::add_simplify_command(app, action);
  pd::cli::add_decompose_command(app, action);
  pd::cli::add_audit_command(app, action);
  pd::cli::add_accuracy_command(app, action);
  pd::cli::add_demo_command(app, action);
  int code = pd::cli::kBadUsage;
  if (const std::string wrong = wrong_in_help(typed); !wrong.empty()) {
    pd::complain("{}", wrong);
  } else if (asks_for_manual(typed)) {
    code = work([&] { return write_manual(app, typed); });
  } else {
    code = run(app, words, action);
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  pd::complain("the answer cannot be written: {}", std::strerror(errno));
  return pd::cli::kFailed;
}
