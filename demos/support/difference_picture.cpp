/// @file
/// The picture of a pair and its Minkowski difference.
#include <fmt/format.h>

#include <vector>

#include "difference.hpp"
#include "pd/depth/minkowski_difference.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "support/demo_output.hpp"
#include "support/difference_mesh.hpp"
#include "support/shared_solid.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr std::int64_t kMostFacets = 100'000;

bool same_face(const Feature& x, const Feature& y) {
  return x.kind == y.kind && x.first == y.first && (x.kind != Feature::Kind::edge || x.second == y.second);
}

/// The facet of P nearest to the origin: the one whose features the answer names, else the one that faces its normal.
std::size_t nearest_facet(const MinkowskiDifference& p, const PenetrationDepth& answer) {
  std::size_t best = 0;
  double best_cosine = -2;
  const double outward = answer.contact == ContactClass::separated ? -1 : 1;
  for (std::size_t f = 0; f < p.facets.size(); ++f) {
    const MinkowskiDifference::Facet& facet = p.facets[f];
    if (same_face(facet.on_a, answer.feature_a) && same_face(facet.on_b, answer.feature_b)) return f;
    const double cosine = outward * facet.normal.dot(answer.normal);
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best = f;
    }
  }
  return best;
}

std::string short_name(const std::string& name) { return std::filesystem::path(name).filename().string(); }

std::string bracket_words(double lower, double upper) {
  if (lower == upper) return "exact";
  return fmt::format("certified to {:.0e}", upper - lower);
}

struct Look {
  render::ViewAngle angle;
  render::Size size;
};

constexpr render::Insets kPairInsets{.left = 0.08, .right = 0.08, .top = 0.1, .bottom = 0.1};
/// Room for the legend above P.
constexpr render::Insets kDifferenceInsets{.left = 0.06, .right = 0.06, .top = 0.27, .bottom = 0.08};

Expected<render::Image> draw_pair(const NamedPair& pair, const PenetrationDepth& answer, render::Renderer& renderer,
                                  const Look& look) {
  const ConvexPolytope& a = *pair.a->polytope();
  const ConvexPolytope& b = *pair.b->polytope();
  render::Scene scene;
  scene.bodies.push_back(
      {.mesh = render::polytope_mesh(a), .pose = pair.pose_a, .colour = palette::kBodyA, .opacity = 0.55f});
  scene.bodies.push_back(
      {.mesh = render::polytope_mesh(b), .pose = pair.pose_b, .colour = palette::kBodyB, .opacity = 0.55f});
  if (answer.contact == ContactClass::overlapping) {
    if (const auto overlap = shared_solid(a, pair.pose_a, b, pair.pose_b)) {
      scene.solids.push_back({.mesh = render::polytope_mesh(*overlap)});
    }
    scene.arrows.push_back(
        {.from = answer.witness_a,
         .to = answer.witness_b,
         .label = fmt::format("{:.4g}\n{}", answer.depth, bracket_words(answer.lower, answer.upper))});
  } else if (answer.contact == ContactClass::separated) {
    scene.lines.push_back(
        {.points = {answer.witness_a, answer.witness_b}, .colour = palette::kDepth, .width_pixels = 4});
    scene.labels.push_back(
        {.at = 0.5 * (answer.witness_a + answer.witness_b), .text = fmt::format("{:.4g} apart", answer.distance)});
  } else {
    scene.discs.push_back({.point = answer.witness_a, .normal = answer.normal, .colour = palette::kDepth});
  }
  const render::Box box = render::bounds(scene);
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;  // a mesh file does not say its unit
  scene.focus = box;
  return renderer.draw(scene, render::frame_box(box, look.size, look.angle, kPairInsets), look.size);
}

