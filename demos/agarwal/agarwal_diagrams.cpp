/// @file
/// Two normal diagrams on one sphere, and the complete bipartite families of their crossings.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "agarwal/agarwal_pictures.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "pd/structure/decomposition.hpp"
#include "pd/structure/overlay.hpp"
#include "scenes/agarwal_families.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

/// The largest families that are seen whole, in colours that are no body's.
constexpr std::array kFamilyColours{palette::kTrouble, palette::kGood, palette::kDepthBall, palette::kContact};
constexpr double kRim = 1.05;  ///< points p of the unit sphere with <p, eye> above this are seen

render::Camera sphere_camera() {
  return {.eye = 4.6 * Vec3(0.38, -0.62, 0.69).normalized(), .target = Vec3(0.19, 0.12, 0.12), .up = Vec3::UnitZ()};
}

/// An edge's arc on the sphere: a unit vector across the edge's great circle is its direction.
struct Arc {
  Vec3 from;
  Vec3 to;
  Vec3 direction;
};

/// @param sign  -1 for the diagram of the mirrored body
Arc arc_of(const ConvexPolytope& body, const Pose& pose, int half_edge, double sign) {
  const HalfEdge& h = body.half_edge(half_edge);
  const auto normal = [&](int facet) { return Vec3(sign * (pose.rotation() * body.facet_normal(facet))); };
  return {normal(h.facet), normal(body.half_edge(h.twin).facet),
          pose.rotation() * (body.vertex(body.target(half_edge)) - body.vertex(h.origin))};
}

/// Where two crossing arcs meet.
Vec3 crossing(const Arc& a, const Arc& b) {
  const Vec3 c = a.direction.cross(b.direction).normalized();
  return c.dot(a.from + a.to) + c.dot(b.from + b.to) > 0 ? c : Vec3(-c);
}

/// The parts of an arc that a viewer at `eye` sees, a hair above the unit sphere.
void add_arc(render::Scene& scene, const Arc& arc, const Vec3& eye, render::Colour colour, double pixels) {
  constexpr double kLift = 1.002;
  const double angle = std::atan2(arc.from.cross(arc.to).norm(), arc.from.dot(arc.to));
  const int steps = std::max(1, static_cast<int>(angle / 0.04));
  std::vector<Vec3> seen;
  const auto flush = [&] {
    if (seen.size() > 1) scene.lines.push_back({.points = seen, .colour = colour, .width_pixels = pixels});
    seen.clear();
  };
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const Vec3 p = (std::sin((1 - t) * angle) * arc.from + std::sin(t * angle) * arc.to).normalized();
    if (p.dot(eye) > kRim) {
      seen.push_back(kLift * p);
    } else {
      flush();
    }
  }
  flush();
}

void add_diagram(render::Scene& scene, const ConvexPolytope& body, const Pose& pose, double sign, const Vec3& eye,
                 render::Colour colour) {
  for (int h = 0; h < body.num_half_edges(); ++h) {
    if (body.half_edge(h).twin < h) continue;
    add_arc(scene, arc_of(body, pose, h, sign), eye, colour, 2);
  }
}

/// Crossings of each family that no larger one has taken.
struct Family {
  std::size_t edges_a;
  std::size_t edges_b;
  std::vector<Vec3> crossings;
};
struct Coloured {
  std::vector<Family> largest;
  std::vector<Vec3> others;
};

Coloured colour_crossings(const Decomposition& decomposition, const scenes::PolytopePair& pair, const Vec3& eye) {
  std::vector<int> order(static_cast<std::size_t>(decomposition.num_pairs()));
  std::iota(order.begin(), order.end(), 0);
  const auto product = [&](int i) {
    const Decomposition::Pair p = decomposition.pair(i);
    return p.edges_a.size() * p.edges_b.size();
  };
  std::stable_sort(order.begin(), order.end(), [&](int i, int k) { return product(i) > product(k); });
  Coloured coloured;
  std::set<std::pair<int, int>> taken;
  for (const int i : order) {
    const Decomposition::Pair p = decomposition.pair(i);
    Family family{p.edges_a.size(), p.edges_b.size(), {}};
    for (const int ea : p.edges_a) {
      for (const int eb : p.edges_b) {
        if (!taken.insert({ea, eb}).second) continue;
        family.crossings.push_back(crossing(arc_of(pair.a, pair.pose_a, ea, -1), arc_of(pair.b, pair.pose_b, eb, 1)));
      }
    }
    const bool seen =
        std::all_of(family.crossings.begin(), family.crossings.end(), [&](const Vec3& x) { return x.dot(eye) > kRim; });
    const bool grid = family.edges_a > 1 && family.edges_b > 1;
    if (seen && grid && coloured.largest.size() < kFamilyColours.size() && family.crossings.size() == product(i)) {
      coloured.largest.push_back(std::move(family));
    } else {
      coloured.others.insert(coloured.others.end(), family.crossings.begin(), family.crossings.end());
    }
  }
  return coloured;
}

