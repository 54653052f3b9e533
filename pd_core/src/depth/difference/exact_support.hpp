/// @file
/// Exact supports of P = B + (-A): the faces of two posed polytopes in an exact direction, and one vertex by hill
/// climbing in a direction known by the signs of its products with edges. The primitives of every exact engine.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "shape/posed_pair.hpp"
#include "shape/support/polytope_support.hpp"
#include "shape/support/vertex_pair.hpp"
#include "structure/exact_climb.hpp"
#include "structure/overlay/facet_of_difference.hpp"

namespace pd::detail {

/// A non-zero exact direction and its unit vector in doubles (each coordinate within 4u).
struct ExactDirection {
  explicit ExactDirection(Dyadic3 direction);
  Dyadic3 exact;
  Vec3 unit;
  Vec3DD leading;  ///< `exact` times a power of two: coordinates up to 2, each within 2^-102
};

/// Every vertex of one body that lies exactly on its supporting plane, ascending.
using SupportFace = std::vector<std::int32_t>;

/// Vertices of B that maximise <R_B v, direction>, exactly: of large solids in time of a climb and of the face, else in
/// O(n) doubles; exact arithmetic for ties within rounding only.
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

/// The same from its two support faces, one of which has three vertices.
[[nodiscard]] FacetOfDifference facet_of_faces(const PosedPair& pair, const SupportFace& on_a, const SupportFace& on_b,
                                               const Vec3& outward);

/// A direction in doubles (common frame) and a bound of each coordinate's error.
struct RoundedDirection {
  Vec3 vector;
  double error;
};

/// u x v for two vectors of a pair in doubles, each coordinate of theirs within `error_u` and `error_v`.
inline RoundedDirection rounded_cross(const Vec3& u, double error_u, const Vec3& v, double error_v) {
  const double su = u.cwiseAbs().sum(), sv = v.cwiseAbs().sum();
  // Input errors, then two products and a difference a coordinate.
  const double error = su * error_v + sv * error_u + 2 * error_u * error_v + 0x1.8p-52 * su * sv;
  return {u.cross(v), error * (1 + 0x1p-48)};
}

/// A vertex of P that is exactly extreme: of B along the direction, of A against it.
/// @param near  vertices where the climbs start, -1: the best of a sample.
/// @param sign  exact sign of <edge, direction> for an edge of A or of B in the common frame; asked only where doubles
/// leave
///              it open.
template <class Sign>
VertexPair support_exactly(const PosedPair& pair, const RoundedDirection& direction, const VertexPair& near,
                           Sign&& sign) {
  const Vec3& n = direction.vector;
  const double size = n.cwiseAbs().sum();
  const double edge_error = pair.vector_error();
  const auto filtered = [&](const PairVector& edge) {
    const Vec3 e = pair.approximate(edge);
    const double value = e.dot(n);
    // |e|_1 (error(n) + 4u |n|_1) + error(e) (|n|_1 + 3 error(n)).
    const double bound =
        e.cwiseAbs().sum() * (direction.error + 0x1p-51 * size) + edge_error * (size + 3 * direction.error);
    if (std::abs(value) > bound * (1 + 0x1p-48) + 0x1p-900) return value > 0 ? 1 : -1;
    return sign(edge);
  };
  const int a = climb_exactly(pair.a(), support_vertex(pair.a(), -(pair.pose_a().rotation().transpose() * n), near.a),
                              [&](int from, int to) { return -filtered(PairVector::edge_a(from, to)); });
  const int b = climb_exactly(pair.b(), support_vertex(pair.b(), pair.pose_b().rotation().transpose() * n, near.b),
                              [&](int from, int to) { return filtered(PairVector::edge_b(from, to)); });
  return {a, b};
}

}  // namespace pd::detail
