/// @file
/// A polygon with holes against a convex one: where Q may not be, and the least way out.
#include <fmt/format.h>

#include <vector>

#include "dobkin/dobkin_pictures.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "scenes/shape_families.hpp"
#include "support/polygon_picture.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

/// A bracket with a bay, a round hole that Q fits in and a small one that it does not.
Polygon bracket() {
  const std::vector<Point2> outer = {{0, 0},    {11, 0}, {11, 3}, {7.5, 3.4}, {7.5, 5.2},
                                     {11, 5.8}, {11, 9}, {3, 9},  {0, 6.5}};
  std::vector<Point2> round, small;
  for (int i = 0; i < 40; ++i) {
    const scenes::Turn t = scenes::turn(i / 40.0);
    round.push_back({3.6 + 1.75 * t.cosine, 4.9 + 1.75 * t.sine});
    if (i % 4 == 0) small.push_back({8.6 + 0.5 * t.cosine, 1.4 + 0.5 * t.sine});
  }
  return Polygon::from_rings(outer, std::vector<std::vector<Point2>>{round, small}).value();
}

Polygon stone() {
  std::vector<Point2> points;
  for (int i = 0; i < 14; ++i) {
    const scenes::Turn t = scenes::turn(i / 14.0);
    points.push_back({(t.cosine > 0 ? 0.95 : 0.6) * t.cosine, 0.7 * t.sine});
  }
  return Polygon::from_rings(points).value();
}

}  // namespace

Expected<render::Image> polygons_picture(render::Renderer& /*renderer*/, render::Size size) {
  const Polygon p = bracket(), q = stone();
  const auto r = PolygonDifference::of(p, q);
  if (!r) return r.error();
  const Point2 place = {5.9, 5.9};
  const PolygonDepth least = r->depth(place), escape = r->escape_depth(place);
  const PolygonScene scene{&p, &q, place};
  const render::Size panel = render::panel_size(size, 2);
  render::PlaneFigure bodies = bodies_figure(scene, least), difference = difference_figure(scene, *r, least);
  // The way that leads outside, quieter: a hole is no end of the journey.
  const Point2 away = {place[0] + escape.translation[0], place[1] + escape.translation[1]};
  bodies.regions.push_back({.rings = rings_of(q, away), .colour = palette::kInkFaint, .opacity = 0.12, .dashed = true});
  bodies.arrows.push_back({place, away, fmt::format("{:.3g}", escape.depth), palette::kInkSoft});
  difference.arrows.push_back({place, away, fmt::format("{:.3g}", escape.depth), palette::kInkSoft});
  bodies.legend_lines = 2;
  difference.legend_lines = 4;
  render::Image left = render::draw_plane_figure(bodies, panel), right = render::draw_plane_figure(difference, panel);
  const PolygonDifference::Statistics s = r->statistics();
  render::annotate(left, {.legend = {{palette::kBodyA, "P stays"}, {palette::kBodyB, "Q moves"}}});
  render::annotate(right, {.legend = {{palette::kBodyA, "edge of P at a vertex of Q"},
                                      {palette::kBodyB, "arc of \u2212Q at a vertex of P"},
                                      {palette::kDepth, "least way clear of P"},
                                      {palette::kInkSoft, "least way to where it can leave"}}});
  std::vector<render::Panel> panels;
  panels.push_back({std::move(left), "Q is stuck in P"});
  panels.push_back({std::move(right), fmt::format("P + (\u2212Q): {} arcs, {} {}", s.arcs, s.loops - 1,
                                                  s.loops == 2 ? "hole" : "holes")});
  return render::side_by_side(
      panels, fmt::format("{:.3g} to come clear, {:.3g} to get away", least.depth, escape.depth),
      "Q overlaps P where the dot lies in the grey; the hole that Q fits in is a way out, but leads nowhere", size);
}

}  // namespace pd::demo
