/// @file
/// A plain description of one frame: what stands where, and what is to be said about it. No state, no device.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pd/render/camera.hpp"
#include "pd/render/mesh.hpp"
#include "pd/render/palette.hpp"

namespace pd::render {

/// A matte body that casts and receives shadows. Below full opacity it is a ghost: seen through, with a lighter shadow.
struct Body {
  MeshRef mesh;
  Pose pose = {};
  Colour colour = palette::categorical(0);
  float opacity = 1;
  bool highlight = false;  ///< saturated, with a warm outline: the picture is about it
  bool edges = true;       ///< ink the feature edges
};

/// A translucent surface that explains (the overlap of two bodies, a Minkowski difference): never hidden, seen through
/// occluders at the lower opacity.
struct Solid {
  MeshRef mesh;
  Pose pose = {};
  Colour colour = palette::kOverlap;
  float opacity = 0.6f;
  float hidden_opacity = 0.5f;
  bool edges = true;
};

/// A ball that explains: the origin (small, opaque, dark), the ball of radius pi (translucent). Never hidden.
struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 1;
  Colour colour = palette::kContact;
  float opacity = 1;
};

/// The bold arrow, tip at `to`. Its thickness is in pixels of a 720-line picture, so that short arrows stay visible; a
/// short arrow shrinks its head. Never hidden.
struct Arrow {
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  std::string label = {};  ///< beside the arrow; "\n" starts a second, quieter line (the bracket)
  Colour colour = palette::kDepth;
  double thickness_pixels = 6;
};

/// A contact point: a small disc across `normal`, which is drawn as a short stem. Never hidden.
struct ContactDisc {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double radius = 0;  ///< 0: 4.5 pixels of a 720-line picture
  Colour colour = palette::kContact;
  bool stem = true;
};

/// A thin line through points (a path of motion, a ray).
struct Polyline {
  std::vector<Vec3> points;
  Colour colour = palette::kInkSoft;
  double width_pixels = 2;
  float opacity = 1;
};

/// Words beside a point.
struct Label {
  Vec3 at = Vec3::Zero();
  std::string text;
  Colour colour = palette::kInk;
};

/// The studio floor: a plane across `Scene::up` at a height along it, with a metric grid round the bodies and a scale
/// bar.
struct Ground {
  bool visible = true;
  double height = 0;
  double grid_step = 0;  ///< 0: chosen from 1, 2, 5 times a power of ten
  bool scale_bar = true;
  double metres_per_unit = 1;  ///< for the words at the scale bar
};

struct Scene {
  Vec3 up = Vec3::UnitZ();
  std::vector<Body> bodies = {};
  std::vector<Solid> solids = {};
  std::vector<Ball> balls = {};
  std::vector<Arrow> arrows = {};
  std::vector<ContactDisc> discs = {};
  std::vector<Polyline> lines = {};
  std::vector<Label> labels = {};
  Ground ground = {};
  /// Towards the key light; zero: high on the left of the camera (give it where the camera moves, or shadows turn with
  /// it).
  Vec3 light_direction = Vec3::Zero();
  /// The centre of shadows and grid. Empty: the bodies' bounds. Set it to one box for a whole film, so that
  /// nothing swims when a body flies off.
  Box focus = {};
};

/// Bounds of all that is drawn, the ground excepted.
[[nodiscard]] Box bounds(const Scene& scene);

}  // namespace pd::render
