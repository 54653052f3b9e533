/// @file
/// The words of the command when something is wrong.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "support/printable.hpp"

namespace pd {

/// Says on standard error what is wrong: "pdepth: " and the words, which may hold names of files.
template <class... Arguments>
void complain(fmt::format_string<Arguments...> words, Arguments&&... arguments) {
  const std::string text = printable(fmt::format(words, std::forward<Arguments>(arguments)...));
  fmt::print(stderr, "pdepth: {}\n", text);
}

}  // namespace pd
