/// @file
/// Which points of P on a supporting plane the origin's foot is a combination of, where one triangle does not show it:
/// facets of more corners fall into triangles in one plane, and the weights of a thin one mean nothing.
#pragma once

#include <span>

#include "depth/difference/polytope_difference.hpp"

namespace pd::detail {

/// How far the combination with these weights (those below 0 taken as 0) lies aside of the normal's line through the
/// origin; infinite where all are 0.
[[nodiscard]] double miss_across(const DifferenceVertex (&corners)[3], const Vec3& normal, const double (&weights)[3]);

/// Replaces corners and weights by those of the point nearest to the normal's line, among combinations of the
/// corners and of the vertices at `least_height` or higher along the normal. Gilbert, Johnson, Keerthi, "A fast
/// procedure for computing the distance between complex objects in three-dimensional space", 1988, in the plane across
/// the normal.
void find_foot(std::span<const DifferenceVertex> vertices, const Vec3& normal, double least_height,
               DifferenceVertex (&corners)[3], double (&weights)[3]);

}  // namespace pd::detail
