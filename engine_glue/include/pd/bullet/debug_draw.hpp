/// @file
/// The contacts of a Bullet world as lines for its `btIDebugDraw`: depth, normal and manifold of each pair.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <LinearMath/btIDebugDraw.h>

namespace pd {

struct ContactDrawing {
  double normal_length = 0.2;  ///< of the arrow, in the world's unit
  double depth_scale = 1;      ///< A depth is drawn this many times as long. Depths at rest are below 1e-4 of a body.
  bool text = true;            ///< writes the depth of the deepest point, negative where the bodies are apart
};

/// Draws the manifolds of the last step, whoever found the contacts. Each manifold is an outline around its points on
/// B, in order around the normal. Each point has a line from B's surface to A's, which is its depth. The deepest point
/// has an arrow along the normal, in which A leaves B. Bodies in depth are red, touching or apart blue. Call it beside
/// `debugDrawWorld`, between steps. Time: O(points).
void draw_contacts(btCollisionWorld& world, btIDebugDraw& drawer, const ContactDrawing& drawing = {});

}  // namespace pd
