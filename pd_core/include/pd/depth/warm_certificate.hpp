/// @file
/// The memory of one pair between frames: the last surface inside P as vertex-id pairs and triangles, and how far its
/// planes were from the origin when they were last computed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

/// Opaque and movable. Holds for one pair of shapes and shares their storage; given to another pair it is refused and
/// starts afresh.
class WarmCertificate {
 public:
  WarmCertificate() = default;
  /// Forgets everything.
  void clear();
  /// Bytes held.
  [[nodiscard]] std::size_t memory_bytes() const;

  struct CachedVertex {
    std::int32_t a = 0;
    std::int32_t b = 0;
  };
  struct CachedFace {
    std::int16_t vertex[3];
    std::int16_t neighbour[3];
  };
  /// When the planes of all faces were last computed, and what that says as long as the bodies have not moved far.
  struct Reference {
    std::optional<ConvexPolytope> a, b;  ///< the very shapes: what was measured on others says nothing
    Mat3 rotation_a = Mat3::Zero();
    Mat3 rotation_b = Mat3::Zero();
    Vec3 offset = Vec3::Zero();  ///< t_B - t_A
    CachedVertex base;           ///< a vertex of the nearest face
    int nearest = 0;             ///< that face
    Vec3 inner = Vec3::Zero();   ///< a point that every face has behind it ...
    double clearance = 0;        ///< ... by this much at least; 0: nothing is known
    double largest = 0;          ///< |coordinate| of the vertices
    double widest = 0;           ///< the largest spread
    int uses = 0;                ///< frames that it has answered
    int pause_length = 0;        ///< frames to go without one after one that answered none
    int pause = 0;               ///< how many of them are left
    // By face, padded to whole blocks: the distance of its plane from the origin, rounded down, and how far its corners
    // are from the base at most, in A and in B together, rounded up.
    std::vector<float> distances;
    std::vector<float> spreads;
  };
  /// Of bodies apart, one of them smooth: points of the cores whose differences surround the nearest point of P, each
  /// in its body's frame.
  struct SmoothPoints {
    std::optional<ConvexShape> a, b;  ///< the very shapes: points of others lie anywhere
    Vec3 on_a[3];
    Vec3 on_b[3];
    int count = 0;
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
    Reference reference;
    // Of bodies apart: the vertices of P round its point nearest to the origin.
    CachedVertex apart[3];
    int apart_count = 0;
    SmoothPoints smooth;
  };
  [[nodiscard]] State& state() { return state_; }

 private:
  State state_;
};

}  // namespace pd
