/// @file
/// Bodies given by halfspaces: extreme points by linear programs, and a sandwich by the polar body ([M] Lemma 16).
#pragma once

#include <span>
#include <vector>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

/// Checks the halfspaces (`Body::from_halfspaces` names the errors) and finds a certified sandwich of their
/// intersection.
Expected<AnySandwich> sandwich_of_halfspaces(const Halfspaces& halfspaces, double eta);

/// Linear program in the frame of the body's sandwich, where everything is about a unit ball.
AnySupport extreme_point(const Halfspaces& halfspaces, const AnySandwich& sandwich, const AnyVector& direction);

/// The polar body's points in the frame of a sandwich: K = {centre + axes z : <q_i, z> <= 1 for all i}. They lie in the
/// unit ball, and their hull holds the ball of radius 1 / ratio.
std::vector<AnyVector> polar_points(const Halfspaces& halfspaces, const AnySandwich& sandwich);

}  // namespace pd::dimension::detail
