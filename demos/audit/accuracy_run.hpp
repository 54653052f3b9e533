/// @file
/// Engines by families: recorder programs run on generated pairs, their records audited.
///
/// A recorder program answers `--list` with the names of its engines, one a line, and
/// `--engine E --family F --pairs N --vertices V --seed S --out FILE` with a contact record of N pairs of the family at
/// each of its four depths in FILE, and the median nanoseconds of a query on its standard output; with `--cases RECORD`
/// in place of `--family F` with one of the pairs of that record. Ours reads the processor clock of its thread, so that
/// a busy machine's waiting does not count.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "audit/contact_judge.hpp"
#include "report/pair_figure.hpp"

namespace pd::audit {

struct AccuracySettings {
  int pairs = 25;  ///< of each family, at each of its four depths
  int vertices = 32;
  std::uint64_t seed = 1;
  double tolerance = 1e-6;  ///< of missed and phantom, relative to L, for every engine
  int threads = 1;          ///< that audit
  /// Told of each engine and family before it is asked; may be empty.
  std::function<void(const std::string& engine, const std::string& family)> begins = {};
};

/// Largest errors that count as small and as large, relative to L: a contact's is the larger of depth error and normal
/// excess.
inline constexpr double kSmallError = 1e-6;
inline constexpr double kLargeError = 1e-3;

struct AccuracyRow {
  std::string engine;
  std::string family;
  bool failed = false;  ///< the program crashed, ran into its time limit or wrote no record
  std::int64_t contacts = 0;
  std::int64_t missed = 0;
  std::int64_t phantom = 0;
  std::int64_t above_small = 0;
  std::int64_t above_large = 0;
  std::int64_t only_large = 0;  ///< of above_large, those that are neither missed nor phantom
  std::int64_t no_answer = 0;   ///< numbers that are not finite, pairs that could not be judged, and `aborted`
  std::int64_t aborted = 0;     ///< pairs at which the engine ended on an assertion of its own, as the program says
  double worst = 0;             ///< the largest error, relative to L
  double nanoseconds = 0;       ///< a query's median in a family; of an engine, the geometric mean over families
  /// The contact with the largest error, where it was asked for and is above kLargeError.
  std::optional<report::PairFigure> figure;

  /// Contacts that a user would call wrong, each once: missed, phantom, above_large or without an answer.
  [[nodiscard]] std::int64_t wrong() const { return missed + phantom + only_large + no_answer; }
  /// Adds the counts; `nanoseconds` stays.
  void add(const AccuracyRow& other);
};

/// Empty where the program does not run.
[[nodiscard]] std::vector<std::string> engines_of(const std::string& program);

/// Makes an empty file among the temporary ones, whose name begins as told. @throws query::Refusal where there is no
/// folder for them, or none that takes a file
[[nodiscard]] std::string make_temporary_file(const std::string& name);

/// Seconds of processor time after which a recorder is ended.
inline constexpr int kRecorderSeconds = 120;

/// Pairs that a recorder is asked about.
struct AccuracySource {
  std::string family;
  std::string cases;  ///< a record whose pairs are asked instead; empty: the generated family
};

/// Another judge than the audit's own.
using ContactJudge = std::function<Judgement(const RecordedContact&)>;

/// @param draw_above  the worst contact is drawn where its error is larger; infinity: never
/// @param judge  whose counts and errors the row holds; empty: the audit's
[[nodiscard]] AccuracyRow run_accuracy(const std::string& program, const std::string& engine,
                                       const AccuracySource& source, const AccuracySettings& settings,
                                       double draw_above = std::numeric_limits<double>::infinity(),
                                       const ContactJudge& judge = {});

}  // namespace pd::audit
