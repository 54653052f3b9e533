/// @file
/// The camera: where it stands, what it frames, and where a point lands in the picture.
#pragma once

#include "pd/numeric/vector.hpp"
#include "pd/render/image.hpp"
#include "pd/render/mesh.hpp"

namespace pd::render {

struct Camera {
  Vec3 eye{6, -8, 4};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 0, 1};
  double vertical_field_degrees = 35;
};

/// Shares of the picture that framed bodies leave free: room for the caption above and the figures below.
struct Insets {
  double left = 0.07;
  double right = 0.07;
  double top = 0.15;
  double bottom = 0.19;
};

/// From where to look, relative to the up axis: azimuth turns about it (0 = from +x, 90 = from +y for z up), elevation
/// lifts the eye above the horizon.
struct ViewAngle {
  double azimuth_degrees = -58;
  double elevation_degrees = 20;
};

/// A camera that shows the whole box, as large as the insets allow. Requires a non-empty box (a point is framed with
/// one unit round it).
/// @param up  +-x, +-y or +-z, or any direction not parallel to the line of sight.
[[nodiscard]] Camera frame_box(const Box& box, Size picture, ViewAngle angle = {}, const Insets& insets = {},
                               const Vec3& up = Vec3::UnitZ());

/// A point in the picture: pixels from the top left corner, and its distance along the line of sight (<= 0: behind the
/// camera, and x, y mean nothing).
struct PicturePoint {
  double x = 0;
  double y = 0;
  double distance = 0;
};
[[nodiscard]] PicturePoint project(const Camera& camera, Size picture, const Vec3& world);

/// Length in the world of one pixel at a distance along the line of sight.
[[nodiscard]] double pixel_length(const Camera& camera, Size picture, double distance);

}  // namespace pd::render
