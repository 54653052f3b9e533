/// @file
/// One line of the protocol in, one line out.
#pragma once

#include <string>
#include <string_view>

#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "protocol/limits.hpp"

namespace pd::query {

/// What a thread keeps between lines.
struct Session {
  Limits limits = {};
  Scratch scratch = {};
  ManifoldScratch manifold_scratch = {};
};

/// Answers one line that is not blank with one JSON object, without a newline. Never throws for what a line holds: a
/// line that cannot be answered is answered by an error object.
[[nodiscard]] std::string answer_line(std::string_view line, Session& session);

/// The answer to a line that is longer than `limits.max_line`.
[[nodiscard]] std::string answer_oversized_line(const Limits& limits);

}  // namespace pd::query
