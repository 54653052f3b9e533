#include "usage.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "files/decimal_number.hpp"
#include "support/complain.hpp"

namespace pd::cli {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0]++;
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t changed = corner + (a[i] != b[k - 1]);
      corner = row[k];
      row[k] = std::min({changed, row[k] + 1, row[k - 1] + 1});
    }
  }
  return row.back();
}

/// `shown` ends on the limits, as "INT in [1, 9]", where there are two.
std::string what_is_right(double low, std::string_view shown) {
  const std::size_t limits = shown.find(" in ");
  if (limits != shown.npos) return "must lie" + std::string(shown.substr(limits));
  return low > 0 ? "must be greater than 0" : "must be 0 or more";
}

/// "-json" and "--jsn", but not "-1,0,0" and not "-".
bool looks_like_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0 && word[1] != '.';
}

/// The subcommand whose words were parsed last, or the program itself.
const CLI::App& asked_command(const CLI::App& app) {
  const auto asked = app.get_subcommands();
  return asked.empty() ? app : *asked.back();
}

std::vector<std::string> long_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::vector<std::string> known = long_options(command);
  std::string meant = nearest_word(known, name);
  for (const std::string& option : known) {
    if (meant.empty() && option.starts_with(name)) meant = option;
  }
  return fmt::format("there is no option {}{}", name, meant.empty() ? "" : "; did you mean " + meant + "?");
}

std::string left_over(const std::vector<std::string>& words) {
  const char* const too_many = words.size() == 1 ? "is one word too many" : "are words too many";
  return fmt::format("{} {}; a name with blanks needs quotes, numbers need commas between them",
                     fmt::join(words, " and "), too_many);
}

/// The option's name, what is wrong with the option, and what it is for. `said`, by the parser, begins with the name.
std::string about_option(const CLI::App& command, const std::string& said, std::string_view wrong) {
  const std::string name = said.substr(0, said.find_first_of(" :"));
  const CLI::Option* const option = command.get_option_no_throw(name);
  if (option == nullptr) return said;
  const std::string purpose = option->get_description();
  return fmt::format("{} {}{}", name, wrong, purpose.empty() ? "" : ": " + purpose);
}

/// "Could not convert: --epsilon = 1mm", by the parser's words.
std::string unconverted(const std::string& said) {
  const std::size_t name = said.find(": "), value = said.find(" = ");
  if (name == said.npos || value == said.npos) return said;
  const std::string word = said.substr(value + 3);
  double number = 0;
  const bool fraction = query::parse_decimal(word, number);
  return fmt::format("{}: {}", said.substr(name + 2, value - name - 2),
                     fraction ? word + " must be a whole number" : "\"" + word + "\" is no number");
}

/// An option that stands before its subcommand.
std::string misplaced_option(const CLI::App& app, const std::string& word) {
  const CLI::App& command = asked_command(app);
  const std::string name = word.substr(0, word.find('='));
  const std::vector<std::string> known = long_options(command);
  if (&command == &app || std::find(known.begin(), known.end(), name) == known.end()) return unknown_option(app, word);
  return fmt::format("{} belongs behind `{}`", name, command.get_name());
}

std::string words_for(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = asked_command(app);
  const std::vector<std::string> early = app.remaining();
  const auto misplaced = std::find_if(early.begin(), early.end(), looks_like_option);
  if (misplaced != early.end()) return misplaced_option(app, *misplaced);
  const std::vector<std::string> rest = command.remaining();
  const auto option = std::find_if(rest.begin(), rest.end(), looks_like_option);
  if (option != rest.end()) return unknown_option(command, *option);
  if (!rest.empty()) return left_over(rest);
  const std::string said = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) return about_option(command, said, "is missing");
  if (const std::size_t at = said.find(" excludes ");
      dynamic_cast<const CLI::ExcludesError*>(&error) && at != said.npos) {
    return fmt::format("{} and {} do not go together", said.substr(0, at), said.substr(at + 10));
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) return unconverted(said);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    int most = 0, given = 0;
    const std::size_t limit = said.find("At Most ");
    if (limit != said.npos &&
        std::sscanf(said.c_str() + limit, "At Most %d required but received %d", &most, &given) == 2) {
      return about_option(command, said, fmt::format("takes at most {} values, not {}", most, given));
    }
    const bool none = said.find("required") != said.npos;
    return about_option(command, said, none ? "needs a value" : "takes another number of values");
  }
  return said;
}

}  // namespace

std::string nearest_word(const std::vector<std::string>& known, std::string_view typed) {
  std::string nearest;
  std::size_t least = 3;
  for (const std::string& word : known) {
    const std::size_t apart = letters_apart(typed, word);
    if (apart < least) {
      least = apart;
      nearest = word;
    }
  }
  return nearest;
}

CLI::Validator number_check(double low, double high, const std::string& shown) {
  return {[low, high, shown](std::string& word) -> std::string {
            double number = 0;
            if (!query::parse_decimal(word, number) || std::isnan(number)) return "\"" + word + "\" is no number";
            const bool right = number >= low && number <= high;
            return right ? "" : word + " " + what_is_right(low, shown);
          },
          shown};
}

CLI::Validator number_of_zero_or_more() { return number_check(0, kInfinity, "NONNEGATIVE"); }
CLI::Validator number_above_zero() {
  return number_check(std::numeric_limits<double>::denorm_min(), kInfinity, "POSITIVE");
}

CLI::Validator one_of(std::vector<std::string> words) {
  std::string shown = fmt::format("{{{}}}", fmt::join(words, ","));
  return {[words = std::move(words)](std::string& word) -> std::string {
            if (std::find(words.begin(), words.end(), word) != words.end()) return "";
            const std::string meant = nearest_word(words, word);
            return fmt::format(
                "there is no \"{}\"; {}", word,
                meant.empty() ? fmt::format("known: {}", fmt::join(words, ", ")) : "did you mean \"" + meant + "\"?");
          },
          std::move(shown)};
}

namespace {

void complain_of(const CLI::App& app, const std::string& words) {
  const CLI::App& command = asked_command(app);
  complain("{}", words);
  const std::string name = &command == &app ? "" : " " + command.get_name();
  fmt::print(stderr, "`pdepth{} --help` shows what it takes.\n", name);
}

}  // namespace

void complain_of_usage(const CLI::App& app, const CLI::ParseError& error) { complain_of(app, words_for(app, error)); }

bool complain_of_empty_word(const CLI::App& app) {
  const CLI::App& command = asked_command(app);
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& word : option->results()) {
      if (!word.empty()) continue;
      complain_of(app, about_option(command, option->get_name(), "is empty"));
      return true;
    }
  }
  return false;
}

}  // namespace pd::cli
