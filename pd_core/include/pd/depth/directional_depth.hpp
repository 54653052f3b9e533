/// @file
/// Depth along a given direction: the least t >= 0 for which A moved by t d/|d| is separated from B.
///
/// With the origin inside P = B + (-A) this is where the ray from the origin along d leaves P ([A] section 3, Delta(u);
/// [D] for translations); 0 when the bodies do not overlap.
#pragma once

#include <cstdint>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"

namespace pd {

class Scratch;

enum class DirectionalMethod : std::uint8_t {
  portal,   ///< a triangle of vertices of P across the ray, pushed outwards: about 1.3 supports per doubling of n
            ///< (measured)
  overlay,  ///< every facet of P
};

struct DirectionalDepth {
  ContactClass contact = ContactClass::separated;
  double depth = 0;
  double lower = 0;  ///< lower <= exact <= upper; neighbouring doubles (or equal)
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< of the facet of P that the ray leaves through (overlapping only)
  Feature feature_a;
  Feature feature_b;
  Statistics statistics;
};

/// Directional depth of two posed polytopes, exact on the stored numbers and poses: every choice is made by the exact
/// sign of a determinant, and the crossing point is rounded from a rational.
///
/// @param direction  any finite length but zero.
/// @return ErrorCode::zero_direction or non_finite ("direction"); unsupported when a shape is smooth or has a margin.
[[nodiscard]] Expected<DirectionalDepth> directional_depth(const PosedShape& a, const PosedShape& b,
                                                           const Vec3& direction, Scratch& scratch,
                                                           DirectionalMethod method = DirectionalMethod::portal);

}  // namespace pd
