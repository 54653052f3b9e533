/// @file
/// Two polygons of the plane and their convolution as one picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pd/planar/polygon_depth.hpp"
#include "pd/render/plane_figure.hpp"

namespace pd::demo {

struct PolygonScene {
  const Polygon* p;
  const Polygon* q;
  Point2 place = {0, 0};  ///< of Q
  std::string unit = {};
  bool y_down = false;
};

/// The rings of a polygon, moved.
[[nodiscard]] std::vector<std::vector<Point2>> rings_of(const Polygon& polygon, const Point2& shift = {0, 0});
/// The boundary of R as closed rings.
[[nodiscard]] std::vector<std::vector<Point2>> rings_of(const PolygonDifference& r);

/// P, Q where it stands and, dashed, where it gets to, the way between.
[[nodiscard]] render::PlaneFigure bodies_figure(const PolygonScene& scene, const PolygonDepth& result);
/// R with its boundary: straight pieces and arcs, holes, the placement and the way out of it.
[[nodiscard]] render::PlaneFigure difference_figure(const PolygonScene& scene, const PolygonDifference& r,
                                                    const PolygonDepth& result);

/// Both side by side. @return one of DemoExit.
int write_polygon_picture(const PolygonScene& scene, const PolygonDifference& r, const PolygonDepth& result,
                          const std::string& verdict, const std::filesystem::path& file);

}  // namespace pd::demo
