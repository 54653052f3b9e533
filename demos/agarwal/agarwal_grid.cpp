/// @file
/// Approx-Separation: a grid of directions that covers the sphere, and the rays shot along it out of P.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "agarwal/agarwal_pictures.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "pd/structure/direction_grid.hpp"
#include "scenes/shape_families.hpp"
#include "support/difference_mesh.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr double kDelta = 0.06;

struct Shot {
  Vec3 direction;
  double length;  ///< Delta(u): from O to the boundary of P
  Vec3 normal;    ///< of the facet that is hit
  [[nodiscard]] double plane_distance() const { return length * normal.dot(direction); }
};

/// A circle on the unit sphere about a direction, where it is seen.
void add_cap(render::Scene& scene, const Vec3& centre, double cosine, const Vec3& eye) {
  constexpr int kSteps = 48;
  const Vec3 across = std::abs(centre.x()) < 0.8 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
  const Vec3 u = centre.cross(across).normalized();
  const Vec3 v = centre.cross(u);
  const double sine = std::sqrt(1 - cosine * cosine);
  std::vector<Vec3> seen;
  const auto flush = [&] {
    if (seen.size() > 1) {
      scene.lines.push_back({.points = seen, .colour = palette::kFacetVertex, .width_pixels = 1.4, .opacity = 0.75f});
    }
    seen.clear();
  };
  for (int i = 0; i <= kSteps; ++i) {
    const scenes::Turn t = scenes::turn(static_cast<double>(i) / kSteps);
    const Vec3 p = cosine * centre + sine * (t.cosine * u + t.sine * v);
    if (p.dot(eye) > 1.04) {
      seen.push_back(1.003 * p);
    } else {
      flush();
    }
  }
  flush();
}

Expected<render::Image> draw_covering(const DirectionGrid& grid, const Shot& best, render::Renderer& renderer,
                                      render::Size size) {
  render::Scene scene;
  scene.bodies.push_back({.mesh = render::sphere_mesh(1), .colour = palette::hex(0xE9E7E2), .edges = false});
  const Vec3 towards = (Vec3(0.52, -0.8, 0.3) + 0.4 * best.direction).normalized();
  const render::Camera camera{.eye = 4.4 * towards, .target = Vec3(0, 0, 0.06), .up = Vec3::UnitZ()};
  for (const Vec3& u : grid.directions) {
    add_cap(scene, u, grid.cosine, camera.eye);
    if (u.dot(camera.eye) > 1.04) {
      scene.balls.push_back({.centre = u, .radius = 0.018, .colour = palette::kInkSoft});
    }
  }
  scene.ground.visible = false;
  scene.focus = render::bounds(scene);
  return renderer.draw(scene, camera, size);
}

Expected<render::Image> draw_shots(const MinkowskiDifference& p, const std::vector<Shot>& shots, const Shot& best,
                                   render::Renderer& renderer, render::Size size) {
  const auto hit = [&](std::size_t f) { return p.facets[f].normal.dot(best.normal) > 1 - 1e-9; };
  render::Scene scene;
  scene.solids.push_back(
      {.mesh = difference_mesh(p, [&](std::size_t f) { return !hit(f); }), .opacity = 0.3f, .hidden_opacity = 0.3f});
  scene.solids.push_back({.mesh = difference_mesh(p, hit, [](std::size_t) { return palette::kNearestFacet; }),
                          .colour = palette::kNearestFacet,
                          .opacity = 0.85f,
                          .hidden_opacity = 0.6f});
  const render::Box box = render::bounds(scene);
  for (const Shot& shot : shots) {
    const Vec3 end = shot.length * shot.direction;
    scene.lines.push_back(
        {.points = {Vec3::Zero(), end}, .colour = palette::kFacetVertex, .width_pixels = 1.6, .opacity = 0.8f});
    scene.balls.push_back({.centre = end, .radius = 0.006 * box.diagonal(), .colour = palette::kInkSoft});
  }
  scene.balls.push_back({.centre = Vec3::Zero(), .radius = 0.009 * box.diagonal(), .colour = palette::kContact});
  scene.arrows.push_back({.from = Vec3::Zero(),
                          .to = best.plane_distance() * best.normal,
                          .label = fmt::format("{:.4g}", best.plane_distance())});
  scene.labels.push_back({.at = -0.035 * box.diagonal() * scene.up, .text = "O"});
  scene.ground.height = box.lower.z() - 0.05 * box.diagonal();
  scene.ground.scale_bar = false;
  scene.focus = box;
  const render::ViewAngle angle{.azimuth_degrees = -58, .elevation_degrees = 16};
  return renderer.draw(
      scene, render::frame_box(box, size, angle, {.left = 0.05, .right = 0.05, .top = 0.2, .bottom = 0.07}), size);
}

}  // namespace

Expected<render::Image> direction_grid_picture(render::Renderer& renderer, render::Size size) {
  const ConvexShape a = ConvexPolytope::from_points(scenes::prism(12)).value();
  const ConvexShape b = ConvexPolytope::from_points(scenes::box({1.3, 0.9, 0.6})).value();
  const Pose pose_a = Pose::from_quaternion({0.8, 0.48, 0.36, 0.0}, {0.35, -0.25, 0.62}).value();
  const auto grid = direction_grid(GridKind::geodesic, kDelta);
  if (!grid) return grid.error();
  Scratch scratch;
  std::vector<Shot> shots;
  for (const Vec3& u : grid->directions) {
    const auto out = directional_depth({&a, pose_a}, {&b, Pose()}, u, scratch);
    if (!out) return out.error();
    shots.push_back({u, out->depth, out->normal});
  }
  const Shot best = *std::min_element(
      shots.begin(), shots.end(), [](const Shot& s, const Shot& t) { return s.plane_distance() < t.plane_distance(); });
  double shortest = best.length;
  for (const Shot& shot : shots) shortest = std::min(shortest, shot.length);
  const PenetrationDepth exact = penetration_depth({&a, pose_a}, {&b, Pose()}, scratch);
  const auto difference = minkowski_difference(*a.polytope(), pose_a, *b.polytope(), Pose());
  if (!difference) return difference.error();
  const render::Size panel = render::panel_size(size, 2);
  auto covering = draw_covering(*grid, best, renderer, panel);
  if (!covering) return covering.error();
  auto rays = draw_shots(*difference, shots, best, renderer, panel);
  if (!rays) return rays.error();
  const double degrees = 57.29577951308232 * std::acos(grid->cosine);
  std::vector<render::Panel> panels;
  panels.push_back({std::move(covering).value(),
                    fmt::format("{} directions, caps of {:.1f}\u00b0 cover the sphere", shots.size(), degrees)});
  panels.push_back({std::move(rays).value(), "One ray out of P = B + (\u2212A) along each"});
  render::annotate(panels.back().image, {.legend = {{palette::kFacetVertex, "ray from O, to the boundary of P"},
                                                    {palette::kNearestFacet, "the facet hit whose plane is nearest"}}});
  return render::side_by_side(panels, fmt::format("Depth within {:.0f} % by {} rays", 100 * kDelta, shots.size()),
                              fmt::format("Certified between {:.4g} and {:.4g}; the exact depth is {:.4g}",
                                          grid->cosine * shortest, best.plane_distance(), exact.depth),
                              size);
}

}  // namespace pd::demo
