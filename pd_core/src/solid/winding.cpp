#include "solid/winding.hpp"

#include <vector>

namespace pd::detail {

namespace {

/// The ray from a point along the x axis, moved aside by (epsilon, epsilon^2) so that it meets no edge.
class WindingSearch {
 public:
  WindingSearch(const PosedSolids& solids, Body solid, const PosedPoint& point, std::int32_t without)
      : solids_(solids), body_(solid), point_(point), without_(without), slack_(solids.error() * 2) {}

  PointPlace run() {
    visit(0);
    return place_;
  }

 private:
  void visit(std::int32_t at) {
    if (place_.on_surface) return;
    const TriangleNode& node = solids_.solid(body_).nodes()[static_cast<std::size_t>(at)];
    const TriangleBox box = solids_.box(body_, node);
    for (int k = 1; k < 3; ++k) {
      if (box.low[k] - point_.x[k] > slack_ || point_.x[k] - box.high[k] > slack_) return;
    }
    if (point_.x[0] - box.high[0] > slack_) return;
    if (!node.is_leaf()) {
      visit(node.left);
      visit(node.right);
      return;
    }
    for (std::int32_t t = node.first; t < node.last && !place_.on_surface; ++t) {
      if (solids_.solid(body_).triangle(t).shell != without_) count(solids_.corners(body_, t));
    }
  }

  void count(const PosedTriangle& t) {
    const Vec3 low = t[0].x.cwiseMin(t[1].x).cwiseMin(t[2].x), high = t[0].x.cwiseMax(t[1].x).cwiseMax(t[2].x);
    for (int k = 1; k < 3; ++k) {
      if (low[k] - point_.x[k] > slack_ || point_.x[k] - high[k] > slack_) return;
    }
    if (point_.x[0] - high[0] > slack_) return;
    const bool box_holds = low[0] - point_.x[0] <= slack_;
    if (box_holds && solids_.orient3d(t, point_) == 0 && holds_in_plane(solids_, t, point_)) {
      place_.on_surface = true;
      return;
    }
    const int turn = side_aside(t[0], t[1]);
    if (turn == 0 || side_aside(t[1], t[2]) != turn || side_aside(t[2], t[0]) != turn) return;
    // The normal's x coordinate has the sign of `turn`; the plane is met ahead when the point lies below it so seen.
    if (solids_.orient3d(t, point_) == -turn) place_.winding += turn;
  }

  /// The side of the edge's shadow on which the point that was moved aside lies; 0 for an edge along the ray.
  [[nodiscard]] int side_aside(const PosedPoint& p, const PosedPoint& q) const {
    if (const int side = solids_.orient2d(0, p, q, point_); side != 0) return side;
    if (const int rise = solids_.compare(2, q, p); rise != 0) return -rise;
    return solids_.compare(1, q, p);
  }

  const PosedSolids& solids_;
  Body body_;
  const PosedPoint& point_;
  std::int32_t without_;
  double slack_;
  PointPlace place_;
};

}  // namespace

PointPlace place_in(const PosedSolids& solids, Body solid, const PosedPoint& point, std::int32_t without) {
  return WindingSearch(solids, solid, point, without).run();
}

int shadow_axis(const PosedSolids& solids, const PosedTriangle& triangle) {
  int first = 0;
  (triangle[1].x - triangle[0].x).cross(triangle[2].x - triangle[0].x).cwiseAbs().maxCoeff(&first);
  for (int k = 0; k < 3; ++k) {
    const int axis = (first + k) % 3;
    if (solids.orient2d(axis, triangle[0], triangle[1], triangle[2]) != 0) return axis;
  }
  return first;
}

bool holds_in_plane(const PosedSolids& solids, const PosedTriangle& triangle, const PosedPoint& point) {
  const int axis = shadow_axis(solids, triangle);
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = solids.orient2d(axis, triangle[k], triangle[(k + 1) % 3], point);
    left = left || side > 0;
    right = right || side < 0;
  }
  return !(left && right);
}

std::optional<std::int32_t> misplaced_shell(const MeshSolid& solid) {
  struct Shell {
    std::int32_t first = -1;
    double volume = 0;
    Vec3 origin = Vec3::Zero();
  };
  std::vector<Shell> shells(static_cast<std::size_t>(solid.num_shells()));
  const TriangleNode& root = solid.nodes().front();
  const double size = (root.high - root.low).maxCoeff();
  for (std::size_t t = 0; t < solid.triangles().size(); ++t) {
    const MeshSolid::Triangle& triangle = solid.triangles()[t];
    Shell& shell = shells[static_cast<std::size_t>(triangle.shell)];
    if (shell.first < 0) {
      shell.first = static_cast<std::int32_t>(t);
      shell.origin = solid.vertex(triangle.vertices[0]);
    }
    const auto seen = [&](std::size_t k) -> Vec3 { return (solid.vertex(triangle.vertices[k]) - shell.origin) / size; };
    shell.volume += seen(0).dot(seen(1).cross(seen(2)));
  }
  const Pose identity;
  const PosedSolids alone(solid, identity, solid, identity);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    const std::int32_t vertex = solid.triangle(shells[s].first).vertices[0];
    const PointPlace place = place_in(alone, Body::b, alone.point(Body::a, vertex), static_cast<std::int32_t>(s));
    if (place.winding != (shells[s].volume > 0 ? 0 : 1)) return shells[s].first;
  }
  return std::nullopt;
}

}  // namespace pd::detail
