/// @file
/// Inner and outer hierarchies of one body, and a search down the inner one.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dobkin/dobkin_pictures.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "pd/shape/halfspaces.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"
#include "scenes/shape_families.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr render::ViewAngle kPebbleAngle{.azimuth_degrees = -62, .elevation_degrees = 18};
constexpr std::array kTones{palette::hex(0x9C5486), palette::kNearestFacet, palette::kBodyB, palette::kFacetVertex};

/// Points spread evenly over an ellipsoid, each moved a little.
ConvexPolytope pebble(int n) {
  constexpr double kGolden = 0.6180339887498949;
  scenes::Random random(5);
  scenes::Points points;
  for (int i = 0; i < n; ++i) {
    const double z = (2.0 * i + 1) / n - 1, radius = std::sqrt(1 - z * z);
    const scenes::Turn t = scenes::turn(kGolden * i + random.uniform(0, 0.01));
    points.emplace_back(1.25 * radius * t.cosine, 0.95 * radius * t.sine, 0.8 * z);
  }
  return ConvexPolytope::from_points(points).value();
}

/// The hull of the vertices that a level of the inner hierarchy has.
ConvexPolytope inner_level(const PolyhedralHierarchy& h, int level) {
  std::vector<Vec3> points;
  for (int v = 0; v < h.polytope().num_vertices(); ++v) {
    if (h.last_level(v) >= level) points.push_back(h.polytope().vertex(v));
  }
  return ConvexPolytope::from_points(points).value();
}

/// What the planes of a level of the outer hierarchy enclose.
Expected<ConvexPolytope> outer_level(const PolyhedralHierarchy& h, int level) {
  std::vector<Halfspace3> planes;
  const ConvexPolytope& body = h.polytope();
  for (int f = 0; f < body.num_facets(); ++f) {
    if (h.last_level(f) < level) continue;
    const Vec3& n = body.facet_normal(f);
    planes.push_back({n, n.dot(body.vertex(body.facet_vertices(f)[0]))});
  }
  return polytope_of_halfspaces(planes);
}

/// For each size the coarsest level that has as many vertices, or facets.
std::vector<int> levels_of_size(const PolyhedralHierarchy& h, const std::vector<int>& sizes, bool facets) {
  std::vector<int> chosen;
  for (const int size : sizes) {
    int best = 0;
    for (int l = 0; l < static_cast<int>(h.levels().size()); ++l) {
      const auto& level = h.levels()[static_cast<std::size_t>(l)];
      if ((facets ? level.facets : level.vertices) >= size) best = l;
    }
    chosen.push_back(best);
  }
  return chosen;
}

Expected<render::Image> draw_pebble(render::Scene scene, const render::Box& box, render::Renderer& renderer,
                                    render::Size size) {
  scene.ground.visible = false;
  scene.focus = box;
  constexpr render::Insets kRoomAround{.left = 0.07, .right = 0.07, .top = 0.2, .bottom = 0.06};
  return renderer.draw(scene, render::frame_box(box, size, kPebbleAngle, kRoomAround), size);
}

/// Nested surfaces, the innermost the most solid.
void add_nested(render::Scene& scene, const std::vector<ConvexPolytope>& from_inside) {
  for (std::size_t i = from_inside.size(); i-- > 0;) {
    const float opacity = i == 0 ? 0.95f : 0.34f - 0.07f * static_cast<float>(i);
    scene.solids.push_back({.mesh = render::polytope_mesh(from_inside[i]),
                            .colour = kTones[std::min(i, kTones.size() - 1)],
                            .opacity = opacity,
                            .hidden_opacity = opacity});
  }
}

/// The cap that a vertex adds to a coarser level: the vertex with its neighbours in the level where it comes in.
render::Solid cap_of(const ConvexPolytope& body, const PolyhedralHierarchy& hierarchy, int vertex) {
  std::vector<Vec3> points = {body.vertex(vertex)};
  for (const auto& star : hierarchy.star(vertex)) points.push_back(body.vertex(star.neighbour));
  return {.mesh = render::polytope_mesh(ConvexPolytope::from_points(points).value()),
          .colour = palette::kBodyB,
          .opacity = 0.75f,
          .hidden_opacity = 0.6f};
}

/// A plane across `direction` as a square about the line of search.
void add_plane(const Vec3& middle, const Vec3& direction, double half, render::Scene& scene) {
  const Vec3 u = direction.unitOrthogonal(), w = direction.cross(u);
  std::vector<Vec3> corners;
  for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}}) {
    corners.push_back(middle + half * (a * u + b * w));
  }
  scene.lines.push_back({.points = corners, .colour = palette::kFacetVertex, .width_pixels = 2.2});
  scene.solids.push_back(
      {.mesh = render::polytope_mesh(
           ConvexPolytope::from_points(std::vector<Vec3>(corners.begin(), corners.end() - 1)).value()),
       .colour = palette::kFacetVertex,
       .opacity = 0.1f,
       .hidden_opacity = 0.1f,
       .edges = false});
}

/// What the search for the farthest vertex meets, from the coarsest level to the finest: planes, caps and the way.
/// @return the number of caps.
int add_descent(const ConvexPolytope& body, const PolyhedralHierarchy& hierarchy, const Vec3& direction,
                render::Scene& scene) {
  int last = -1, caps = 0;
  std::vector<Vec3> path;
  for (int level = static_cast<int>(hierarchy.levels().size()) - 1; level >= 0; --level) {
    const int v = hierarchy.support(direction, nullptr, level);
    if (v == last) continue;
    if (last >= 0) {
      ++caps;
      scene.solids.push_back(cap_of(body, hierarchy, v));
    }
    const Vec3 at = body.vertex(v);
    add_plane(direction * direction.dot(at), direction, 0.62 - 0.03 * static_cast<double>(path.size()), scene);
    scene.balls.push_back({.centre = at, .radius = 0.026, .colour = palette::kContact});
    path.push_back(at);
    last = v;
  }
  scene.lines.push_back({.points = path, .colour = palette::kDepth, .width_pixels = 4});
  // Named in the legend: beside the arrow a word would stand on the caps.
  scene.arrows.push_back({.from = path.back(), .to = path.back() + 0.5 * direction, .colour = palette::kGood});
  return caps;
}

}  // namespace

