#include <cstdio>
#include <cstdlib>

#include "fuzz/input.hpp"

namespace pd::fuzz {

void fail(const char* law, const char* file, int line) {
  std::fprintf(stderr, "broken law: %s (%s:%d)\n", law, file, line);
  std::abort();
}

}  // namespace pd::fuzz
