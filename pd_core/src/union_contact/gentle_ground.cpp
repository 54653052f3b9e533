#include "pd/union_contact/gentle_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pd/union_contact/flat_ground.hpp"
#include "pd/union_contact/union_piece.hpp"
#include "union_contact/column.hpp"

namespace pd {

namespace {

/// tan 20 degrees: by how much the mesh may fall away beyond an edge. What is not covered there pushes along a normal
/// that is no farther from the triangle's.
constexpr double kGentle = 0.36;
/// cos 25 degrees, that and what normals near a covered one may miss: within it only one facet may face the triangle.
constexpr double kOneFacet = 0.9;
/// cos 60 degrees: a facet that is steeper says little about the contact (as for every contact_manifold).
constexpr double kFacing = 0.5;

}  // namespace

bool GentleGround::begin(const PosedShape& body, const Ground& ground, double threshold) {
  polytope_ = body.shape->polytope();
  if (polytope_ == nullptr) return false;
  sphere_ = polytope_->num_vertices() == 1;
  if (!sphere_ && (polytope_->affine_dimension() != 3 || polytope_->num_vertices() > kMostVertices)) return false;
  lower_ = ground.lower;
  upper_ = ground.upper;
  mesh_ = ground.mesh;
  body_ = body;
  origin_ = body.pose.translation();
  margin_ = body.shape->margin();
  mesh_margin_ = ground.margin;
  threshold_ = threshold;
  one_sided_ = ground.one_sided;
  vertices_.clear();
  normals_.clear();
  for (int v = 0; v < polytope_->num_vertices(); ++v) vertices_.push_back(body.pose.apply(polytope_->vertex(v)));
  for (int f = 0; f < polytope_->num_facets(); ++f) {
    normals_.emplace_back(body.pose.rotation() * polytope_->facet_normal(f));
  }
  return true;
}

bool GentleGround::is_gentle(std::size_t place, double side) {
  const Triangle& triangle = around_[place];
  const Vec3 across = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& from = triangle[i];
    const Vec3& to = triangle[i < 2 ? i + 1 : 0];
    const Vec3* const corner = edges_.across(place, i);
    if (corner == nullptr) {
      // All triangles around the body were read: what shares an edge with one of these and was not is out of reach, and
      // so is the edge.
      const bool apart =
          (from.cwiseMin(to).array() > upper_.array()).any() || (from.cwiseMax(to).array() < lower_.array()).any();
      if (!apart) return false;
      continue;
    }
    const Vec3 along = to - from, way = *corner - from;
    const double rise = side * across.dot(way);
    const double out = along.cross(across).dot(way);
    if (out <= 0) return false;  // it folds back
    if (rise < 0 && rise * rise * along.squaredNorm() > kGentle * kGentle * out * out) return false;
  }
  return true;
}

int GentleGround::facet_against(const Vec3& n) const {
  int best = -1;
  double most = -2, second = -2;
  for (std::size_t f = 0; f < normals_.size(); ++f) {
    const double cosine = -n.dot(normals_[f]);
    if (cosine > most) {
      second = most;
      most = cosine;
      best = static_cast<int>(f);
    } else {
      second = std::max(second, cosine);
    }
  }
  return most >= kFacing && second < kOneFacet ? best : -1;
}

void GentleGround::cut(const Vec3& outward, const Vec3& corner, std::int32_t edge) {
  const Polygon& polygon = polygons_[from_];
  Polygon& left = polygons_[from_ ^ 1U];
  std::array<double, kMostCorners> heights;
  const double level = outward.dot(corner);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    heights[i] = outward.dot(polygon[i].point) - level;
    if (heights[i] <= 0) ++inside;
  }
  if (inside == size_) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size_ && inside > 0; ++i) {
    const Corner& here = polygon[i];
    const std::size_t after = i + 1 < size_ ? i + 1 : 0;
    const double height = heights[i], next = heights[after];
    if (height <= 0) left[kept++] = here;
    if ((height < 0 && next > 0) || (height > 0 && next < 0)) {
      Corner& made = left[kept++];
      made = here;
      made.point += height / (height - next) * (polygon[after].point - here.point);
      // Two edges of the triangle meet in one of its corners: where the later one begins, or the first.
      made.kind = here.on_triangle ? Kind::corner_of_triangle : Kind::crossing;
      made.of_facet = here.on_triangle ? 0 : here.edge;
      made.of_triangle = here.on_triangle && edge - here.edge == 2 ? 0 : edge;
      if (height < 0) {
        made.edge = edge;
        made.on_triangle = true;
      }
    } else if (height == 0 && next > 0) {
      left[kept - 1].edge = edge;
      left[kept - 1].on_triangle = true;
    }
  }
  from_ ^= 1U;
  size_ = kept;
}