Expected<render::Image> hierarchy_picture(render::Renderer& renderer, render::Size size) {
  const ConvexPolytope body = pebble(160);
  const PolyhedralHierarchy inner = PolyhedralHierarchy::build(body, HierarchyKind::inner).value();
  const PolyhedralHierarchy outer = PolyhedralHierarchy::build(body, HierarchyKind::outer).value();
  render::Scene left, right;
  std::vector<render::LegendEntry> left_legend, right_legend;
  std::vector<ConvexPolytope> shells;
  for (const int level : levels_of_size(inner, {4, 14, 48, 160}, false)) {
    shells.push_back(inner_level(inner, level));
    left_legend.push_back(
        {kTones[left_legend.size()], fmt::format("level {}: {} vertices", level, shells.back().num_vertices())});
  }
  add_nested(left, shells);
  // The body is the solid one, each coarser level a larger glass round it.
  shells.assign(1, body);
  right_legend.push_back({palette::kFacetVertex, fmt::format("level 0: {} facets", body.num_facets())});
  for (const int level : levels_of_size(outer, {30, 8}, true)) {
    auto shell = outer_level(outer, level);
    if (!shell) return shell.error();
    shells.push_back(*std::move(shell));
    right_legend.push_back(
        {kTones[kTones.size() - 1 - right_legend.size()],
         fmt::format("level {}: {} facets", level, outer.levels()[static_cast<std::size_t>(level)].facets)});
  }
  for (std::size_t i = shells.size(); i-- > 0;) {
    const float opacity = i == 0 ? 1.0f : 0.2f;
    right.solids.push_back({.mesh = render::polytope_mesh(shells[i]),
                            .colour = kTones[kTones.size() - 1 - i],
                            .opacity = opacity,
                            .hidden_opacity = opacity});
  }
  const render::Size panel = render::panel_size(size, 2);
  render::Box box = render::bounds(right);
  auto first = draw_pebble(left, render::bounds(left), renderer, panel);
  if (!first) return first.error();
  auto second = draw_pebble(right, box, renderer, panel);
  if (!second) return second.error();
  render::Image left_image = std::move(first).value(), right_image = std::move(second).value();
  render::annotate(left_image, {.legend = left_legend});
  render::annotate(right_image, {.legend = right_legend});
  std::vector<render::Panel> panels;
  panels.push_back({std::move(left_image), "Inner: hulls of fewer and fewer vertices"});
  panels.push_back({std::move(right_image), "Outer: what fewer and fewer facets enclose"});
  return render::side_by_side(panels,
                              fmt::format("One body of {} vertices between {} inner and {} outer levels",
                                          body.num_vertices(), inner.levels().size(), outer.levels().size()),
                              "Each level drops a constant share, no two of it neighbours: a query takes O(1) a level",
                              size);
}

Expected<render::Image> descent_picture(render::Renderer& renderer, render::Size size) {
  const ConvexPolytope body = pebble(160);
  const PolyhedralHierarchy h = PolyhedralHierarchy::build(body, HierarchyKind::inner).value();
  const Vec3 direction = Vec3(0.34, -0.52, 0.78).normalized();
  render::Scene scene;
  scene.solids.push_back(
      {.mesh = render::polytope_mesh(body), .colour = palette::kInkFaint, .opacity = 0.14f, .hidden_opacity = 0.14f});
  scene.solids.push_back({.mesh = render::polytope_mesh(inner_level(h, static_cast<int>(h.levels().size()) - 1)),
                          .colour = kTones[0],
                          .opacity = 0.8f,
                          .hidden_opacity = 0.6f});
  const int caps = add_descent(body, h, direction, scene);
  auto drawn = [&]() -> Expected<render::Image> {
    const render::Box box = render::bounds(scene);
    scene.ground.visible = false;
    scene.focus = box;
    constexpr render::Insets kRoomAround{.left = 0.1, .right = 0.1, .top = 0.15, .bottom = 0.1};
    return renderer.draw(
        scene, render::frame_box(box, size, {.azimuth_degrees = -30, .elevation_degrees = 12}, kRoomAround), size);
  }();
  if (!drawn) return drawn.error();
  std::int64_t dots = 0;
  (void)h.support(direction, &dots);
  render::Image image = std::move(drawn).value();
  render::annotate(image, {.title = fmt::format("Farthest of {} vertices in {} products", body.num_vertices(), dots),
                           .subtitle = "A search down the hierarchy: each level's plane lets in one cap at most",
                           .headlines = {{fmt::format("{}", h.levels().size()), "levels"},
                                         {fmt::format("{}", caps), "caps came in beyond the plane"}},
                           .legend = {{kTones[0], "coarsest level: where the search begins"},
                                      {palette::kFacetVertex, "plane that supports a level"},
                                      {palette::kBodyB, "cap: a vertex that a finer level adds beyond it"},
                                      {palette::kDepth, "way of the farthest vertex"},
                                      {palette::kGood, "direction in which it is farthest"}}});
  return image;
}

}  // namespace pd::demo
