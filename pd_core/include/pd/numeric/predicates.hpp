/// @file
/// Exact orientation tests on doubles: the sign of a determinant of the stored numbers, never that of a rounded one.
///
/// Stages: 1. doubles with a running error bound, 2. double-double with an error bound (orient3d), 3. expansions, exact
/// while no product can over- or underflow, 4. dyadic numbers, exact always. [S] Shewchuk, "Adaptive precision
/// floating-point arithmetic and fast robust geometric predicates", 1997.
///
/// Laws, each with its test in tests/numeric/predicates_test.cpp:
/// 1. antisymmetry: an exchange of two points negates the sign (PermutationsTurnTheSign);
/// 2. invariance: even permutations keep it, so orient2d(a, b, c) = orient2d(b, c, a) and orient3d(a, b, c, d) =
///    orient3d(b, c, a, d), while orient3d(b, c, d, a) = -orient3d(a, b, c, d) (CyclesKeepTheSign);
/// 3. a point given twice makes the sign 0 (Incidence);
/// 4. multiplication of all coordinates by a power of two keeps it, as long as none over- or underflows
///    (PowersOfTwoKeepTheSign);
/// 5. range of exactness: all finite doubles, subnormal ones included (AgreeWithRationalsAtAnyMagnitude).
/// None of the laws holds for the sign of a rounded determinant.
#pragma once

#include <array>
#include <cstdint>

#include "pd/numeric/vector.hpp"

namespace pd {

/// Which stage decided how often; the caller owns the counters.
struct PredicateStages {
  std::int64_t filtered = 0;
  std::int64_t double_double = 0;
  std::int64_t expansion = 0;
  std::int64_t dyadic = 0;
};

/// Sign of (b - a) x (c - a): 1 when a, b, c turn counter-clockwise, -1 clockwise, 0 when they are collinear.
/// Requires finite numbers. `stages`, where given, counts the stage that decided.
[[nodiscard]] int orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b,
                           const std::array<double, 2>& c, PredicateStages* stages = nullptr);

/// Sign of <(b - a) x (c - a), d - a>. It is 1 when d lies on the side from which a, b, c turn counter-clockwise
/// (above an outward facet), -1 on the other side, and 0 when the four are coplanar. Requires finite numbers.
[[nodiscard]] int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                           PredicateStages* stages = nullptr);

/// True when the three points lie on one line (coincident points do).
[[nodiscard]] bool collinear(const Vec3& a, const Vec3& b, const Vec3& c, PredicateStages* stages = nullptr);

/// True when the four points lie in one plane.
[[nodiscard]] inline bool coplanar(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                   PredicateStages* stages = nullptr) {
  return orient3d(a, b, c, d, stages) == 0;
}

}  // namespace pd