void GentleGround::cut_facet(const IndexList& loop, const Placed& triangle, const Vec3& n) {
  size_ = loop.size();
  for (std::size_t i = 0; i < size_; ++i) {
    const auto number = static_cast<std::int32_t>(i);
    polygons_[from_][i] = {
        vertices_[static_cast<std::size_t>(loop[i])], Kind::corner_of_facet, false, number, 0, number};
  }
  const Vec3 up = triangle.side * n;
  for (std::size_t i = 0; i < 3 && size_ > 0; ++i) {
    const Vec3& corner = triangle.corners[i];
    cut((triangle.corners[i < 2 ? i + 1 : 0] - corner).cross(up), corner, static_cast<std::int32_t>(i));
  }
}

std::optional<Vec3> GentleGround::way_at(const Corner& nearest, const IndexList& loop, int facet, const Placed& placed,
                                         std::size_t place) {
  const auto number = static_cast<std::size_t>(nearest.of_triangle);
  switch (nearest.kind) {
    case Kind::corner_of_facet:
      return placed.normal;
    case Kind::corner_of_triangle: {
      const Vec3 n = -normals_[static_cast<std::size_t>(facet)];
      const Vec3 local = mesh_.rotation().transpose() * n;
      const Vec3& from = around_[place][number];
      bool leads_on = false;
      const bool all = edges_.round_corner(place, number, [&](const Vec3& end) {
        const Vec3 way = end - from;
        const double rise = local.dot(way);
        leads_on = rise > 0 && rise * rise > kDecided * kDecided * way.squaredNorm();
        return leads_on;
      });
      if (leads_on) return placed.normal;
      if (all) return n.normalized();
      return {};
    }
    case Kind::crossing: {
      const Vec3* const across = edges_.across(place, number);
      if (across == nullptr) return {};
      const auto begin = static_cast<std::size_t>(nearest.of_facet);
      const std::size_t end = begin + 1 < loop.size() ? begin + 1 : 0;
      const Vec3& from = placed.corners[number];
      const Vec3& to = placed.corners[number < 2 ? number + 1 : 0];
      Vec3 n = (to - from).cross(vertices_[static_cast<std::size_t>(loop[end])] -
                                 vertices_[static_cast<std::size_t>(loop[begin])]);
      if (n.dot(placed.normal) < 0) n = -n;
      const double length = n.norm();
      if (!(length > 0)) return {};
      const Vec3 way = mesh_.apply(*across) - from;
      const double rise = n.dot(way);
      if (rise > 0 && rise * rise > kLevel * kLevel * length * length * way.squaredNorm()) return placed.normal;
      return n / length;
    }
  }
  return {};
}

void GentleGround::add_points(const Placed& triangle, const Vec3& n) {
  // Seen along n, planes are so much farther than across.
  const double steep = 1 / n.dot(triangle.normal);
  for (const Corner& corner : polygon()) {
    const double gap = (triangle.normal.dot(corner.point) - triangle.level + margin_ + mesh_margin_) * steep;
    const double depth = margin_ + mesh_margin_ - gap;
    if (depth < -threshold_) continue;
    if (manifolds_.empty() || manifolds_.back().count == 4) {
      manifolds_.emplace_back();
      manifolds_.back().normal = n;
    }
    const Vec3 on_body = corner.point - margin_ * n;
    const std::int64_t id = static_cast<std::int64_t>(corner.kind) << 50 |
                            static_cast<std::int64_t>(corner.of_facet) << 25 |
                            static_cast<std::int64_t>(corner.of_triangle);
    ContactManifold& points = manifolds_.back();
    points.points[static_cast<std::size_t>(points.count++)] = {on_body, on_body + depth * n, depth, id};
  }
}