/// Two vaults crossed at 70 degrees, A upside down on B.
scenes::PolytopePair crossed_vaults() {
  scenes::PolytopePair pair = scenes::lens_pair(20, 1.1, 0.22);
  std::swap(pair.a, pair.b);
  std::swap(pair.pose_a, pair.pose_b);
  const scenes::Turn turn = scenes::turn(20.0 / 360);
  Mat3 m;
  m << turn.cosine, -turn.sine, 0, turn.sine, turn.cosine, 0, 0, 0, 1;
  pair.pose_a = Pose::from_matrix(m * pair.pose_a.rotation(), pair.pose_a.translation()).value();
  return pair;
}

Expected<render::Image> draw_bodies(const scenes::PolytopePair& pair, render::Renderer& renderer, render::Size size) {
  render::Scene scene;
  scene.bodies.push_back(
      {.mesh = render::polytope_mesh(pair.a), .pose = pair.pose_a, .colour = palette::kBodyA, .opacity = 0.75f});
  scene.bodies.push_back(
      {.mesh = render::polytope_mesh(pair.b), .pose = pair.pose_b, .colour = palette::kBodyB, .opacity = 0.75f});
  const render::Box box = render::bounds(scene);
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;
  scene.focus = box;
  const render::ViewAngle angle{.azimuth_degrees = -60, .elevation_degrees = 14};
  return renderer.draw(
      scene, render::frame_box(box, size, angle, {.left = 0.08, .right = 0.08, .top = 0.1, .bottom = 0.1}), size);
}

Expected<render::Image> draw_sphere(const scenes::PolytopePair& pair, const Coloured& crossings,
                                    render::Renderer& renderer, render::Size size) {
  render::Scene scene;
  scene.bodies.push_back({.mesh = render::sphere_mesh(1), .colour = palette::hex(0xE9E7E2), .edges = false});
  const render::Camera camera = sphere_camera();
  add_diagram(scene, pair.a, pair.pose_a, -1, camera.eye, palette::kBodyA);
  add_diagram(scene, pair.b, pair.pose_b, 1, camera.eye, palette::kBodyB);
  const auto dots = [&](const std::vector<Vec3>& points, render::Colour colour, double radius) {
    for (const Vec3& p : points) {
      if (p.dot(camera.eye) > kRim) {
        scene.balls.push_back({.centre = p, .radius = radius, .colour = colour});
      }
    }
  };
  dots(crossings.others, palette::kInkSoft, 0.009);
  for (std::size_t k = 0; k < crossings.largest.size(); ++k) {
    dots(crossings.largest[k].crossings, kFamilyColours[k], 0.023);
  }
  scene.ground.visible = false;
  scene.focus = render::bounds(scene);
  return renderer.draw(scene, camera, size);
}

}  // namespace

Expected<render::Image> normal_diagrams_picture(render::Renderer& renderer, render::Size size) {
  const scenes::PolytopePair pair = crossed_vaults();
  const Decomposition decomposition = Decomposition::of(pair.a, pair.pose_a, pair.b, pair.pose_b);
  const OverlayCounts counts = Overlay().count(pair.a, pair.pose_a, pair.b, pair.pose_b, OverlayPieces::as_walked);
  const Coloured crossings = colour_crossings(decomposition, pair, sphere_camera().eye);
  const render::Size panel = render::panel_size(size, 2);
  auto bodies = draw_bodies(pair, renderer, panel);
  if (!bodies) return bodies.error();
  auto sphere = draw_sphere(pair, crossings, renderer, panel);
  if (!sphere) return sphere.error();
  std::vector<render::Panel> panels;
  panels.push_back({std::move(bodies).value(), "A (blue) and B (amber), where they stand"});
  panels.push_back({std::move(sphere).value(), "Normal diagrams of \u2212A and B on one sphere"});
  std::vector<render::LegendEntry> legend = {{palette::kBodyA, "arc: an edge of \u2212A"},
                                             {palette::kBodyB, "arc: an edge of B"}};
  for (std::size_t k = 0; k < crossings.largest.size(); ++k) {
    const Family& family = crossings.largest[k];
    legend.push_back(
        {kFamilyColours[k], fmt::format("family: {} edges \u00d7 {} edges", family.edges_a, family.edges_b)});
  }
  legend.push_back({palette::kInkSoft, "crossings of other families"});
  render::annotate(panels.back().image, {.legend = legend});
  return render::side_by_side(
      panels,
      fmt::format("{} edge-edge facets of P, found as {} families", counts.edge_edge, decomposition.num_pairs()),
      "A family is two sets of edges of which every two cross; every crossing is a facet of P = B + (\u2212A)", size);
}

}  // namespace pd::demo
