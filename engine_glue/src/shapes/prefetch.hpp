/// @file
/// Asks for memory before it is needed. Between two visits to a pair the constraint solver has driven its manifold and
/// memory out of the caches; a query takes as long as all of it takes to come back.
#pragma once

#include <cstddef>

namespace pd::detail {

inline void fetch_bytes(const void* start, std::size_t size) {
  constexpr std::size_t kLine = 64;
  const char* const bytes = static_cast<const char*>(start);
  for (std::size_t i = 0; i < size; i += kLine) __builtin_prefetch(bytes + i);
}

template <class T>
void fetch(const T& value) {
  fetch_bytes(&value, sizeof(T));
}

}  // namespace pd::detail
