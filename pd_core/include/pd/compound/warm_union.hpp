/// @file
/// The memory of one pair of unions of convex parts between frames: the pair of parts that told their class, the way
/// out, and which P_ij held which cube of translations.
///
/// Nothing in it is trusted: every cube, pair and placement is judged at the present poses, so that a warm answer
/// carries the same proof as a cold one.
#pragma once

#include <cstddef>
#include <memory>

#include "pd/numeric/language.hpp"

namespace pd {

namespace detail {
struct WarmUnionState;
}

/// Opaque, movable, copyable. Holds for one pair of compounds, known by their numbers of parts; given to others, or in
/// the other order, it costs time and changes no answer. Where an allocation fails it may be used on.
class WarmUnion {
 public:
  WarmUnion() noexcept;
  ~WarmUnion();
  WarmUnion(WarmUnion&&) noexcept;
  WarmUnion& operator=(WarmUnion&&) noexcept;
  WarmUnion(const WarmUnion&);
  WarmUnion& operator=(const WarmUnion&);

  /// Forgets everything.
  void clear();
  /// Bytes held: 24 for each cube of the last search, under 1 MB for deep unions of 80 parts each.
  [[nodiscard]] std::size_t memory_bytes() const;

  /// For the engines.
  [[nodiscard]] detail::WarmUnionState& state();

 private:
  std::unique_ptr<detail::WarmUnionState> state_;
};

}  // namespace pd
