/// @file
/// Every buffer that a query needs, owned by the caller: one per thread, grown on first use, never shrunk.
#pragma once

#include <memory>

#include "pd/numeric/language.hpp"

namespace pd {

namespace detail {
struct ScratchBuffers;
}

/// Movable, not copyable, not shared between threads. After the first call of a kind on shapes of a size, further calls
/// allocate nothing (except where exact arithmetic is needed: `Statistics::exact_signs`).
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(Scratch&&) noexcept;
  Scratch& operator=(Scratch&&) noexcept;

  [[nodiscard]] detail::ScratchBuffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<detail::ScratchBuffers> buffers_;
};

}  // namespace pd