bool GentleGround::ask_sphere(const Placed& placed, std::size_t place) {
  // 1. The point of the triangle nearest to the centre: its foot, or one of the edges that it lies beyond.
  const Vec3& centre = vertices_[0];
  const Vec3 up = placed.side * placed.normal;
  Vec3 foot = centre - (placed.distance + margin_ + mesh_margin_) * placed.normal;
  std::size_t edge = 3;
  double along_edge = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& from = placed.corners[i];
    const Vec3 along = placed.corners[i < 2 ? i + 1 : 0] - from, way = centre - from;
    if (along.cross(up).dot(way) <= 0) continue;
    const double share = std::clamp(way.dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double squared = (way - share * along).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    edge = i;
    along_edge = share;
    foot = from + share * along;
  }
  Vec3 n = placed.normal;
  double depth = -placed.distance;
  if (edge < 3) {
    const double length = std::sqrt(least);
    depth = margin_ + mesh_margin_ - length;
    if (depth < -threshold_) return true;
    if (!(length > 0)) return false;  // on the edge, as far as rounding tells: no way off it is known
    n = (centre - foot) / length;

    // 2. Where the mesh goes on against that, the contact is another triangle's: turned to this one's normal it would
    // lie beside it.
    const Vec3 local = mesh_.rotation().transpose() * n;
    const auto leads_on = [&](const Vec3& from, const Vec3& to) {
      const Vec3 way = to - from;
      const double rise = local.dot(way);
      return rise > 0 && rise * rise > kLevel * kLevel * way.squaredNorm();
    };
    if (along_edge > 0 && along_edge < 1) {
      const Vec3* const across = edges_.across(place, edge);
      if (across == nullptr) return false;
      if (leads_on(around_[place][edge], *across)) return true;
    } else {
      const std::size_t number = along_edge > 0 ? (edge + 1) % 3 : edge;
      bool covered = false;
      const bool all = edges_.round_corner(place, number, [&](const Vec3& end) {
        covered = leads_on(around_[place][number], end);
        return covered;
      });
      if (covered) return true;
      if (!all) return false;
    }
  }
  manifolds_.emplace_back();
  ContactManifold& points = manifolds_.back();
  points.normal = n;
  points.count = 1;
  const Vec3 on_body = centre - margin_ * n;
  points.points[0] = {on_body, on_body + depth * n, depth, 0};
  return true;
}

bool GentleGround::ask(std::size_t place) {
  manifolds_.clear();
  // 1. How far the body is along the normal of the side where it is.
  Placed placed;
  for (std::size_t i = 0; i < 3; ++i) placed.corners[i] = mesh_.apply(around_[place][i]);
  const Vec3& corner = placed.corners[0];
  const Vec3 across = (placed.corners[1] - corner).cross(placed.corners[2] - corner);
  const double area = across.norm();
  if (!(area > 0)) return false;
  placed.side = across.dot(origin_ - corner) < 0 ? -1 : 1;
  if (one_sided_ && placed.side < 0) return false;
  placed.normal = placed.side / area * across;
  const Vec3& n = placed.normal;
  double lowest = n.dot(vertices_[0]), highest = lowest;
  for (const Vec3& vertex : vertices_) {
    const double height = n.dot(vertex);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  placed.level = n.dot(corner) + margin_ + mesh_margin_;
  placed.distance = lowest - placed.level;
  if (placed.distance > threshold_) return true;
  if (-placed.distance > kShallow * (highest - lowest + 2 * margin_)) return false;
  if (sphere_) return ask_sphere(placed, place);
  if (!is_gentle(place, placed.side)) return false;

  // 2. The facet that faces it. One that has not the lowest corner is steep, as another one is.
  const int facet = facet_against(n);
  if (facet < 0) return false;
  const auto loop = polytope_->facet_vertices(facet);
  const auto height_of = [&](std::int32_t v) { return n.dot(vertices_[static_cast<std::size_t>(v)]); };
  if (std::none_of(loop.begin(), loop.end(), [&](std::int32_t v) { return height_of(v) <= lowest; })) return false;

  // 3. Where it is nearest to the triangle, and what it says there.
  cut_facet(loop, placed, n);
  if (size_ == 0) return true;
  const std::span<const Corner> left = polygon();
  const auto nearest = std::min_element(
      left.begin(), left.end(), [&](const Corner& x, const Corner& y) { return n.dot(x.point) < n.dot(y.point); });
  if (n.dot(nearest->point) - placed.level > threshold_) return true;
  const double depth = placed.level - n.dot(nearest->point);
  if (!one_sided_ && depth > detail::kLookedAt * (highest - lowest + 2 * margin_) &&
      !detail::reaches_back(body_, nearest->point - margin_ * n, n, depth - mesh_margin_)) {
    return false;
  }
  const std::optional<Vec3> way = way_at(*nearest, loop, facet, placed, place);
  if (!way || way->dot(n) < kFacing) return false;
  if (*way != n) cut_facet(loop, placed, *way);
  add_points(placed, *way);
  return true;
}

}  // namespace pd
