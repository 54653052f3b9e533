/// @file
/// Shallow-Penetration: of all facets of P the search visits those that meet one ball about the origin.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "agarwal/agarwal_pictures.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/shallow_penetration.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "pd/structure/direction_grid.hpp"
#include "scenes/shape_families.hpp"
#include "support/difference_mesh.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr double kShallowDelta = 0.5;
constexpr render::ViewAngle kShallowAngle{.azimuth_degrees = -62, .elevation_degrees = 24};

/// Points spread evenly over an ellipsoid.
ConvexPolytope pebble(int n, const Vec3& radii) {
  constexpr double kGolden = 0.6180339887498949;
  scenes::Points points;
  for (int i = 0; i < n; ++i) {
    const double z = (2.0 * i + 1) / n - 1;
    const double radius = std::sqrt(1 - z * z);
    const scenes::Turn t = scenes::turn(kGolden * i);
    points.emplace_back(radii.x() * radius * t.cosine, radii.y() * radius * t.sine, radii.z() * z);
  }
  return ConvexPolytope::from_points(points).value();
}

double distance_to_segment(const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double t = std::clamp(-from.dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (from + t * way).norm();
}

/// From the origin to a facet of P.
double distance_to_facet(const MinkowskiDifference& p, const MinkowskiDifference::Facet& facet) {
  const auto corner = [&](std::int32_t k) {
    return p.vertices[static_cast<std::size_t>(p.corners[static_cast<std::size_t>(facet.first + k % facet.count)])]
        .position;
  };
  bool above = true;
  double nearest = std::abs(facet.normal.dot(corner(0)));
  double border = 1e300;
  for (std::int32_t k = 0; k < facet.count; ++k) {
    const Vec3 from = corner(k), to = corner(k + 1);
    above = above && facet.normal.cross(to - from).dot(-from) >= 0;
    border = std::min(border, distance_to_segment(from, to));
  }
  return above ? nearest : border;
}

struct Search {
  double radius = 0;        ///< of the ball
  std::vector<Vec3> seeds;  ///< ends of the rays that are no longer than that
  std::vector<char> visited;
  std::int64_t count = 0;
};

Expected<render::Image> draw_bodies(const PosedShape& a, const PosedShape& b, const PenetrationDepth& exact,
                                    render::Renderer& renderer, render::Size size) {
  render::Scene scene;
  scene.bodies.push_back(
      {.mesh = render::shape_mesh(*a.shape), .pose = a.pose, .colour = palette::kBodyA, .opacity = 0.62f});
  scene.bodies.push_back(
      {.mesh = render::shape_mesh(*b.shape), .pose = b.pose, .colour = palette::kBodyB, .opacity = 0.62f});
  scene.arrows.push_back(
      {.from = exact.witness_a, .to = exact.witness_b, .label = fmt::format("{:.4g}\nexact", exact.depth)});
  const render::Box box = render::bounds(scene);
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(
      scene, render::frame_box(box, size, kShallowAngle, {.left = 0.08, .right = 0.08, .top = 0.1, .bottom = 0.1}),
      size);
}

Expected<render::Image> draw_search(const MinkowskiDifference& p, const Search& search, const PenetrationDepth& exact,
                                    render::Renderer& renderer, render::Size size) {
  const auto near = [&](std::size_t f) { return p.facets[f].normal.dot(exact.normal) > 1 - 1e-9; };
  render::Scene scene;
  scene.solids.push_back(
      {.mesh = difference_mesh(
           p, [&](std::size_t f) { return search.visited[f] == 0; }, [](std::size_t) { return palette::kInkFaint; }),
       .colour = palette::kInkFaint,
       .opacity = 0.16f,
       .hidden_opacity = 0.16f});
  scene.solids.push_back({.mesh = difference_mesh(
                              p, [&](std::size_t f) { return search.visited[f] != 0; },
                              [&](std::size_t f) { return near(f) ? palette::kNearestFacet : palette::kEdgeEdge; }),
                          .colour = palette::kEdgeEdge,
                          .opacity = 0.85f,
                          .hidden_opacity = 0.6f});
  const render::Box box = render::bounds(scene);
  scene.balls.push_back(
      {.centre = Vec3::Zero(), .radius = search.radius, .colour = palette::kDepthBall, .opacity = 0.34f});
  scene.balls.push_back({.centre = Vec3::Zero(), .radius = 0.008 * box.diagonal(), .colour = palette::kContact});
  for (const Vec3& end : search.seeds) {
    scene.lines.push_back({.points = {Vec3::Zero(), end}, .colour = palette::kFacetVertex, .width_pixels = 1.6});
    scene.balls.push_back({.centre = end, .radius = 0.0055 * box.diagonal(), .colour = palette::kInkSoft});
  }
  scene.arrows.push_back({.from = Vec3::Zero(), .to = exact.translation});
  scene.ground.height = box.lower.z() - 0.05 * box.diagonal();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(
      scene, render::frame_box(box, size, kShallowAngle, {.left = 0.04, .right = 0.04, .top = 0.22, .bottom = 0.05}),
      size);
}

}  // namespace

