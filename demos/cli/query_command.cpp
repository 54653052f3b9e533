/// @file
/// `pdepth query`: the line protocol on a file or on standard input.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "commands.hpp"
#include "line_input.hpp"
#include "mesh/mesh_file.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "protocol/handlers.hpp"
#include "protocol/schema.hpp"
#include "protocol/stream/query_stream.hpp"
#include "support/complain.hpp"
#include "usage.hpp"

namespace pd::cli {

namespace {

constexpr const char* kQueryFooter = R"(One JSON object a line in, one out, in the same order:
  {"id":1,"query":"depth","a":SHAPE,"pose_a":POSE,"b":SHAPE,"pose_b":POSE}
  {"id":1,"class":"overlapping","depth":...,"lower":...,"upper":...,"translation":[...],...}
A line that cannot be answered is answered by {"id":1,"error":{"code":...,"message":...,"where":...}}.

--list names the queries; --schema prints a JSON Schema of their lines and answers, of contact records, and of all error
codes with their meanings.

For input from strangers: --no-files, --max-time, --max-memory, and small --max-line and --max-vertices.)";

struct QueryArguments {
  std::string input = "-";
  bool list = false;
  bool schema = false;
  query::StreamSettings settings;
};

int refuse_input(const std::string& output, const std::string& input) {
  complain("{} is the input {} itself: write to another file", output, input == "-" ? "on standard input" : input);
  return kBadUsage;
}

/// The queries with what they ask for, in the words of the schema.
void print_queries() {
  const auto schema = nlohmann::json::parse(query::kSchema);
  for (const query::QueryEntry& entry : query::queries()) {
    const auto& definition = schema.at("$defs").at("line." + std::string(entry.name));
    fmt::print("  {:<24} {}\n", entry.name, definition.at("description").get<std::string>());
  }
}

/// True for a file with the ending of a mesh whose text does not begin as JSON does: each of its lines would be an
/// error.
bool is_plainly_mesh(const InputFile& input, const std::string& name) {
  if (!query::is_mesh_name(name)) return false;
  char begin[256];
  const ssize_t count = ::pread(input.descriptor(), begin, sizeof(begin), 0);
  if (count <= 0) return false;  // empty, or a pipe, whose bytes can be read only once
  const std::string_view text(begin, static_cast<std::size_t>(count));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] != '{';
}

int refuse_mesh(const std::string& name) {
  const std::string text = nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  complain(
      "{0} is a mesh, and query reads lines of JSON: try `pdepth check {0}` or `pdepth depth {0} box:1,1,1`, or "
      "name the file in a line: {{\"query\":\"width\",\"a\":{{\"type\":\"mesh\",\"path\":{1}}}}}",
      name, text);
  return kBadUsage;
}

int run_query(QueryArguments arguments) {
  if (arguments.list) print_queries();
  if (arguments.schema) fmt::print("{}", query::kSchema);
  if (arguments.list || arguments.schema) return kDone;
  query::StreamSettings& settings = arguments.settings;
  settings.threads = number_of_threads(settings.threads);
  check_outputs({}, {{"--record", settings.record.path}});
  const InputFile input(arguments.input);
  if (!input.good()) return cannot_read(arguments.input, errno);
  if (is_plainly_mesh(input, arguments.input)) return refuse_mesh(arguments.input);
  if (input.is_also(STDOUT_FILENO)) return refuse_input("standard output", arguments.input);
  if (!settings.record.path.empty() && input.is_also(settings.record.path)) {
    return refuse_input("--record " + settings.record.path, arguments.input);
  }
  if (::isatty(input.descriptor()) != 0) {
    complain("reading lines from {}; Ctrl-D ends them, and `pdepth query --help` shows one",
             arguments.input == "-" ? "standard input" : arguments.input);
  }
  // Answers on a terminal are progress enough.
  std::optional<Progress> progress;
  if (::isatty(STDOUT_FILENO) == 0 && share_read(input.descriptor()) >= 0) {
    progress.emplace("query " + arguments.input, [&input] { return share_read(input.descriptor()); });
  }
  const query::StreamEnd end = query::answer_stream(input.descriptor(), STDOUT_FILENO, settings);
  const int reason = errno;
  progress.reset();
  switch (end) {
    case query::StreamEnd::answered:
      return kDone;
    case query::StreamEnd::unreadable:
      return cannot_read(arguments.input, reason);
    case query::StreamEnd::unwritable:
      complain("the answers cannot be written: {}", std::strerror(reason));
      return kFailed;
    case query::StreamEnd::unrecorded:
      errno = reason;
      return cannot_write({"--record", settings.record.path});
  }
  return kFailed;
}

}  // namespace

void add_query_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<QueryArguments>();
  query::StreamSettings& settings = arguments->settings;
  CLI::App* command = app.add_subcommand("query", "Answer queries of the line protocol, one JSON object a line");
  command->footer(kQueryFooter);
  CLI::Option* const file =
      command->add_option("FILE", arguments->input, "Lines to answer; - is standard input")->capture_default_str();
  CLI::Option* const list = command->add_flag("--list", arguments->list, "Name the queries and what they ask for");
  command->add_flag("--schema", arguments->schema, "Print the JSON Schema of lines, answers, records and error codes")
      ->excludes(list)
      ->excludes(file);
  list->excludes(file);
  add_threads_option(*command, settings.threads, "answer");
  add_limit_options(*command, settings.limits);
  command
      ->add_option("--max-time", settings.budget.milliseconds,
                   "Milliseconds for a line; then, of a depth, a coarse run's certified bracket, else limit_exceeded "
                   "(0: no bound)")
      ->check(number_between(std::int64_t{0}, std::int64_t{86'400'000}))
      ->capture_default_str();
  command->add_option("--max-memory", settings.budget.megabytes, "Megabytes for a line (0: no bound)")
      ->check(number_between(std::int64_t{0}, std::int64_t{1} << 30))
      ->capture_default_str();
  command->add_option("--record", settings.record.path, "Append the lines that were asked to this file");
  command->add_option("--record-above", settings.record.above_milliseconds, "Record only lines that took longer, in ms")
      ->needs("--record")
      ->check(number_of_zero_or_more());
  command
      ->add_flag("--record-unreached", settings.record.unreached,
                 "Record only lines whose bracket was not reached, or that hit a limit")
      ->needs("--record");
  command->callback([arguments, &action] { action = [arguments] { return run_query(*arguments); }; });
}

}  // namespace pd::cli
