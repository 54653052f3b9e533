/// @file
/// The last step of every exact engine: from a supporting plane of P to the answer's class, bracket, translation,
/// normal and witnesses, each proved on the stored numbers.
#pragma once

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/certificate/support_faces.hpp"
#include "depth/distance/gjk_exact.hpp"
#include "pd/depth/depth_answer.hpp"
#include "shape/margins.hpp"

namespace pd::detail {

/// Width of the bracket that doubles are asked for, in units of L: `Bracket::certified` less the last roundings.
inline constexpr double kCertifiedWidth = 1.8e-14;

/// Core answers, margins added: the cores overlap and the plane of `facet` is the nearest plane of a facet of P (or
/// supports the whole of P there, with more of it than `facet` names).
///
/// Tightest: lower and upper are the exact depth (core depth + margins) rounded down and up; the translation is a
/// triple of doubles outside int P exactly, no longer than upper; where no such triple exists (the exact depth is a
/// double, its translation is not) upper is the next double. Certified: upper - lower <= 2e-14 L. Decided in
/// double-double where its error bound allows, then exactly; allocates in exact arithmetic only.
/// @param faces  a buffer.
void answer_overlapping(const PosedPair& pair, const FacetOfDifference& facet, const Margins& margins, Bracket bracket,
                        SupportFaces& faces, PenetrationDepth& out);
/// The same with `faces` collected and `plane` measured before.
void answer_overlapping(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane,
                        const SupportFaces& faces, const Margins& margins, Bracket bracket, PenetrationDepth& out);

/// The cores touch: a supporting plane with this normal passes through the origin, and `nearest` holds the origin.
/// Touching without margins, else overlapping by them.
void answer_touching(const PosedPair& pair, const ExactDirection& normal, const ExactClosestPoint& nearest,
                     const Margins& margins, PenetrationDepth& out);

/// The cores are apart: separated, touching or overlapping by the margins, decided exactly.
void answer_separated(const PosedPair& pair, const ExactClosestPoint& nearest, const Margins& margins,
                      PenetrationDepth& out);

/// The same from a proof in double-double, `faces` collected with it. Returns false, for another engine to answer,
/// where that leaves the rounding of the distance, or of what the margins leave of it, open.
[[nodiscard]] bool answer_separated(const PosedPair& pair, const ProvenSeparation& proof, const SupportFaces& faces,
                                    const Margins& margins, Bracket bracket, PenetrationDepth& out);

}  // namespace pd::detail
