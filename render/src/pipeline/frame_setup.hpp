/// @file
/// Everything about a frame that is not a mesh: the spaces it is drawn in, the light, the ground.
///
/// Drawing space is the world moved so that the camera's target is the origin, and scaled so that the eye is one unit
/// from it: single precision then serves scenes of any size and place.
#pragma once

#include <Eigen/Core>

#include "pd/render/scene.hpp"

namespace pd::render::detail {

struct FrameSetup {
  // World to drawing space: (p - origin) * scale.
  Vec3 origin;
  double scale;

  Eigen::Vector3f eye;
  Eigen::Matrix3f axes;        ///< rows right, up, forward
  Eigen::Vector2f tangents;    ///< half fields of view, x and y
  Eigen::Matrix4f projection;  ///< drawing space to clip space, y down so that rows are read from the top
  float line_pixels;           ///< pixels of a line one unit wide (picture height / 720)

  Eigen::Vector3f up;
  Eigen::Vector3f to_light;
  Eigen::Matrix4f shadow;  ///< drawing space to the shadow map's [0, 1]^3
  float shadow_width;      ///< of the map, in drawing units
  float shadow_depth;      ///< range of the map's depths, in drawing units
  float occlusion_radius;  ///< reach of ambient occlusion

  Eigen::Vector3f ground_centre;  ///< below the focus
  Eigen::Vector3f ground_x;       ///< grid axes
  Eigen::Vector3f ground_y;
  float ground_reach;  ///< half side of the plane that is drawn
  float focus_radius;
  float grid_step;
  Eigen::Vector2f grid_offset;  ///< of ground_centre from a crossing, in steps
};

/// Requires finite poses. @param size  of the picture.
FrameSetup set_up_frame(const Scene& scene, const Camera& camera, Size size);

/// Step of the ground's grid in world units.
double grid_step(const Scene& scene);

/// Unit axes of the ground's grid: world axes where `up` is one.
void ground_axes(const Vec3& up, Vec3& x, Vec3& y);

/// Model matrix of a posed mesh, and its normals' matrix.
Eigen::Matrix4f model_matrix(const FrameSetup& frame, const Pose& pose, double unit);

/// Drawing space.
inline Eigen::Vector3f to_drawing(const FrameSetup& frame, const Vec3& world) {
  return ((world - frame.origin) * frame.scale).cast<float>();
}

}  // namespace pd::render::detail
