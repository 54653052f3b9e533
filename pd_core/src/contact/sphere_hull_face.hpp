/// @file
/// The face of a hull of spheres that faces a direction: a point, the line between two spheres, or the polygon of a
/// plane that touches three and more.
#pragma once

#include "contact/supporting_face.hpp"

namespace pd::detail {

/// Fills `face` in the hull's own frame; ids are the numbers of the spheres. The line where it leaves the plane across
/// the direction by a sine below `edge_sine`; the polygon next to it where its normal's cosine is at least
/// `face_cosine`.
///
/// @param direction  unit. Time O(k) for k spheres, O(k f) for a polygon of f corners.
void sphere_hull_face(const SphereHull& hull, const Vec3& direction, double edge_sine, double face_cosine,
                      SupportingFace& face);

}  // namespace pd::detail
