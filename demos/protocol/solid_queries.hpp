/// @file
/// The queries that answer for solids.
#pragma once

#include <string_view>

#include "pd/solid/solid_depth.hpp"
#include "protocol/handlers.hpp"

namespace pd::query {

/// The fields of a depth answer about solids from "class" to "stats".
void write_solid_answer(const SolidDepth& result, std::int64_t nanoseconds, JsonWriter& answer);

/// A solid or another convex shape where it stands; one of the two pointers is null.
struct SolidOrShape {
  const MeshSolid* solid;
  const ConvexShape* shape;
  Pose pose;
};

/// Requires that one of the two is a solid. @return the errors of `penetration_depth`
[[nodiscard]] Expected<SolidDepth> depth_beside_solid(const SolidOrShape& a, const SolidOrShape& b, Scratch& scratch,
                                                      const SolidSettings& settings = {});

/// The field "seat" of two solids that touch; null where it cannot be told.
void write_seat(const PosedSolid& a, const PosedSolid& b, JsonWriter& answer);

/// The handler of a query of two bodies of which one is a mesh asked as a solid; nullptr where the query has none.
[[nodiscard]] Handler find_solid_handler(std::string_view query);

}  // namespace pd::query
