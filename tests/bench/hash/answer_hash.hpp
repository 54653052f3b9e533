/// @file
/// The bits of answers, hashed: the same on every compiler, instruction set, thread count and run, or named.
///
/// A row is one kind of question (method, bracket, cold or with the memory of the pair, sharp, rounded or curved), its
/// number of answers and the hash of all their bits in order. Generated bodies only: no row depends on a file.
#pragma once

#include <cstdint>
#include <string>

namespace pd::bench {

struct HashSettings {
  std::int64_t pairs = 20000;  ///< generated pairs; each is asked in about ten ways
  std::uint64_t seed = 1;
  std::string out;    ///< file that the rows are written to, or empty
  std::string check;  ///< file of rows that these must be equal to, or empty
};

/// What was found, for a page.
struct HashOutcome {
  std::string csv;  ///< question,answers,hash and, where rows were compared, same
  std::int64_t answers = 0;
  int rows = 0;
  int differing = 0;
  bool compared = false;
};

/// Prints the rows. @param outcome  is filled where it is not null. @return the exit code: 0, 1 where a row differs
/// from `check` or a file cannot be written, 2 where `check` cannot be read or was made with other pairs or another
/// seed.
int run_hash(const HashSettings& settings, HashOutcome* outcome = nullptr);

}  // namespace pd::bench