Expected<render::Image> draw_difference(const MinkowskiDifference& p, const PenetrationDepth& answer,
                                        render::Renderer& renderer, const Look& look) {
  const std::size_t nearest = nearest_facet(p, answer);
  const render::Colour bright = palette::kNearestFacet;
  render::Scene scene;
  scene.solids.push_back({.mesh = difference_mesh(p, [&](std::size_t f) { return f != nearest; }),
                          .opacity = 0.42f,
                          .hidden_opacity = 0.42f});
  scene.solids.push_back({.mesh = difference_mesh(
                              p, [&](std::size_t f) { return f == nearest; }, [&](std::size_t) { return bright; }),
                          .colour = bright,
                          .opacity = 0.9f,
                          .hidden_opacity = 0.75f});
  render::Box box = render::bounds(scene);
  box.include(Vec3::Zero());
  scene.balls.push_back({.centre = Vec3::Zero(), .radius = 0.009 * box.diagonal(), .colour = palette::kContact});
  if (answer.contact == ContactClass::overlapping) {
    scene.balls.push_back(
        {.centre = Vec3::Zero(), .radius = answer.depth, .colour = palette::kDepthBall, .opacity = 0.35f});
    scene.arrows.push_back({.from = Vec3::Zero(), .to = answer.translation, .label = "t"});
  } else if (answer.contact == ContactClass::separated) {
    scene.lines.push_back(
        {.points = {Vec3::Zero(), -answer.distance * answer.normal}, .colour = palette::kDepth, .width_pixels = 4});
  }
  scene.labels.push_back({.at = -0.035 * box.diagonal() * scene.up, .text = "O"});
  scene.ground.height = box.lower.z() - 0.05 * box.diagonal();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(scene, render::frame_box(box, look.size, look.angle, kDifferenceInsets), look.size);
}

std::vector<render::LegendEntry> legend(const PenetrationDepth& answer) {
  std::vector<render::LegendEntry> entries = {{palette::kFacetVertex, "facet of A against vertex of B"},
                                              {palette::kVertexFacet, "vertex of A against facet of B"},
                                              {palette::kEdgeEdge, "edge against edge"},
                                              {palette::kNearestFacet, "nearest facet"}};
  if (answer.contact == ContactClass::overlapping) {
    entries.push_back({palette::kDepthBall, "ball of that radius about O"});
  }
  return entries;
}

std::string title_of(const NamedPair& pair, const PenetrationDepth& answer) {
  const std::string names = short_name(pair.name_a) + " and " + short_name(pair.name_b);
  switch (answer.contact) {
    case ContactClass::overlapping:
      return fmt::format("Penetration depth {:.6g}: {}", answer.depth, names);
    case ContactClass::touching:
      return "Touching: " + names;
    case ContactClass::separated:
      break;
  }
  return fmt::format("Apart by {:.6g}: {}", answer.distance, names);
}

std::string statement_of(const PenetrationDepth& answer) {
  switch (answer.contact) {
    case ContactClass::overlapping:
      return fmt::format(
          "The shortest move that frees A is the shortest way out of P for the origin: {:.6g} to the nearest facet",
          answer.depth);
    case ContactClass::touching:
      return "The origin lies on the boundary of P: the bodies share boundary points only";
    case ContactClass::separated:
      break;
  }
  return fmt::format("The origin lies {:.6g} outside P, as far as A is from B", answer.distance);
}

}  // namespace

Expected<render::Image> difference_picture(const NamedPair& pair, const PenetrationDepth& answer,
                                           render::Renderer& renderer, render::Size size, double turn_degrees) {
  const auto difference =
      minkowski_difference(*pair.a->polytope(), pair.pose_a, *pair.b->polytope(), pair.pose_b, kMostFacets);
  const bool drawn = difference && !difference->facets.empty();
  render::ViewAngle angle;
  angle.azimuth_degrees += turn_degrees;
  const Look look{angle, render::panel_size(size, drawn ? 2 : 1)};
  std::vector<render::Panel> panels;
  auto bodies = draw_pair(pair, answer, renderer, look);
  if (!bodies) return bodies.error();
  panels.push_back({std::move(bodies).value(), "A (blue) and B (amber), where they stand"});
  if (drawn) {
    auto solid = draw_difference(*difference, answer, renderer, look);
    if (!solid) return solid.error();
    panels.push_back({std::move(solid).value(), fmt::format("P = B + (\u2212A), {} facets", difference->num_facets())});
    render::annotate(panels.back().image, {.legend = legend(answer)});
  }
  return render::side_by_side(panels, title_of(pair, answer), statement_of(answer), size);
}

int write_difference_picture(const NamedPair& pair, const PenetrationDepth& answer, const std::filesystem::path& file,
                             render::Size size) {
  auto renderer = render::Renderer::create();
  if (!renderer) return report_failure(renderer.error());
  render::Renderer drawing = std::move(renderer).value();
  const auto picture = difference_picture(pair, answer, drawing, size);
  if (!picture) return report_failure(picture.error());
  const auto written = render::write_png(*picture, file);
  return written ? kDemoDone : report_failure(written.error());
}

}  // namespace pd::demo
