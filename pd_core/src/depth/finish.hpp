/// @file
/// The last step of every exact engine: from a supporting plane of P to the answer's class, bracket, translation,
/// normal and witnesses, each proved on the stored numbers.
#pragma once

#include "depth/exact_nearest.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::detail {

/// The margins of two rounded bodies.
struct Margins {
  double a = 0;
  double b = 0;
};

/// The plane {x : weight <normal, x> = level} that supports P and carries its boundary point nearest to the origin. The
/// signed distance of the cores is level / (weight |normal|): positive inside.
struct NearestPlane {
  ExactDirection normal;
  Dyadic weight;  ///< > 0
  Dyadic level;
};

/// The plane through the facet of P with this exact outward normal.
[[nodiscard]] NearestPlane plane_of_facet(const PosedPair& pair, const ExactDirection& normal,
                                          const FacetOfDifference& facet);

/// Core answers, margins added: the cores overlap and `facet` is the nearest facet of P.
///
/// lower and upper are the exact depth (core depth + margins) rounded down and up. The translation is a triple of
/// doubles outside int P exactly, no longer than upper; where no such triple exists (the exact depth is a double, its
/// translation is not) upper is the next double.
void finish_overlapping(const PosedPair& pair, const ExactDirection& normal, const Margins& margins,
                        PenetrationDepth& out);

/// The cores touch: a supporting plane with this normal passes through the origin, and `nearest` holds the origin.
/// Touching without margins, else overlapping by them.
void finish_touching(const PosedPair& pair, const ExactDirection& normal, const ExactNearest& nearest,
                     const Margins& margins, PenetrationDepth& out);

/// The cores are apart: separated, touching or overlapping by the margins, decided exactly.
void finish_apart(const PosedPair& pair, const ExactNearest& nearest, const Margins& margins, PenetrationDepth& out);

}  // namespace pd::detail
