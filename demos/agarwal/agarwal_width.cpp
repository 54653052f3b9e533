/// @file
/// The width of a body as the slab round it, beside the Minkowski difference of the body with itself.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <vector>

#include "agarwal/agarwal_pictures.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/width.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "scenes/shape_families.hpp"
#include "support/difference_mesh.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr double kDegrees = 57.29577951308232;  ///< in a radian

/// From where the planes are seen nearly edge-on.
render::ViewAngle along_planes(const Vec3& normal) {
  return {.azimuth_degrees = kDegrees * std::atan2(normal.y(), normal.x()) - 78, .elevation_degrees = 9};
}

/// Turned a little, so that the nearest facet shows its face.
render::ViewAngle towards_facet(const Vec3& normal) {
  return {.azimuth_degrees = along_planes(normal).azimuth_degrees + 36, .elevation_degrees = 12};
}

/// A pebble: points spread over an ellipsoid that is drawn out to one side.
ConvexPolytope pebble() {
  constexpr int kPoints = 70;
  constexpr double kGolden = 0.6180339887498949;
  scenes::Points points;
  for (int i = 0; i < kPoints; ++i) {
    const double z = (2.0 * i + 1) / kPoints - 1;
    const double radius = std::sqrt(1 - z * z);
    const scenes::Turn t = scenes::turn(kGolden * i);
    const double x = radius * t.cosine;
    points.emplace_back(1.2 * x * (x > 0 ? 1.4 : 1), 0.85 * radius * t.sine * (1 - 0.25 * x), 0.5 * z * (1 - 0.35 * x));
  }
  return ConvexPolytope::from_points(points).value();
}

/// A frame whose z is the normal.
Mat3 frame_of(const Vec3& normal) {
  const Vec3 across = std::abs(normal.x()) < 0.8 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
  const Vec3 u = (across - across.dot(normal) * normal).normalized();
  Mat3 m;
  m << u, normal.cross(u), normal;
  return m;
}

struct Slab {
  Vec3 normal;
  double bottom;  ///< <normal, x> on the two planes
  double top;
  Vec3 low;  ///< where the body meets them
  Vec3 high;
};

Slab slab_of(const ConvexPolytope& body, const Pose& pose, const Vec3& normal) {
  Slab slab{normal, 1e300, -1e300, Vec3::Zero(), Vec3::Zero()};
  for (int v = 0; v < body.num_vertices(); ++v) {
    const Vec3 p = pose.apply(body.vertex(v));
    const double h = normal.dot(p);
    if (h < slab.bottom) {
      slab.bottom = h;
      slab.low = p;
    }
    if (h > slab.top) {
      slab.top = h;
      slab.high = p;
    }
  }
  return slab;
}

Expected<render::Image> draw_slab(const ConvexPolytope& body, const Pose& pose, const Width& width,
                                  render::Renderer& renderer, render::Size size) {
  const Slab slab = slab_of(body, pose, width.normal.z() < 0 ? Vec3(-width.normal) : width.normal);
  render::Scene scene;
  scene.bodies.push_back({.mesh = render::polytope_mesh(body), .pose = pose, .colour = palette::kBodyA});
  render::Box box = render::bounds(scene);
  const double reach = 0.46 * box.diagonal();
  const double sheet = 0.004 * box.diagonal();
  const Vec3 middle = box.centre() - slab.normal * slab.normal.dot(box.centre());
  const auto plate = render::box_mesh({0.9 * reach, 0.9 * reach, sheet});
  for (const double h : {slab.bottom - sheet, slab.top + sheet}) {
    scene.solids.push_back({.mesh = plate,
                            .pose = Pose::from_trusted_matrix(frame_of(slab.normal), middle + h * slab.normal),
                            .colour = palette::kDepthBall,
                            .opacity = 0.22f,
                            .hidden_opacity = 0.1f});
  }
  // The arrow stands beside the body, where nothing hides it.
  const double azimuth = along_planes(width.normal).azimuth_degrees / kDegrees;
  const Vec3 right = Vec3(-std::sin(azimuth), std::cos(azimuth), 0);
  const Vec3 side = middle - 0.72 * reach * (right - right.dot(slab.normal) * slab.normal).normalized();
  scene.arrows.push_back({.from = side + slab.bottom * slab.normal,
                          .to = side + slab.top * slab.normal,
                          .label = fmt::format("{:.4f}\nexact", width.width)});
  scene.balls.push_back({.centre = slab.low, .radius = 0.008 * box.diagonal(), .colour = palette::kContact});
  scene.balls.push_back({.centre = slab.high, .radius = 0.008 * box.diagonal(), .colour = palette::kContact});
  box = render::bounds(scene);
  scene.ground.height = box.lower.z() - 0.02 * box.diagonal();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(scene,
                       render::frame_box(box, size, along_planes(width.normal),
                                         {.left = 0.06, .right = 0.06, .top = 0.1, .bottom = 0.1}),
                       size);
}

