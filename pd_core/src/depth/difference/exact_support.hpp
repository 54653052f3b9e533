/// @file
/// Exact faces of two posed polytopes in an exact direction: the primitive of every exact engine.
#pragma once

#include <cstdint>
#include <vector>

#include "shape/posed_pair.hpp"
#include "structure/overlay/facet_of_difference.hpp"

namespace pd::detail {

/// A non-zero exact direction and its unit vector in doubles (each coordinate within 4u).
struct ExactDirection {
  explicit ExactDirection(Dyadic3 direction);
  Dyadic3 exact;
  Vec3 unit;
};

/// Every vertex of one body that lies exactly on its supporting plane, ascending.
using SupportFace = std::vector<std::int32_t>;

/// Vertices of B that maximise <R_B v, direction>, exactly. O(n) doubles, exact arithmetic for ties within rounding
/// only.
[[nodiscard]] SupportFace support_face_b(const PosedPair& pair, const ExactDirection& direction);
/// Vertices of A that minimise <R_A v, direction>, exactly.
[[nodiscard]] SupportFace support_face_a(const PosedPair& pair, const ExactDirection& direction);

/// The facet of a body whose loop is made of exactly these vertices (at least three).
[[nodiscard]] int common_facet(const ConvexPolytope& body, const SupportFace& vertices);

/// `common_facet`, and of a flat body's two such facets the one whose posed normal has a positive product with
/// `outward`.
[[nodiscard]] int facing_facet(const ConvexPolytope& body, const SupportFace& vertices, const Mat3& rotation,
                               const Vec3& outward);

/// The facet of P with this exact outward normal: a facet of one body and the lowest vertex of the other's face, or two
/// edges. Requires that the two support faces span a plane (the direction is a facet normal of P).
[[nodiscard]] FacetOfDifference facet_of_direction(const PosedPair& pair, const ExactDirection& normal);

}  // namespace pd::detail
