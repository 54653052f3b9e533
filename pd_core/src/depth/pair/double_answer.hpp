/// @file
/// From a face or a simplex of points of P in doubles to an answer: bracket, translation, witnesses and features. The
/// counterpart of certificate/exact_answer.hpp.
#pragma once

#include "depth/expansion/inner_surface.hpp"
#include "depth/pair/polytope_depth.hpp"

namespace pd::detail {

/// The corners of a face of a surface inside P.
inline void face_corners(const InnerSurface& surface, int f, DifferenceVertex (&corners)[3]) {
  for (int i = 0; i < 3; ++i) corners[i] = surface.vertices[surface.face(f).v[i]];
}

/// Class, bracket, normal and translation of cores that overlap.
/// @param lower, upper  of the cores' depth; margins are added.
/// @param normal        unit.
void set_depth(const PolytopePair& pair, double lower, double upper, const Vec3& normal, PenetrationDepth& out);

/// Class and bracket from an interval of the cores' signed distance (distance, or minus depth) whose upper end may not
/// lie below minus the margins of touching cores: of cores apart, or nearly touching. An interval that holds 0 after
/// the margins is `touching` (`Bracket::contact`). Normal and witnesses of the swept surfaces are set.
void set_signed_distance(double margin, double core_lower, double core_upper, PenetrationDepth& out);

/// An interval that holds 0 and is far wider than asked is no touching contact. Where most of it is overlap, the answer
/// is the plane that proves it: `overlapping` with lower = 0, so that nobody loses a contact of that depth.
/// @param size  of the pair: below a millionth of it a contact is touching for every engine.
void keep_wide_contact(double size, PenetrationDepth& out);

/// Witnesses: the combinations of the corners' vertices on A and on B. Weights need not sum to 1; negative ones count
/// as 0. `out.normal` is set.
void set_witnesses(const PolytopePair& pair, const DifferenceVertex* corners, const double* weights, int count,
                   PenetrationDepth& out);

/// The same where B's point is A's, moved by `out.translation`.
void set_witnesses_of_depth(const PolytopePair& pair, const DifferenceVertex* corners, const double* weights, int count,
                            PenetrationDepth& out);

/// The features that the corners' vertices span. A facet's partner is a vertex, also where two facets are parallel.
void set_features(const PolytopePair& pair, const DifferenceVertex (&corners)[3], PenetrationDepth& out);

/// Witnesses and features of cores that overlap, from the nearest face; depth and normal are set.
void set_contact(const PolytopePair& pair, const DifferenceVertex (&corners)[3], const double (&weights)[3],
                 PenetrationDepth& out);

}  // namespace pd::detail
