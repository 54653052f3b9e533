#include "manual.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "commands.hpp"
#include "pd/numeric/whole_file.hpp"
#include "report/page.hpp"
#include "support/complain.hpp"

namespace pd::cli {

namespace {

/// Characters of a choice that still stand in the line of its option.
constexpr std::size_t kLongestChoice = 60;

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Text as troff prints it: a hyphen that is typed stays a minus, and no line of text is taken for a request.
std::string roff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_begins = c == '\n';
  }
  return out;
}

std::string verbatim(const std::string& text) { return ".nf\n" + roff(text) + "\n.fi\n"; }

/// The words of a choice such as "TEXT:{outer,inner}"; none for other types.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0 || option.get_type_size_max() == 0; }

/// "-o, --output FILE.obj", or "--complete[=straight|escape]" for a flag that may carry a word.
std::string heading_of(const CLI::Option& option) {
  if (!option.nonpositional()) return fmt::format("\\fI{}\\fR", roff(option.get_name(true)));
  std::string names;
  for (const std::string& name : CLI::detail::split(option.get_name(false, true), ',')) {
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
  }
  const std::vector<std::string> words = choices_of(option);
  if (const std::string list = fmt::format("{}", fmt::join(words, "|")); !words.empty()) {
    if (is_flag(option)) return names + roff("[=" + list + "]");
    return names + (list.size() <= kLongestChoice ? roff(" " + list) : " \\fIWORD\\fR");
  }
  if (is_flag(option)) return names;
  std::string type = option.get_type_name();
  if (const std::size_t colon = type.rfind(':'); colon != std::string::npos) type.erase(0, colon + 1);
  return names + fmt::format(" \\fI{}\\fR", roff(type));
}

std::string options_of(const CLI::App& app, bool positional) {
  std::string text;
  for (const CLI::Option* option : app.get_options()) {
    if (option->nonpositional() == positional) continue;
    std::string words = option->get_description();
    if (const std::string usual = option->get_default_str(); !usual.empty()) words += fmt::format(" [{}]", usual);
    if (const std::string list = fmt::format("{}", fmt::join(choices_of(*option), ", "));
        list.size() > kLongestChoice) {
      words += ": " + list;
    }
    text += ".TP\n" + heading_of(*option) + "\n" + roff(words.empty() ? "No description." : words) + "\n";
  }
  return text;
}

std::string page_head(const std::string& name, const std::string& what) {
  return fmt::format(".TH {} 1 \"\" \"pdepth {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", name,
                     roff(report::program_version()), roff(name), roff(what));
}

std::string overview_page(const CLI::App& app) {
  std::string text = page_head("pdepth", "exact and certified penetration depth of bodies");
  text += ".SH SYNOPSIS\n\\fBpdepth\\fR \\fISUBCOMMAND\\fR [\\fIOPTION\\fR]...\n.SH DESCRIPTION\n" +
          roff(app.get_description()) + "\n.SH SUBCOMMANDS\n";
  for (const CLI::App* command : subcommands_of(app)) {
    text += fmt::format(".TP\n\\fB{0}\\fR\n{1}: see \\fBpdepth\\-{0}\\fR(1).\n", roff(command->get_name()),
                        roff(command->get_description()));
  }
  return text + ".SH OPTIONS\n" + options_of(app, false) + ".SH EXAMPLES AND EXIT CODES\n" + verbatim(app.get_footer());
}

std::string subcommand_page(const CLI::App& command) {
  const std::string name = "pdepth-" + command.get_name();
  std::string places;
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) continue;
    const std::string place = roff(option->get_name(true));
    places += option->get_required() ? fmt::format(" \\fI{}\\fR", place) : fmt::format(" [\\fI{}\\fR]", place);
  }
  std::string text = page_head(name, command.get_description());
  text += fmt::format(".SH SYNOPSIS\n\\fBpdepth {}\\fR [\\fIOPTION\\fR]...{}\n", roff(command.get_name()), places);
  if (!places.empty()) text += ".SH ARGUMENTS\n" + options_of(command, true);
  text += ".SH OPTIONS\n" + options_of(command, false);
  if (!command.get_footer().empty()) text += ".SH NOTES\n" + verbatim(command.get_footer());
  return text + ".SH SEE ALSO\n\\fBpdepth\\fR(1)\n";
}

/// A line of the script's table: the words that may follow a subcommand, its option, or its option and "=".
std::string completion_case(const std::string& pattern, const std::vector<std::string>& words) {
  return fmt::format("    '{}') words='{}' ;;\n", pattern, fmt::join(words, " "));
}

}  // namespace

int write_manual_pages(const CLI::App& app, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    complain("{} cannot be made: {}", folder, error.message());
    return kFailed;
  }
  const auto write = [&](const std::string& name, const std::string& text) {
    const std::string file = std::filesystem::path(folder) / (name + ".1");
    if (write_whole_file(file, text)) return true;
    complain("{} cannot be written: {}", file, std::strerror(errno));
    return false;
  };
  if (!write("pdepth", overview_page(app))) return kFailed;
  for (const CLI::App* command : subcommands_of(app)) {
    if (!write("pdepth-" + command->get_name(), subcommand_page(*command))) return kFailed;
  }
  return kDone;
}

std::string bash_completion(const CLI::App& app) {
  std::vector<std::string> names{"help"};
  std::string options, choices;
  const auto add = [&](const CLI::App& command, const std::string& name) {
    std::vector<std::string> words;
    for (const CLI::Option* option : command.get_options()) {
      if (!option->nonpositional()) continue;
      for (const std::string& word : CLI::detail::split(option->get_name(false, true), ',')) {
        words.push_back(word);
        const std::vector<std::string> list = choices_of(*option);
        if (list.empty()) continue;
        choices += completion_case(name + " " + word + "=", list);
        if (!is_flag(*option)) {
          choices += completion_case(name + " " + word, list);
          continue;
        }
        for (const std::string& choice : list) words.push_back(word + "=" + choice);
      }
    }
    options += completion_case(name, words);
  };
  for (const CLI::App* command : subcommands_of(app)) {
    names.push_back(command->get_name());
    add(*command, command->get_name());
  }
  std::vector<std::string> first = names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& word : CLI::detail::split(option->get_name(false, true), ',')) first.push_back(word);
  }
  return fmt::format(R"(# Completion of pdepth for bash, written by `pdepth help --completion bash`.
_pdepth() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words=''
  # Readline takes "=" for a word of its own.
  if [[ $word == = ]]; then
    word='' before+='='
  elif [[ $before == = ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}=
  fi
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{}' -- "$word")
    return
  fi
  if [[ ${{COMP_WORDS[1]}} == help ]]; then
    mapfile -t COMPREPLY < <(compgen -W '{}' -- "$word")
    return
  fi
  case "${{COMP_WORDS[1]}} $before" in
{}  esac
  if [[ -z $words && $word == -* ]]; then
    case "${{COMP_WORDS[1]}}" in
{}    esac
  fi
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}}
complete -F _pdepth pdepth
)",
                     fmt::join(first, " "), fmt::join(names.begin() + 1, names.end(), " "), choices, options);
}

}  // namespace pd::cli
