/// @file
/// ODE's geoms as the core takes them: numbers of a body, a pose, a half-space.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <string>
#include <vector>

#include "kept_bodies.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd::detail {

/// The points of a convex geom, as `ode_convex` was told.
struct ConvexPoints {
  std::vector<double> points;  ///< three numbers each
};

/// Null if none were told.
[[nodiscard]] std::shared_ptr<const ConvexPoints> told_points(dGeomID geom);

/// The numbers of a convex geom, and what owns its points meanwhile.
struct GeomNumbers {
  BodyNumbers numbers;
  const void* key = nullptr;  ///< of `KeptBodies`
  std::shared_ptr<const ConvexPoints> owner = nullptr;
};

/// Requires one of the classes that pdepth knows, and no plane. An error for a convex geom whose points were not told.
[[nodiscard]] Expected<GeomNumbers> geom_numbers(dGeomID geom);

/// The pose of a geom that is no plane; an error if it is NaN, infinite or no rotation.
[[nodiscard]] Expected<Pose> geom_pose(dGeomID geom);

/// True unless ODE's box around a convex geom is another than that of its points: then they are those of another geom,
/// which stood at this address before.
[[nodiscard]] bool is_in_its_box(dGeomID geom, const GeomNumbers& numbers, const Pose& pose);

/// The solid side of a plane; an error if its numbers are not finite or it has no normal.
[[nodiscard]] Expected<Halfspace3> plane_of(dGeomID geom);

/// The class and sizes of a geom, for messages: "a box of sides 1, 2, 0.5".
[[nodiscard]] std::string name_of(dGeomID geom);

}  // namespace pd::detail
