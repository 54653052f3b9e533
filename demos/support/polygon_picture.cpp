#include "support/polygon_picture.hpp"

#include <fmt/format.h>

#include <utility>

#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "support/demo_output.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

Point2 sum(const Point2& a, const Point2& b) { return {a[0] + b[0], a[1] + b[1]}; }

/// Where the arrow begins in the picture of the bodies: on Q, at the feature that decides, else at its first vertex.
Point2 start_on_q(const PolygonScene& scene, const PolygonDepth& result) {
  const Polygon& q = *scene.q;
  int vertex = 0;
  for (int v = 0; result.feature && v < q.num_vertices(); ++v) {
    const auto id = result.feature->q_edge ? q.caller_edge(v) : q.caller_id(v);
    if (id == result.feature->q) vertex = v;
  }
  Point2 at = q.point(vertex);
  if (result.feature && result.feature->q_edge && !result.feature->p_edge) {
    // An edge of Q comes to lie on a vertex of P: it starts from that vertex, taken back.
    for (int v = 0; v < scene.p->num_vertices(); ++v) {
      if (!(scene.p->caller_id(v) == result.feature->p)) continue;
      const Point2 target = scene.p->point(v);
      return {target[0] - result.translation[0], target[1] - result.translation[1]};
    }
  }
  return sum(at, scene.place);
}

std::string length_label(double depth, const std::string& unit) {
  return fmt::format("{:.4g}{}{}", depth, unit.empty() ? "" : " ", unit);
}

}  // namespace

std::vector<std::vector<Point2>> rings_of(const Polygon& polygon, const Point2& shift) {
  std::vector<std::vector<Point2>> rings;
  for (int r = 0; r < polygon.num_rings(); ++r) {
    rings.emplace_back();
    for (int v = polygon.ring_begin(r); v < polygon.ring_end(r); ++v) {
      rings.back().push_back(sum(polygon.point(v), shift));
    }
  }
  return rings;
}

std::vector<std::vector<Point2>> rings_of(const PolygonDifference& r) {
  std::vector<std::vector<Point2>> rings;
  for (const PolygonDifference::Curve& curve : r.boundary_curves()) {
    if (rings.size() <= static_cast<std::size_t>(curve.loop)) rings.emplace_back();
    rings.back().insert(rings.back().end(), curve.points.begin(), curve.points.end() - 1);
  }
  return rings;
}

render::PlaneFigure bodies_figure(const PolygonScene& scene, const PolygonDepth& result) {
  render::PlaneFigure figure{.unit = scene.unit, .y_down = scene.y_down};
  figure.regions.push_back({.rings = rings_of(*scene.p), .colour = palette::kBodyA, .opacity = 0.62});
  figure.regions.push_back({.rings = rings_of(*scene.q, scene.place), .colour = palette::kBodyB, .opacity = 0.85});
  if (result.depth == 0) return figure;
  figure.regions.push_back({.rings = rings_of(*scene.q, sum(scene.place, result.translation)),
                            .colour = palette::kBodyB,
                            .opacity = 0.22,
                            .outline_pixels = 2,
                            .dashed = true});
  const Point2 from = start_on_q(scene, result);
  figure.arrows.push_back({from, sum(from, result.translation), length_label(result.depth, scene.unit)});
  return figure;
}

render::PlaneFigure difference_figure(const PolygonScene& scene, const PolygonDifference& r,
                                      const PolygonDepth& result) {
  render::PlaneFigure figure{.unit = scene.unit, .y_down = scene.y_down};
  figure.regions.push_back({.rings = rings_of(r), .colour = palette::kInkFaint, .opacity = 0.3, .outline_pixels = 0});
  for (PolygonDifference::Curve& curve : r.boundary_curves()) {
    figure.lines.push_back({.points = std::move(curve.points),
                            .colour = curve.arc ? palette::kBodyB : palette::kBodyA,
                            .width_pixels = 3.2});
  }
  const PolygonDifference::Seats seats = r.seats();
  for (const Point2& x : seats.points) figure.dots.push_back({.at = x, .radius_pixels = 2.5});
  for (const auto& slot : seats.slots) {
    figure.lines.push_back(
        {.points = {slot[0], slot[1]}, .colour = palette::kInkSoft, .width_pixels = 1.5, .dashed = true});
  }
  figure.dots.push_back({.at = scene.place, .radius_pixels = 5.5});
  if (result.depth > 0) {
    figure.arrows.push_back(
        {scene.place, sum(scene.place, result.translation), length_label(result.depth, scene.unit)});
  }
  return figure;
}

int write_polygon_picture(const PolygonScene& scene, const PolygonDifference& r, const PolygonDepth& result,
                          const std::string& verdict, const std::filesystem::path& file) {
  const render::Size whole;
  const render::Size panel = render::panel_size(whole, 2);
  std::vector<render::LegendEntry> legend = {{palette::kContact, "where Q stands now"}};
  if (r.statistics().arcs > 0) {
    legend.push_back({palette::kBodyA, "an edge of P against a vertex of Q"});
    legend.push_back({palette::kBodyB, "arc: Q's edges about a vertex of P"});
  } else {
    legend.push_back({palette::kBodyA, "boundary"});
  }
  render::PlaneFigure plane = difference_figure(scene, r, result);
  plane.legend_lines = static_cast<int>(legend.size());
  render::Image bodies = render::draw_plane_figure(bodies_figure(scene, result), panel);
  render::Image difference = render::draw_plane_figure(plane, panel);
  render::annotate(difference, {.legend = legend});
  std::vector<render::Panel> panels;
  panels.push_back({std::move(bodies), "P (blue) stays, Q (amber) moves"});
  panels.push_back({std::move(difference), "All places where Q overlaps P"});
  const std::string title = result.depth > 0 ? fmt::format("Q gets out in {}", length_label(result.depth, scene.unit))
                                             : std::string("Q is not in the way");
  const auto written = render::write_png(render::side_by_side(panels, title, verdict, whole), file);
  return written ? kDemoDone : report_failure(written.error());
}

}  // namespace pd::demo
