/// @file
/// The search of an expanding polytope as a file of JSON lines: `pdepth depth --trace FILE` writes it, `pdepth demo
/// difference --trace FILE` draws it (pd_core/docs/search_trace.md).
///
/// Line 1 is the pair as a line of the protocol (`pdepth query` answers it); a line for every step, with "step"; a line
/// at the end of every search, with "end"; last, with "answer", the answer of the whole query.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pd/depth/search_observer.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::query {

/// Collects the lines; a search is some hundred steps, so they fit in memory.
class SearchRecorder final : public SearchObserver {
 public:
  /// @param pair  two polytopes without margins. @param method  the protocol's word.
  SearchRecorder(const Pair& pair, std::string_view method);
  void on_step(const SearchStep& step) override;
  void on_end(const SearchEnd& end) override;
  void add_answer(const PenetrationDepth& answer, const Pair& pair, std::int64_t nanoseconds);

  [[nodiscard]] const std::string& lines() const { return lines_; }
  [[nodiscard]] int steps() const { return steps_; }

 private:
  std::string lines_;
  int steps_ = 0;
};

/// A file read back. The words of its steps are literals, as those of an observed search.
struct SearchFile {
  Pair pair;
  std::vector<SearchStep> steps;
  std::vector<SearchEnd> ends;
};

/// @throws Refusal unreadable_file, or what is wrong with a line, with the line's number.
[[nodiscard]] SearchFile read_search_file(const std::filesystem::path& path);

}  // namespace pd::query
