#include "pd/render/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pd::render {
namespace {

double half_field_tangent(const Camera& camera) {
  return std::tan(camera.vertical_field_degrees * std::numbers::pi / 360);
}

/// Rows: right, up, forward.
Mat3 view_axes(const Camera& camera) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  Mat3 axes;
  axes << right.transpose(), right.cross(forward).transpose(), forward.transpose();
  return axes;
}

}  // namespace

Camera frame_box(const Box& box, Size picture, ViewAngle angle, const Insets& insets, const Vec3& up) {
  const Vec3 axis = up.normalized();
  // Azimuth counts from +x (from +y where x is the up axis), turning about the up axis.
  const Vec3 reference = std::abs(axis.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 zero = (reference - reference.dot(axis) * axis).normalized();
  const double azimuth = angle.azimuth_degrees * std::numbers::pi / 180;
  const double elevation = angle.elevation_degrees * std::numbers::pi / 180;
  const Vec3 level = std::cos(azimuth) * zero + std::sin(azimuth) * axis.cross(zero);
  const Vec3 backward = std::cos(elevation) * level + std::sin(elevation) * axis;

  Camera camera;
  camera.up = axis;
  camera.target = box.centre();
  camera.eye = camera.target + backward;
  const Mat3 axes = view_axes(camera);
  const Vec3 half = box.diagonal() > 0 ? Vec3(0.5 * (box.upper - box.lower)) : Vec3::Constant(0.5);

  const double tangent_y = half_field_tangent(camera);
  const double tangent_x = tangent_y * picture.width / picture.height;
  // The free window in view tangents; its centre is where the box's middle goes.
  const double left = (2 * insets.left - 1) * tangent_x;
  const double right = (1 - 2 * insets.right) * tangent_x;
  const double bottom = (2 * insets.bottom - 1) * tangent_y;
  const double top = (1 - 2 * insets.top) * tangent_y;

  // With the eye at (ex, ey) across and d behind the centre, a corner (x, y, z forward) is inside the window when
  // left (d + z) <= x - ex <= right (d + z), likewise in y. Each side bounds d against ex from one side; the least d
  // has both extreme: minimise over corners a = min(x - left z) and b = max(x - right z): d >= (b - a) / (right -
  // left).
  const auto span = [&](int row, double low, double high, double& distance, double& lowest, double& highest) {
    lowest = 1e300;
    highest = -1e300;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 offset((corner & 1) != 0 ? half.x() : -half.x(), (corner & 2) != 0 ? half.y() : -half.y(),
                        (corner & 4) != 0 ? half.z() : -half.z());
      const Vec3 view = axes * offset;
      lowest = std::min(lowest, view[row] - low * view.z());
      highest = std::max(highest, view[row] - high * view.z());
    }
    distance = (highest - lowest) / (high - low);
  };
  double distance_x = 0;
  double distance_y = 0;
  double low_x = 0;
  double high_x = 0;
  double low_y = 0;
  double high_y = 0;
  span(0, left, right, distance_x, low_x, high_x);
  span(1, bottom, top, distance_y, low_y, high_y);
  // Never inside: at least one half diagonal in front of the nearest corner's sphere.
  const double distance = std::max({distance_x, distance_y, 1.5 * half.norm()});
  const double ex = 0.5 * (low_x - left * distance + high_x - right * distance);
  const double ey = 0.5 * (low_y - bottom * distance + high_y - top * distance);
  const Vec3 shift = ex * axes.row(0).transpose() + ey * axes.row(1).transpose();
  camera.target += shift;
  camera.eye = camera.target + distance * backward;
  return camera;
}

PicturePoint project(const Camera& camera, Size picture, const Vec3& world) {
  const Vec3 view = view_axes(camera) * (world - camera.eye);
  const double scale = 0.5 * picture.height / (half_field_tangent(camera) * view.z());
  return {0.5 * picture.width + scale * view.x(), 0.5 * picture.height - scale * view.y(), view.z()};
}

double pixel_length(const Camera& camera, Size picture, double distance) {
  return 2 * half_field_tangent(camera) * distance / picture.height;
}

}  // namespace pd::render
