/// @file
/// A vertex of P = B + (-A) by its ids: the difference of one vertex of B and one of A.
#pragma once

#include <cstdint>

namespace pd::detail {

struct VertexPair {
  std::int32_t a;
  std::int32_t b;
};

}  // namespace pd::detail
