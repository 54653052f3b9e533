/// @file
/// A remembered surface looked at where it may have come near: most frames need a few of its planes only.
///
/// When all planes were last computed (WarmReference), every face f was d_f from the origin and at least c
/// from an inner point q, with both behind it. Its points have moved by at most delta_f since: by as much as a base
/// vertex has, and by both bodies' turning over the distance from there. Then
/// 1. if delta_f < c for all f, no face has crossed q, so the surface still winds round q as it did, at least once;
/// 2. a face with d_f - delta_f > rho is farther than rho from the origin still, and has not met the segment from the
///    origin to q (a plane's distance is linear along it);
/// 3. the planes of the other faces are computed anew; where they have the origin and q behind them, they miss that
///    segment, too, so the surface winds round the origin, and round the whole ball that no face reaches.
/// As in inner_surface.hpp, that ball lies in P. Neither orientation nor convexity of the faces left alone is asked
/// for.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/convex_shape.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

/// More faces and vertices are not remembered. A closed triangulated surface of F faces has F / 2 + 2 vertices.
inline constexpr int kMaxRememberedFaces = 128;
inline constexpr int kMaxRememberedVertices = kMaxRememberedFaces / 2 + 2;

struct CachedFace {
  std::int16_t vertex[3];
  std::int16_t neighbour[3];
};

/// When the planes of all faces were last computed, and what that says as long as the bodies have not moved far.
struct WarmReference {
  std::optional<ConvexPolytope> a, b;  ///< the very shapes: what was measured on others says nothing
  Mat3 rotation_a = Mat3::Zero();
  Mat3 rotation_b = Mat3::Zero();
  Vec3 offset = Vec3::Zero();  ///< t_B - t_A
  VertexPair base{0, 0};       ///< a vertex of the nearest face
  int nearest = 0;             ///< that face
  Vec3 inner = Vec3::Zero();   ///< a point that every face has behind it ...
  double clearance = 0;        ///< ... by this much at least; 0: nothing is known
  double widest = 0;           ///< the largest spread
  int uses = 0;                ///< frames that it has answered
  int pause_length = 0;        ///< frames to go without one after one that answered none
  int pause = 0;               ///< how many of them are left
  // By face, padded to whole blocks: the distance of its plane from the origin, rounded down, and how far its corners
  // are from the base at most, in A and in B together, rounded up.
  std::vector<float> distances;
  std::vector<float> spreads;
};

/// Of bodies apart, one of them smooth: points of the cores whose differences surround the closest point of P, each in
/// its body's frame.
struct WarmSmoothPoints {
  std::optional<ConvexShape> a, b;  ///< the very shapes: points of others lie anywhere
  Vec3 on_a[3];
  Vec3 on_b[3];
  int count = 0;
};

/// Of bodies that rest on each other: the facet of either that faces the other, and how often they were of no use
/// (Bracket::contact, pair/contact_facets.hpp).
struct WarmFacets {
  struct OfBody {
    std::optional<ConvexPolytope> owner;  ///< the very polytope; facet -1: none
    int facet = -1;
    std::int32_t near = -1;  ///< vertex of the other body that lay on it
  };
  OfBody bodies[2];      ///< of A, of B
  int first = 1;         ///< the one that answered last
  int pause_length = 0;  ///< frames to go without after one without an answer
  int pause = 0;
};

/// What a WarmCertificate holds.
struct WarmState {
  WarmFacets facets;  ///< first: bodies at rest read nothing else, and hosts may fetch it beforehand
  /// The shapes by content, not by address: the same calls give the same bits wherever memory lies.
  std::int32_t vertices_a = 0;
  std::int32_t vertices_b = 0;
  double radius_a = 0;
  double radius_b = 0;
  Vec3 direction = Vec3::Zero();  ///< last normal, or last separating direction
  std::vector<VertexPair> vertices;
  std::vector<CachedFace> faces;
  WarmReference reference;
  // Of bodies apart: the vertices of P around its point closest to the origin.
  VertexPair apart[3];
  int apart_count = 0;
  WarmSmoothPoints smooth;
};

/// The nearest face at the present poses.
struct RememberedFace {
  DifferenceVertex corners[3];  ///< of the face below the origin, where several lie in one plane
  double weights[3];            ///< barycentric coordinates of the origin's projection on them
  Vec3 normal;                  ///< outward, any length
  double distance;              ///< of the plane from the origin, rounded
  int faces_seen;
};

/// What is remembered of a surface whose faces all have the origin behind them: `state.faces` are its slots.
void set_reference(WarmState& state, InnerSurface& surface, const PolytopeDifference& difference);

/// False where the movement is too large, too many faces may be near, or one of them shows the origin in front: the
/// surface must be restored. Time O(faces remembered / 4 + faces near).
[[nodiscard]] bool nearest_remembered(const WarmState& state, const PolytopeDifference& difference,
                                      RememberedFace& out);

}  // namespace pd::detail
