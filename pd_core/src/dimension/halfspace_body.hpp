/// @file
/// Bodies given by halfspaces: extreme points by linear programs, and a sandwich by the polar body ([M] Lemma 16).
#pragma once

#include <span>
#include <vector>

#include "pd/dimension/body.hpp"

namespace pd::dimension::detail {

/// Checks the halfspaces (`Body::from_halfspaces` names the errors) and finds a certified sandwich of their
/// intersection.
template <int D>
Expected<Sandwich<D>> sandwich_of_halfspaces(std::span<const Halfspace<D>> halfspaces, double eta);

/// Linear program in the frame of the body's sandwich, where everything is about a unit ball.
template <int D>
SupportPoint<D> extreme_point(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& sandwich,
                              const Vector<D>& direction);

/// The polar body's points in the frame of a sandwich: K = {centre + axes z : <q_i, z> <= 1 for all i}. They lie in the
/// unit ball, and their hull holds the ball of radius 1 / ratio.
template <int D>
std::vector<Vector<D>> polar_points(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& sandwich);

}  // namespace pd::dimension::detail
