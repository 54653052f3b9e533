/// @file
/// True if a moving body stays apart from one that stands still, proved by supports along one direction.
///
/// Along a unit direction n the bodies are apart by s(t) = min <p(t), n> - level, p in the moving one and `level` the
/// support of the other. Between two times t0, t1 whose s is known
///
///     s(t) >= min(s(t0), s(t1)) - (t1 - t0)^2 / 8 * |omega|^2 r,
///
/// r the largest distance of a point from the axis (pd/contact/time_of_impact.hpp says why). Most triangles under a
/// body that rests or rolls are told apart in this way, without a query of their distance.
#pragma once

#include "pd/contact/time_of_impact.hpp"

namespace pd::detail {

/// A direction, and how far the body that stands still comes along it.
struct Level {
  Vec3 normal;  ///< unit
  double level;
};

/// s at a pose; -HUGE_VAL where the shape has too many corners for a look at each.
[[nodiscard]] double apart_along(const Level& direction, const ConvexShape& shape, const Pose& pose);

/// True if s(t) >= least is proved for all of [0, duration].
/// @param radius  `bounding_radius` of the moving shape
[[nodiscard]] bool stays_apart(const Level& direction, const MovingShape& body, double radius, double least,
                               double duration);

}  // namespace pd::detail
