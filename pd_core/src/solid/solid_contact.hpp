/// @file
/// The class of two posed solids, exact on the stored numbers.
#pragma once

#include <cstdint>

#include "pd/depth/depth_answer.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

struct SolidContact {
  ContactClass contact = ContactClass::separated;
  /// Two triangles that meet and tell the class; -1 where one solid lies inside of the other, and for separated solids.
  std::int32_t triangle_a = -1;
  std::int32_t triangle_b = -1;
  std::int64_t pairs = 0;  ///< of triangles that were tested
};

/// Time: the pairs of triangles whose boxes meet, until one shows that the interiors meet.
[[nodiscard]] SolidContact contact_of(const PosedSolids& solids);

}  // namespace pd::detail
