/// @file
/// Questions about P = B + (-A) that are answered without building it.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <cstdint>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"

namespace pd {

class Scratch;

struct DifferenceSupport {
  double value = 0;            ///< h_P(direction) = max <x, direction> over P, from double-double (polytopes)
  std::int32_t vertex_a = -1;  ///< a vertex of A (of its core) that attains it, the lowest of several; -1: smooth
  std::int32_t vertex_b = -1;
};

/// Support of P in a direction of any finite length but zero (the value scales with it). For polytopes the vertices
/// attain the maximum exactly. For smooth bodies `value` is rounded.
/// @return ErrorCode::zero_direction or non_finite ("direction").
/// Time: hill climbing from a table of directions, a few steps on round bodies.
[[nodiscard]] Expected<DifferenceSupport> support_of_difference(const PosedShape& a, const PosedShape& b,
                                                                const Vec3& direction);

/// The place of a point: `overlapping` inside P, `touching` on its boundary (anywhere in a flat P), `separated`
/// outside. The class is as exact as that of `penetration_depth`, for every finite point. Time: as for that class.
/// @return ErrorCode::non_finite or out_of_range ("point").
[[nodiscard]] Expected<ContactClass> point_in_difference(const PosedShape& a, const PosedShape& b, const Vec3& point,
                                                         Scratch& scratch);

/// The part of a line inside P: its points point + t direction / |direction| with enter <= t <= leave.
struct LineCrossing {
  bool crosses = false;  ///< the line meets the interior of P
  double enter_lower = 0, enter_upper = 0;
  double leave_lower = 0, leave_upper = 0;
};

/// The part of a line inside P, of two posed polytopes ([A], remark after Corollary 3.3; [D] Lemma 5.2 for P): two
/// portal searches, one each way. Whether it crosses is exact; the ends are within 2^-46 of their values.
/// @return ErrorCode::zero_direction or non_finite ("direction", "point"), out_of_range ("point"), or unsupported when
/// a shape is smooth or has a margin. Time: O(log) supports, measured.
[[nodiscard]] Expected<LineCrossing> line_in_difference(const PosedShape& a, const PosedShape& b, const Vec3& point,
                                                        const Vec3& direction);

}  // namespace pd
