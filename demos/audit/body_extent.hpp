/// @file
/// How far bodies reach along a direction, in plain doubles: for scales (L, the size of a body), and for what is
/// compared with a tolerance far above their rounding (the normal's excess, depths in half-spaces).
#pragma once

#include "pd/shape/compound.hpp"

namespace pd::audit {

/// max <x, direction> over the body turned by the pose's rotation, its translation left out; margins included. Error: a
/// few ulp of the body's radius times |direction|. Time O(vertices).
[[nodiscard]] double turned_support(const ConvexShape& shape, const Pose& pose, const Vec3& direction);
[[nodiscard]] double turned_support(const Compound& body, const Pose& pose, const Vec3& direction);

struct Box {
  Vec3 low;
  Vec3 high;
};

/// The box along the axes of the frame that the pose leads to, its translation left out.
[[nodiscard]] Box bounding_box(const Compound& body, const Pose& pose);

}  // namespace pd::audit
