/// @file
/// Depth along a given direction: the least t >= 0 for which A moved by t d/|d| is separated from B.
///
/// With the origin inside P = B + (-A) this is where the ray from the origin along d leaves P ([A] section 3, Delta(u);
/// [D] for translations); 0 when the bodies do not overlap.
#pragma once

#include <cstdint>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd {

class Scratch;

enum class DirectionalMethod : std::uint8_t {
  portal,     ///< a triangle of vertices of P across the ray, pushed outwards: about 1.3 supports per doubling of n
              ///< (measured)
  hierarchy,  ///< the same with supports from the bodies' inner hierarchies: O(log n) each ([D] Lemma 5.4); polytopes
  overlay,    ///< every facet of P; polytopes
};

/// The inner hierarchies of two bodies, built once for many rays.
struct DirectionalHierarchies {
  const PolyhedralHierarchy* a;
  const PolyhedralHierarchy* b;
};

struct DirectionalDepth {
  ContactClass contact = ContactClass::separated;
  double depth = 0;
  double lower = 0;  ///< lower <= exact <= upper; neighbouring doubles (or equal) for polytopes without margins
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< of the facet of P that the ray leaves through (overlapping only)
  Feature feature_a;
  Feature feature_b;
  Statistics statistics;
};

/// Directional depth of two posed bodies.
///
/// Polytopes: exact on the stored numbers and poses; every choice is made by the exact sign of a determinant, and the
/// crossing point is rounded from a rational. Smooth bodies and bodies with margins: a certified bracket from doubles,
/// about 1e-12 wide relative to the depth where the bodies overlap by much more than rounding.
///
/// @param direction  any finite length but zero.
/// @param hierarchies  for DirectionalMethod::hierarchy: those of the two bodies' polytopes, or nullptr (they are built
/// for this ray, in linear time).
/// @return ErrorCode::zero_direction or non_finite ("direction"); unsupported for another method than portal when a
/// shape is smooth or has a margin; not_full_dimensional for hierarchies of flat bodies.
///
/// Departure: [D] Theorem 5.6 descends both hierarchies in step and needs O(log n log m) in the worst case; the portal
/// search asks O(log) supports by measurement only, so that with hierarchies its cost is O(log^2) measured, not proved.
[[nodiscard]] Expected<DirectionalDepth> directional_depth(const PosedShape& a, const PosedShape& b,
                                                           const Vec3& direction, Scratch& scratch,
                                                           DirectionalMethod method = DirectionalMethod::portal,
                                                           const DirectionalHierarchies* hierarchies = nullptr);

}  // namespace pd
