/// @file
/// Depth of two solids of at most eight vertices, in doubles with a certificate: all facets of P by their Gauss maps
/// (small_sat_kernels.hpp), no search.
///
/// Why it proves anything: the boundary of P consists of facets with a facet of one body and of parallelograms of two
/// edges whose arcs cross. A facet's plane supports P, and h_P changes by at most the turn of its normal times the
/// reach. A parallelogram lies above its lowest corner along any unit vector. Signs decide which arcs cross; where one
/// of them is less than its error, as where edges or facets are parallel, a pair that may cross counts by its lowest
/// corner alone. Where that leaves the bracket too wide, where the point below the origin is neither inside the winner
/// nor where faces of both bodies meet in its plane, and where the class is in doubt, the answer is `undecided`, and
/// the caller grows a surface.
#pragma once

#include <optional>

#include "depth/difference/bracket_width.hpp"
#include "depth/facets/near_facets.hpp"
#include "depth/facets/small_sat_kernels.hpp"

namespace pd::detail {

enum class SmallSatStatus : std::uint8_t { certified, separated, undecided };

struct SmallSatDepth {
  SmallSatStatus status = SmallSatStatus::undecided;
  NearFacets
      nearest;  ///< certified ones; of separated bodies the normal, the separating direction, and the piece across it
  int pieces = 0;      ///< measured
  double largest = 0;  ///< |coordinate| of P; certified ones only
  /// Where faces of both bodies meet that lie in one plane, relative to B's translation: where the point below the
  /// origin does not lie inside of the winner alone (flush_faces.hpp).
  std::optional<Vec3> meeting;
};

/// Whether both bodies are solids of so few vertices.
[[nodiscard]] bool small_sat_applies(const ConvexPolytope& a, const ConvexPolytope& b);

/// Requires `small_sat_applies`, and of the difference `prepare_supports` and a reach between 2^-100 and 2^100.
/// Constant time, no allocation.
/// @param near  asks for the facets that are not much farther; nullptr where the nearest one is enough.
[[nodiscard]] SmallSatDepth small_sat_depth(const Pose& pose_a, const Pose& pose_b,
                                            const PolytopeDifference& difference, const BracketWidth& width,
                                            SmallNearPieces* near);

}  // namespace pd::detail
