/// @file
/// One line of the protocol in, one line out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "protocol/line/bounded_line.hpp"
#include "protocol/line/limits.hpp"

namespace pd::query {

/// What a thread keeps between lines.
struct Session {
  Limits limits = {};
  Scratch scratch = {};
  ManifoldScratch manifold_scratch = {};
};

/// An answer, and what it says that others act on.
struct LineAnswer {
  std::string text;  ///< one JSON object, without a newline
  /// "bracket_reached": false, a certified bracket wider than asked.
  bool unreached = false;
  /// An error object with the code limit_exceeded.
  bool limit_exceeded = false;
};

enum class Care : std::uint8_t {
  full,    ///< as the line asks
  coarse,  ///< with a bracket as wide as may be
};

/// Answers one line that is not blank. Throws nothing for what a line holds: a line that cannot be answered is answered
/// by an error object.
[[nodiscard]] LineAnswer answer_line(std::string_view line, Session& session, const IdSeen& id_seen = {});

/// A coarse depth as an answer that is `unreached`: two rays of a grid tell more than nothing. Nothing for
/// other queries, and where the line cannot be answered.
[[nodiscard]] std::optional<LineAnswer> answer_coarsely(std::string_view line, Session& session);

/// The error object limit_exceeded.
/// @param id_text  the caller's id as JSON
[[nodiscard]] LineAnswer refuse_line(std::string_view id_text, std::string message);

/// The answer to a line that is longer than `limits.max_line`.
[[nodiscard]] LineAnswer answer_oversized_line(const Limits& limits);

}  // namespace pd::query
