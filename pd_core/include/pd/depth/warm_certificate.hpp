/// @file
/// The memory of one pair between frames: the last surface inside P as vertex-id pairs and triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd {

/// Opaque and movable. Holds for one pair of shapes; given to another pair it is refused and starts afresh (the answer
/// is right in any case: a warm answer is certified from the present poses alone).
class WarmCertificate {
 public:
  WarmCertificate() = default;
  /// Forgets everything.
  void clear();
  /// Bytes held.
  [[nodiscard]] std::size_t memory_bytes() const;

  struct CachedVertex {
    std::int32_t a;
    std::int32_t b;
  };
  struct CachedFace {
    std::int16_t vertex[3];
    std::int16_t neighbour[3];
  };
  /// For the engines.
  struct State {
    /// The shapes by content, not by address: the same calls give the same bits wherever memory lies.
    std::int32_t vertices_a = 0;
    std::int32_t vertices_b = 0;
    double radius_a = 0;
    double radius_b = 0;
    Vec3 direction = Vec3::Zero();  ///< last normal, or last separating direction
    std::vector<CachedVertex> vertices;
    std::vector<CachedFace> faces;
  };
  [[nodiscard]] State& state() { return state_; }

 private:
  State state_;
};

}  // namespace pd
