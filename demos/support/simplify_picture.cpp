#include "support/simplify_picture.hpp"

#include <fmt/format.h>

#include <array>

#include "pd/render/composition.hpp"
#include "pd/render/renderer.hpp"
#include "support/demo_output.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr std::size_t kMostPoints = 6000;

/// Points as small tetrahedra, some of them where there are many.
render::MeshRef points_mesh(const std::vector<Vec3>& scan, double size) {
  static const std::array<Vec3, 4> kCorners = {Vec3(1, 1, 1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1)};
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  const std::size_t count = std::min(kMostPoints, scan.size());
  // Steps of the golden section: equal ones would fall in with a scan's rows and draw a few of them only.
  const auto step = static_cast<std::size_t>(0.6180339887498949 * static_cast<double>(scan.size())) | 1U;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = scan[count == scan.size() ? i : i * step % scan.size()];
    const auto first = static_cast<std::int32_t>(points.size());
    for (const Vec3& corner : kCorners) points.push_back(p + size * corner);
    triangles.push_back({first, first + 2, first + 1});
    triangles.push_back({first, first + 1, first + 3});
    triangles.push_back({first, first + 3, first + 2});
    triangles.push_back({first + 1, first + 2, first + 3});
  }
  return render::triangle_mesh(points, triangles);
}

Expected<render::Image> draw_mesh(render::Scene scene, const render::Box& box, render::Renderer& renderer,
                                  render::Size size) {
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;  // a scan does not say its unit
  scene.focus = box;
  constexpr render::Insets kRoomAround{.left = 0.08, .right = 0.08, .top = 0.1, .bottom = 0.1};
  return renderer.draw(scene, render::frame_box(box, size, {}, kRoomAround), size);
}

}  // namespace

int write_simplify_picture(const std::vector<Vec3>& scan, const ConvexPolytope& hull, const std::string& side,
                           double epsilon, const std::filesystem::path& file) {
  auto created = render::Renderer::create();
  if (!created) return report_failure(created.error());
  render::Renderer renderer = std::move(created).value();
  const render::Size whole;
  const render::Size size = render::panel_size(whole, 2);
  render::Box box;
  for (const Vec3& p : scan) box.include(p);
  for (int v = 0; v < hull.num_vertices(); ++v) box.include(hull.vertex(v));
  const render::MeshRef dots = points_mesh(scan, 0.0018 * box.diagonal());
  render::Scene before, after;
  before.bodies.push_back({.mesh = dots, .colour = palette::kBodyA, .edges = false});
  after.bodies.push_back({.mesh = render::polytope_mesh(hull), .colour = palette::kBodyB});
  auto first = draw_mesh(before, box, renderer, size);
  if (!first) return report_failure(first.error());
  auto second = draw_mesh(after, box, renderer, size);
  if (!second) return report_failure(second.error());
  const std::vector<render::Panel> panels = {
      {std::move(first).value(), fmt::format("the scan, {} points", scan.size())},
      {std::move(second).value(),
       fmt::format("the hull, {} vertices, {} facets", hull.num_vertices(), hull.num_facets())}};
  const std::string promise =
      side == "outer"
          ? fmt::format("Encloses every point, and stands off by at most {} of the extent in any direction",
                        epsilon / 2)
          : fmt::format("Lies inside the scan's hull; every extent is at least {} of the scan's", 1 - epsilon);
  const auto written =
      render::write_png(render::side_by_side(panels, "A convex hull with a stated error", promise, whole), file);
  return written ? kDemoDone : report_failure(written.error());
}

}  // namespace pd::demo
