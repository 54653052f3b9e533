/// @file
/// Vectors of doubles as vectors of double-doubles and back.
#pragma once

#include "numeric/double_double.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

inline Vec3DD widened(const Vec3& v) { return {{v.x(), 0}, {v.y(), 0}, {v.z(), 0}}; }
/// The leading digits.
inline Vec3 high(const Vec3DD& v) { return {v.x.hi, v.y.hi, v.z.hi}; }

}  // namespace pd::detail
