#include "pd/union_contact/union_piece.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pd/contact/time_of_impact.hpp"

namespace pd {

namespace {

/// Of a direction in a cone of planes: rounding of a product of unit vectors, a few times over.
constexpr double kFeasible = 1e-9;

/// The largest <n, d> over unit d with <normal, d> <= 0 for all of `active`, or one that is enough: the way of n's
/// projection on the cone, which lies in its inside, on one of its sides or on the line of two, and has non-negative
/// multipliers there.
double largest_along(const std::vector<const PiecePlane*>& active, const Vec3& n, double enough) {
  std::array<double, 16> first;
  bool inside = true;
  for (std::size_t i = 0; i < active.size(); ++i) {
    const double height = active[i]->normal.dot(n);
    if (i < first.size()) first[i] = height;
    // No way leads farther along n than n lies from a normal that it must not go along: flush faces end here.
    if (height > 0.5 && (active[i]->normal - n).squaredNorm() <= kFeasible * kFeasible) return 0;
    inside = inside && height <= kFeasible;
  }
  const auto height_of = [&](std::size_t i) { return i < first.size() ? first[i] : active[i]->normal.dot(n); };
  if (inside) return 1;
  double best = 0;
  const auto leads_out = [&](const Vec3& way, double length, std::size_t i, std::size_t k) {
    for (std::size_t m = 0; m < active.size(); ++m) {
      if (m != i && m != k && active[m]->normal.dot(way) > kFeasible * length) return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < active.size() && best < enough; ++i) {
    const Vec3& normal = active[i]->normal;
    const double height = height_of(i);
    const double along = 1 - height * height;
    if (height > 0 && along > best * best && along > kFeasible * kFeasible) {
      const double length = std::sqrt(along);
      if (!leads_out(n - height * normal, length, i, i)) best = length;
    }
    for (std::size_t k = 0; k < i && best < enough; ++k) {
      const double cosine = normal.dot(active[k]->normal);
      const double other = height_of(k);
      if (height - cosine * other < -kFeasible || other - cosine * height < -kFeasible) continue;
      Vec3 line = normal.cross(active[k]->normal);
      const double squared = line.squaredNorm();
      double rise = n.dot(line);
      if (rise < 0) line = -line;
      rise = std::abs(rise);
      if (rise * rise <= best * best * squared || squared <= kFeasible * kFeasible) continue;
      const double length = std::sqrt(squared);
      if (!leads_out(line, length, i, k)) best = rise / length;
    }
  }
  return best;
}

}  // namespace

double seam_slack(double size, double farthest, double pose_rounding) {
  return 0x1p-18 * size + pose_rounding * farthest;
}

double seam_slack(const PosedShape& a, const PosedShape& b, double pose_rounding) {
  const double farthest = a.pose.translation().cwiseAbs().cwiseMax(b.pose.translation().cwiseAbs()).maxCoeff();
  return seam_slack(std::min(bounding_radius(*a.shape), bounding_radius(*b.shape)), farthest, pose_rounding);
}

void set_triangle(const std::array<Vec3, 3>& corners, double margin, UnionPiece& piece) {
  piece.planes.clear();
  piece.margin = margin;
  piece.flat = true;
  const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double twice_area = across.norm();
  // Also refuses what is not a number.
  if (!(twice_area > 0) || !std::isfinite(twice_area)) return;
  const Vec3 normal = across / twice_area;
  piece.middle = (corners[0] + corners[1] + corners[2]) / 3;
  piece.planes.push_back({normal, normal.dot(corners[0])});
  piece.planes.push_back({-normal, -normal.dot(corners[0])});
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 outward = (corners[(i + 1) % 3] - corners[i]).cross(normal).normalized();
    piece.planes.push_back({outward, outward.dot(corners[i])});
  }
}

void set_solid(const ConvexShape& shape, const Pose& pose, UnionPiece& piece) {
  piece.planes.clear();
  piece.margin = shape.margin();
  piece.flat = false;
  const ConvexPolytope* polytope = shape.polytope();
  if (polytope == nullptr || polytope->affine_dimension() != 3) return;
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < polytope->num_vertices(); ++v) sum += polytope->vertex(v);
  piece.middle = pose.apply(sum / polytope->num_vertices());
  for (int f = 0; f < polytope->num_facets(); ++f) {
    const Vec3 normal = (pose.rotation() * polytope->facet_normal(f)).normalized();
    piece.planes.push_back({normal, normal.dot(pose.apply(polytope->vertex(polytope->facet_vertices(f)[0])))});
  }
}

void set_piece(const PosedShape& body, UnionPiece& piece) {
  const ConvexPolytope* polytope = body.shape->polytope();
  if (polytope != nullptr && polytope->affine_dimension() == 2 && polytope->num_vertices() == 3) {
    set_triangle({body.pose.apply(polytope->vertex(0)), body.pose.apply(polytope->vertex(1)),
                  body.pose.apply(polytope->vertex(2))},
                 body.shape->margin(), piece);
  } else {
    set_solid(*body.shape, body.pose, piece);
  }
}

void clip_to_piece(const UnionPiece& piece, double slack, std::vector<Vec3>& points, std::vector<Vec3>& spare) {
  if (points.empty()) return;
  // Planes that lie farther from one of the points than all others do cut nothing off.
  const Vec3 centre = points[0];
  double squared = 0;
  for (const Vec3& point : points) squared = std::max(squared, (point - centre).squaredNorm());
  const double reach = (1 + kFeasible) * std::sqrt(squared);
  for (const PiecePlane& plane : piece.planes) {
    if (plane.height(centre) + reach <= slack) continue;
    const std::size_t count = points.size();
    spare.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& here = points[i];
      const Vec3& next = points[(i + 1) % count];
      const double height = plane.height(here) - slack;
      const double next_height = plane.height(next) - slack;
      if (height <= 0) spare.push_back(here);
      // A segment has one edge, not two.
      if ((height < 0 && next_height > 0) || (height > 0 && next_height < 0)) {
        if (count != 2 || i == 0) spare.push_back(here + height / (height - next_height) * (next - here));
      }
    }
    points.swap(spare);
  }
}

double covered_sine(const UnionPiece& piece, const Vec3& point, const Vec3& n, double slack, double enough,
                    std::vector<const PiecePlane*>& active) {
  active.clear();
  for (const PiecePlane& plane : piece.planes) {
    const double height = plane.height(point);
    if (height > slack) return -1;
    if (height >= -slack) active.push_back(&plane);
  }
  if (active.size() > 1) {
    // The way to its middle is one.
    const Vec3 inwards = piece.middle - point;
    const double rise = n.dot(inwards);
    if (rise > 0 && rise * rise >= enough * enough * inwards.squaredNorm()) return enough;
  }
  return largest_along(active, n, enough);
}

}  // namespace pd