/// The two facets of P + (-P) nearest to the origin, one opposite the other.
bool is_nearest(const MinkowskiDifference::Facet& facet, const Vec3& normal) {
  return std::abs(facet.normal.dot(normal)) > 1 - 1e-9;
}

Expected<render::Image> draw_sum(const MinkowskiDifference& p, const Width& width, render::Renderer& renderer,
                                 render::Size size) {
  const auto nearest = [&](std::size_t f) { return is_nearest(p.facets[f], width.normal); };
  render::Scene scene;
  scene.solids.push_back({.mesh = difference_mesh(p, [&](std::size_t f) { return !nearest(f); }),
                          .opacity = 0.36f,
                          .hidden_opacity = 0.36f});
  scene.solids.push_back({.mesh = difference_mesh(p, nearest, [](std::size_t) { return palette::kNearestFacet; }),
                          .colour = palette::kNearestFacet,
                          .opacity = 0.9f,
                          .hidden_opacity = 0.7f});
  const render::Box box = render::bounds(scene);
  const Vec3 up = width.normal.z() < 0 ? Vec3(-width.normal) : width.normal;
  scene.balls.push_back({.centre = Vec3::Zero(), .radius = 0.009 * box.diagonal(), .colour = palette::kContact});
  scene.balls.push_back(
      {.centre = Vec3::Zero(), .radius = width.width, .colour = palette::kDepthBall, .opacity = 0.4f});
  scene.arrows.push_back({.from = Vec3::Zero(), .to = width.width * up, .label = fmt::format("{:.4f}", width.width)});
  scene.labels.push_back({.at = -0.035 * box.diagonal() * scene.up, .text = "O"});
  scene.ground.height = box.lower.z() - 0.05 * box.diagonal();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(scene,
                       render::frame_box(box, size, towards_facet(width.normal),
                                         {.left = 0.06, .right = 0.06, .top = 0.24, .bottom = 0.08}),
                       size);
}

}  // namespace

Expected<render::Image> width_picture(render::Renderer& renderer, render::Size size) {
  const ConvexPolytope body = pebble();
  const ConvexShape shape(body);
  const Pose pose =
      Pose::from_quaternion({0.95, 0.1, 0.18, std::sqrt(1 - 0.95 * 0.95 - 0.1 * 0.1 - 0.18 * 0.18)}, Vec3::Zero())
          .value();
  Scratch scratch;
  const Width answer = width({&shape, pose}, scratch);
  const auto difference = minkowski_difference(body, pose, body, pose);
  if (!difference) return difference.error();
  const render::Size panel = render::panel_size(size, 2);
  auto slab = draw_slab(body, pose, answer, renderer, panel);
  if (!slab) return slab.error();
  auto sum = draw_sum(*difference, answer, renderer, panel);
  if (!sum) return sum.error();
  std::vector<render::Panel> panels;
  panels.push_back({std::move(slab).value(), "The closest two parallel planes round the body"});
  panels.push_back(
      {std::move(sum).value(), fmt::format("P = body + (\u2212body), {} facets", difference->num_facets())});
  render::annotate(panels.back().image, {.legend = {{palette::kNearestFacet, "nearest facets, one behind"},
                                                    {palette::kDepthBall, "ball of radius width about O"}}});
  return render::side_by_side(
      panels, fmt::format("Width {:.6g} of a body with {} vertices", answer.width, body.num_vertices()),
      "The width of a body is its penetration depth in itself: the least way out of P for the origin", size);
}

}  // namespace pd::demo
