/// @file
/// The memory of one pair between frames: the last surface inside P, its vertices as ids, and its triangles.
///
/// Nothing in it is trusted: points and planes are computed from the present poses, so that a warm answer carries the
/// same proof as a cold one.
#pragma once

#include <cstddef>
#include <memory>

#include "pd/numeric/language.hpp"

namespace pd {

namespace detail {
struct WarmState;
}

/// Opaque, movable, copyable. Holds for one pair of shapes and shares their storage; given to another pair it is
/// refused and starts afresh. Allocates on first use, then nothing more (below 4 KB).
class WarmCertificate {
 public:
  WarmCertificate() noexcept;
  ~WarmCertificate();
  WarmCertificate(WarmCertificate&&) noexcept;
  WarmCertificate& operator=(WarmCertificate&&) noexcept;
  WarmCertificate(const WarmCertificate&);
  WarmCertificate& operator=(const WarmCertificate&);

  /// Forgets everything.
  void clear();
  /// Bytes held.
  [[nodiscard]] std::size_t memory_bytes() const;

  /// For the engines.
  [[nodiscard]] detail::WarmState& state();

 private:
  std::unique_ptr<detail::WarmState> state_;
};

}  // namespace pd
