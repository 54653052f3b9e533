/// @file
/// How many random cases a test takes and from which seed: the volumes of the long runs are asked for by name.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace pd::test {

/// `variable` of the environment asks for another number than the usual one.
inline int wanted_cases(const char* variable, int usual) {
  const char* wanted = std::getenv(variable);
  return wanted == nullptr ? usual : std::atoi(wanted);
}

/// PD_CASES_SEED moves the seed of every test that asks here, for cases that nobody has worked on.
inline std::uint64_t wanted_seed(std::uint64_t usual) {
  const char* wanted = std::getenv("PD_CASES_SEED");
  return wanted == nullptr ? usual : usual + static_cast<std::uint64_t>(std::atoll(wanted));
}

}  // namespace pd::test
