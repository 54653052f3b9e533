/// @file
/// Depth of two solids of at most 32 vertices and 64 facets, in doubles with a certificate: all facets of P by their
/// Gauss maps (gauss_sat_kernels.hpp; of two boxes gauss_sat_boxes.hpp), no search.
///
/// Why it proves anything: the boundary of P consists of facets with a facet of one body and of parallelograms of two
/// edges whose arcs cross. A facet's plane supports P, and h_P changes by at most the turn of its normal times the
/// reach. A parallelogram lies above its lowest corner along any unit vector. Signs decide which arcs cross; a pair
/// counts where one of them is less than its error.
///
/// Slivers, parallelograms of edges that are nearly parallel, have normals that are badly known. They are bounded by
/// their lowest corner along the normals beside their edges, and, where they lie next to the winner, by its foot: let q
/// be the point of P below the origin, d its distance along the winner's normal n, and m how far inside of the winner q
/// lies. A plane that supports P across a normal turned from n by an angle t towards a unit vector e of the winner's
/// plane has q and q + m e behind it, so that it lies no nearer than d cos t + m sin t, which is d or more where
/// tan(t / 2) <= m / d.
///
/// Where that leaves the bracket too wide, where the point below the origin is neither inside the winner nor where
/// faces of both bodies meet in its plane, and where the class is in doubt, the answer is `undecided`, and the caller
/// grows a surface.
#pragma once

#include <optional>

#include "depth/difference/bracket_width.hpp"
#include "depth/facets/gauss_boxes.hpp"
#include "depth/facets/gauss_sat_kernels.hpp"
#include "depth/facets/near_facets.hpp"

namespace pd::detail {

enum class GaussSatStatus : std::uint8_t { certified, separated, undecided };

struct GaussSatDepth {
  GaussSatStatus status = GaussSatStatus::undecided;
  /// The nearest facet, if it is certified. If the bodies are separated: the separating direction as the normal, and
  /// the piece across it, which is not known if its facet is -1.
  NearFacets nearest;
  /// A point of either body, relative to A's translation, if the point below the origin does not lie inside of the
  /// winner alone: faces of both bodies meet in its plane. Boxes that are certified always have it.
  std::optional<FootPoints> foot;
  VertexPair corner{0, 0};  ///< of the winner, else the vertices of P farthest along the normal
};

/// True if both bodies are solids of so few facets.
[[nodiscard]] bool gauss_sat_applies(const ConvexPolytope& a, const ConvexPolytope& b);

/// True if it is worth it, measured: both are small, or neither is long or flat and their centres are close to each
/// other. A surface needs 15 supports or more then, against 10 where bodies meet by their rims.
[[nodiscard]] bool gauss_sat_pays(const PolytopeDifference& difference);

/// Requires `gauss_sat_applies`, and of the difference `prepare_supports` and a reach between 2^-100 and 2^100. No
/// allocation. Time O(V F + K^2) for V vertices, F facets and K edges that may belong to a facet of P as near as the
/// nearest of either body.
/// @param near  asks for the facets that are not much farther, of small bodies; nullptr where the nearest is enough.
[[nodiscard]] GaussSatDepth gauss_sat_depth(const Pose& pose_a, const Pose& pose_b,
                                            const PolytopeDifference& difference, const BracketWidth& width,
                                            NearGaussPieces* near);

/// A facet's distance errs, in units of the reach, by the turn of its normal (16u and 3u as it is stored, 9u for the
/// cofactors and 5u for their product), by the vertices and products of its height (12u) and by a root and a quotient
/// (3u). A parallelogram's lowest corner errs by 22u: its point by 10.5u, products and sums by 8u, root and quotient.
inline constexpr double kGaussLowerError = 50 * kUnitRoundoff;
/// h_P(n) exceeds <s, n> of the support s by at most this: 10.5u for a point, 6u for scans that compare products,
/// 3u for the product, 2u for the length of n.
inline constexpr double kGaussUpperError = 24 * kUnitRoundoff;

/// What turns facets' normals to those of -A and of B.
struct TurnedNormals {
  TurnedNormals(const Pose& pose_a, const Pose& pose_b);
  Mat3 of_a, of_b;
};

/// Outward, of any length.
[[nodiscard]] Vec3 normal_of_piece(const GaussPiece& piece, const TurnedNormals& turned,
                                   const PolytopeDifference& difference);

/// The features of the bodies that make the piece, s being its support.
void name_piece(const GaussPiece& piece, const DifferenceVertex& s, NearFacets& out);

}  // namespace pd::detail
