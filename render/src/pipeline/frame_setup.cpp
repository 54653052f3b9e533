#include "pipeline/frame_setup.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "gl/targets.hpp"

namespace pd::render::detail {
namespace {

/// Bodies' bounds, or the focus where one is given; never empty.
Box focus_of(const Scene& scene) {
  Box focus = scene.focus.empty() ? bounds(scene) : scene.focus;
  if (focus.empty()) {
    focus.include(Vec3::Constant(-1));
    focus.include(Vec3::Constant(1));
  }
  return focus;
}

/// Half the median diagonal of the opaque bodies: what occlusion should reach across.
double typical_body_radius(const Scene& scene, double fallback) {
  std::vector<double> radii;
  for (const Body& body : scene.bodies) {
    radii.push_back(0.5 * body.mesh->bounds.diagonal());
  }
  if (radii.empty()) {
    return fallback;
  }
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return std::min(*middle, fallback);
}

/// 52 degrees to the left of the camera, as seen from the scene, and 56 degrees high.
Vec3 light_direction(const Scene& scene, const Camera& camera) {
  if (scene.light_direction.squaredNorm() > 0) {
    return scene.light_direction.normalized();
  }
  const Vec3 up = scene.up.normalized();
  const Vec3 backward = camera.eye - camera.target;
  Vec3 level = backward - backward.dot(up) * up;
  if (level.norm() < 1e-6 * backward.norm()) {
    Vec3 across;
    ground_axes(scene.up, level, across);
  }
  level.normalize();
  const double turn = 52 * std::numbers::pi / 180;
  const double elevation = 56 * std::numbers::pi / 180;
  return std::cos(elevation) * (std::cos(turn) * level + std::sin(turn) * level.cross(up)) + std::sin(elevation) * up;
}

/// Fits an orthographic view from the light round the casters. The side grows in steps of a quarter octave and the
/// centre moves in whole texels of the map, so that shadows do not crawl while bodies move.
void fit_shadow(FrameSetup& frame, const Box& casters, int map_side) {
  const Eigen::Vector3f forward = -frame.to_light;
  const Eigen::Vector3f across = std::abs(forward.z()) < 0.9f ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX();
  const Eigen::Vector3f right = forward.cross(across).normalized();
  const Eigen::Vector3f above = right.cross(forward);
  const Vec3 centre = casters.centre();
  const auto radius = static_cast<float>(0.5 * casters.diagonal() * frame.scale * 1.02);
  const float half = std::exp2(std::ceil(4 * std::log2(radius)) / 4);
  const Eigen::Vector3f at = to_drawing(frame, centre);
  const float texel = 2 * half / static_cast<float>(map_side);
  const float x = std::round(right.dot(at) / texel) * texel;
  const float y = std::round(above.dot(at) / texel) * texel;
  const float z = forward.dot(at);
  frame.shadow.setIdentity();
  frame.shadow.block<1, 3>(0, 0) = right.transpose() / (2 * half);
  frame.shadow.block<1, 3>(1, 0) = above.transpose() / (2 * half);
  frame.shadow.block<1, 3>(2, 0) = forward.transpose() / (2 * half);
  frame.shadow.block<3, 1>(0, 3) = Eigen::Vector3f(0.5f - x / (2 * half), 0.5f - y / (2 * half), 0.5f - z / (2 * half));
  frame.shadow_width = 2 * half;
  frame.shadow_depth = 2 * half;
}

}  // namespace

void ground_axes(const Vec3& up, Vec3& x, Vec3& y) {
  const Vec3 axis = up.normalized();
  const Vec3 reference = std::abs(axis.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  x = (reference - reference.dot(axis) * axis).normalized();
  y = axis.cross(x);
}

double grid_step(const Scene& scene) {
  if (scene.ground.grid_step > 0) {
    return scene.ground.grid_step;
  }
  // About eight cells across what is framed.
  const double wanted = focus_of(scene).diagonal() / 8;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double share = wanted / power;
  return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

Eigen::Matrix4f model_matrix(const FrameSetup& frame, const Pose& pose, double unit) {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  model.block<3, 3>(0, 0) = (pose.rotation() * (unit * frame.scale)).cast<float>();
  model.block<3, 1>(0, 3) = to_drawing(frame, pose.translation());
  return model;
}

namespace {

/// The ground's plane and grid about the point under the scene's focus.
void set_up_ground(const Scene& scene, const Box& focus, FrameSetup& frame) {
  Vec3 ground_x;
  Vec3 ground_y;
  ground_axes(scene.up, ground_x, ground_y);
  const Vec3 up = scene.up.normalized();
  const Vec3 centre = focus.centre() + (scene.ground.height - focus.centre().dot(up)) * up;
  frame.ground_centre = to_drawing(frame, centre);
  frame.ground_x = ground_x.cast<float>();
  frame.ground_y = ground_y.cast<float>();
  frame.ground_reach = 24 * frame.focus_radius;
  const double step = grid_step(scene);
  frame.grid_step = static_cast<float>(step * frame.scale);
  // Every tenth line is a major one: the offset is kept to ten steps.
  frame.grid_offset = {static_cast<float>(std::fmod(ground_x.dot(centre) / step, 10.0)),
                       static_cast<float>(std::fmod(ground_y.dot(centre) / step, 10.0))};
}

/// The depth range holds everything that is drawn; its near end is set by the nearest body, not by the ground, whose
/// part below the eye is cut without being missed.
/// @param axes  right, up and forward of the camera, in rows but for forward's sign
void set_up_projection(const Box& all, const Camera& camera, const Mat3& axes, double tangent, Size size,
                       FrameSetup& frame) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  double nearest = 1e300;
  double farthest = 1;
  for (int corner = 0; corner < 8 && !all.empty(); ++corner) {
    const Vec3 point((corner & 1) != 0 ? all.lower.x() : all.upper.x(),
                     (corner & 2) != 0 ? all.lower.y() : all.upper.y(),
                     (corner & 4) != 0 ? all.lower.z() : all.upper.z());
    const double distance = forward.dot(point - camera.eye) * frame.scale;
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
  }
  const double near = std::clamp(0.5 * nearest, 0.02, 0.25);
  const double far = std::max(1.5 * farthest, 1.0 + 2.0 * static_cast<double>(frame.ground_reach));
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = size.height / (tangent * size.width);
  clip(1, 1) = -1 / tangent;
  clip(2, 2) = (far + near) / (far - near);
  clip(2, 3) = -2 * far * near / (far - near);
  clip(3, 2) = 1;
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<3, 3>(0, 0) = axes;
  view.block<3, 1>(0, 3) = -axes * ((camera.eye - frame.origin) * frame.scale);
  frame.projection = (clip * view).cast<float>();
}

}  // namespace

FrameSetup set_up_frame(const Scene& scene, const Camera& camera, Size size) {
  FrameSetup frame{};
  frame.origin = camera.target;
  frame.scale = 1 / (camera.eye - camera.target).norm();
  frame.eye = to_drawing(frame, camera.eye);
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  Mat3 axes;
  axes << right.transpose(), right.cross(forward).transpose(), forward.transpose();
  frame.axes = axes.cast<float>();
  const double tangent = std::tan(camera.vertical_field_degrees * std::numbers::pi / 360);
  frame.tangents = {static_cast<float>(tangent * size.width / size.height), static_cast<float>(tangent)};
  frame.line_pixels = static_cast<float>(size.height) / 720.0f;

  const Box focus = focus_of(scene);
  const double radius = std::max(0.5 * focus.diagonal(), 1e-9 / frame.scale);
  frame.focus_radius = static_cast<float>(radius * frame.scale);
  frame.occlusion_radius = static_cast<float>(1.1 * typical_body_radius(scene, 0.5 * radius) * frame.scale);

  frame.up = scene.up.normalized().cast<float>();
  set_up_ground(scene, focus, frame);
  set_up_projection(bounds(scene), camera, axes, tangent, size, frame);

  frame.to_light = light_direction(scene, camera).cast<float>();
  Box casters;
  for (const Body& body : scene.bodies) {
    casters.include(posed_bounds(*body.mesh, body.pose));
  }
  for (const Solid& solid : scene.solids) {
    casters.include(posed_bounds(*solid.mesh, solid.pose));
  }
  fit_shadow(frame, casters.empty() ? focus : casters, Targets::kShadowSide);
  return frame;
}

}  // namespace pd::render::detail
