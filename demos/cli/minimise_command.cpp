/// @file
/// `pdepth minimise`: a line of the protocol shrunk while a predicate still holds, after Zeller and Hildebrandt,
/// "Simplifying and isolating failure-inducing input", 2002 (ddmin), on the lists and numbers of its JSON.
#include <fmt/core.h>
#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "line_input.hpp"
#include "support/complain.hpp"

namespace pd::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMinimiseFooter =
    R"(The predicate is a shell command that gets the line on its standard input; status 0 means "still of interest":
  pdepth minimise bad.jsonl --predicate 'pdepth query | grep -q limit_exceeded'
What can be left out is left out (vertices, parts, optional fields), and numbers become short, as long as it holds.)";

/// Shrinks a line: every step is kept only where the predicate holds afterwards, so that it holds for the result.
class Minimiser {
 public:
  Minimiser(Json line, std::string predicate) : line_(std::move(line)), predicate_(std::move(predicate)) {}

  [[nodiscard]] bool holds() { return holds(line_); }

  Json run() {
    for (std::string before; before != line_.dump();) {
      before = line_.dump();
      for (const std::string& place : places()) {
        const Json::json_pointer pointer(place);
        if (!line_.contains(pointer)) continue;
        const Json& value = line_.at(pointer);
        if (value.is_array()) {
          shorten(pointer);
        } else if (value.is_object()) {
          drop_fields(pointer);
        } else if (value.is_number()) {
          round(pointer);
        }
      }
    }
    return line_;
  }
  [[nodiscard]] int asked() const { return asked_; }

 private:
  bool holds(const Json& line) {
    ++asked_;
    std::FILE* const pipe = ::popen(predicate_.c_str(), "w");
    if (pipe == nullptr) throw std::runtime_error("the predicate cannot be started");
    // Nothing is left to be written when it closes: a predicate that reads nothing would seem to have failed.
    (void)std::setvbuf(pipe, nullptr, _IONBF, 0);
    const std::string text = line.dump() + "\n";
    (void)std::fwrite(text.data(), 1, text.size(), pipe);
    const int status = ::pclose(pipe);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  bool accept(Json candidate) {
    if (candidate == line_ || !holds(candidate)) return false;
    line_ = std::move(candidate);
    return true;
  }

  /// Pointers to every container and number, the line itself first.
  [[nodiscard]] std::vector<std::string> places() const {
    std::vector<std::string> all{""};
    const Json flat = line_.flatten();
    for (const auto& [pointer, value] : flat.items()) {
      for (std::size_t end = pointer.find('/', 1); end != std::string::npos; end = pointer.find('/', end + 1)) {
        const std::string container = pointer.substr(0, end);
        if (std::find(all.begin(), all.end(), container) == all.end()) all.push_back(container);
      }
      if (value.is_number()) all.push_back(pointer);
    }
    return all;
  }

  /// Leaves out blocks of elements, halves first (ddmin's complements).
  void shorten(const Json::json_pointer& place) {
    for (std::size_t block = line_.at(place).size(); block > 0; block /= 2) {
      for (std::size_t first = 0; first < line_.at(place).size();) {
        Json candidate = line_;
        Json& list = candidate.at(place);
        const std::size_t end = std::min(first + block, list.size());
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(first), list.begin() + static_cast<std::ptrdiff_t>(end));
        if (!accept(std::move(candidate))) first += block;
      }
    }
  }

  void drop_fields(const Json::json_pointer& place) {
    std::vector<std::string> names;
    for (const auto& [name, value] : line_.at(place).items()) names.push_back(name);
    for (const std::string& name : names) {
      Json candidate = line_;
      candidate.at(place).erase(name);
      (void)accept(std::move(candidate));
    }
  }

  /// The number with the fewest digits that serves: 0, a whole one, then one digit after the other.
  void round(const Json::json_pointer& place) {
    const double value = line_.at(place).get<double>();
    if (value == 0) return;
    const auto try_number = [&](double rounded) {
      if (rounded == value || !std::isfinite(rounded)) return rounded == value;
      Json candidate = line_;
      candidate.at(place) = rounded;
      return accept(std::move(candidate));
    };
    if (try_number(0.0) || try_number(std::copysign(1.0, value))) return;
    for (int digits = 1; digits < 17; ++digits) {
      if (try_number(std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr))) return;
    }
  }

  Json line_;
  std::string predicate_;
  int asked_ = 0;
};

struct MinimiseArguments {
  std::string input;
  std::string predicate;
};

int run_minimise(const MinimiseArguments& arguments) {
  std::string text;
  std::ifstream file;
  if (arguments.input != "-") {
    file.open(arguments.input);
    if (!file) return cannot_read(arguments.input, errno);
  }
  std::istream& input = arguments.input == "-" ? std::cin : file;
  while (text.find_first_not_of(" \t\r") == std::string::npos && std::getline(input, text)) {
  }
  Json line = Json::parse(text, nullptr, false);
  if (!line.is_object()) {
    complain("{}: its first line is no JSON object", arguments.input);
    return kBadUsage;
  }
  std::signal(SIGPIPE, SIG_IGN);  // a predicate need not read its input
  Minimiser minimiser(std::move(line), arguments.predicate);
  if (!minimiser.holds()) {
    complain("the predicate does not hold for the line as it stands");
    return kBadUsage;
  }
  fmt::print("{}\n", minimiser.run().dump());
  fmt::print(stderr, "asked {} times\n", minimiser.asked());
  return kDone;
}

}  // namespace

void add_minimise_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<MinimiseArguments>();
  CLI::App* command = app.add_subcommand("minimise", "Shrink a line of the protocol while a command still accepts it");
  command->footer(kMinimiseFooter);
  command->add_option("LINE", arguments->input, "A file whose first line is shrunk; - is standard input")->required();
  command->add_option("--predicate", arguments->predicate, "Shell command; 0 = still of interest")->required();
  command->callback([arguments, &action] { action = [arguments] { return run_minimise(*arguments); }; });
}

}  // namespace pd::cli