Expected<render::Image> shallow_search_picture(render::Renderer& renderer, render::Size size) {
  const ConvexShape a(pebble(60, {1.1, 0.8, 0.6}));
  const ConvexShape b(pebble(70, {1.3, 1, 0.45}));
  const Pose pose_a = Pose::from_quaternion({0.8, 0.36, 0.0, 0.48}, {0.25, -0.3, 0.58}).value();
  const PosedShape posed_a{&a, pose_a}, posed_b{&b, Pose()};
  Scratch scratch;
  const auto grid = direction_grid(GridKind::geodesic, kShallowDelta / 4);
  if (!grid) return grid.error();
  std::vector<Vec3> ends;
  Search search;
  for (const Vec3& u : grid->directions) {
    const auto out = directional_depth(posed_a, posed_b, u, scratch);
    if (!out) return out.error();
    ends.push_back(out->depth * u);
  }
  const auto found = shallow_penetration(posed_a, posed_b, scratch, kShallowDelta);
  if (!found) return found.error();
  search.radius = found->counts.radius;
  search.count = found->counts.visited;
  for (const Vec3& end : ends) {
    if (end.norm() <= search.radius) search.seeds.push_back(end);
  }
  const auto p = minkowski_difference(*a.polytope(), pose_a, *b.polytope(), Pose());
  if (!p) return p.error();
  for (const MinkowskiDifference::Facet& facet : p->facets) {
    search.visited.push_back(distance_to_facet(*p, facet) <= search.radius ? 1 : 0);
  }
  const PenetrationDepth& exact = found->answer;
  const render::Size panel = render::panel_size(size, 2);
  auto bodies = draw_bodies(posed_a, posed_b, exact, renderer, panel);
  if (!bodies) return bodies.error();
  auto drawn = draw_search(*p, search, exact, renderer, panel);
  if (!drawn) return drawn.error();
  std::vector<render::Panel> panels;
  panels.push_back({std::move(bodies).value(), "A (blue) and B (amber), where they stand"});
  panels.push_back({std::move(drawn).value(),
                    fmt::format("P = B + (\u2212A): {} of {} facets visited", search.count, p->num_facets())});
  render::annotate(panels.back().image,
                   {.legend = {{palette::kFacetVertex, "shortest rays: where the search begins"},
                               {palette::kDepthBall, "ball (1 + \u03b4/2) as large as the shortest ray"},
                               {palette::kEdgeEdge, "facets in the ball: visited"},
                               {palette::kNearestFacet, "the nearest of them"}}});
  return render::side_by_side(
      panels, fmt::format("Exact depth {:.4g} from {} of {} facets", exact.depth, search.count, p->num_facets()),
      "The nearest facet meets the ball, and the facets that do hang together: the rest of P is never looked at", size);
}

}  // namespace pd::demo
