#include "compound/buried_faces.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace pd::detail {

BuriedFaces::BuriedFaces(PosedParts parts) {
  const Pose& pose = parts[0].pose;
  if (!std::all_of(parts.begin(), parts.end(), [&](const PosedShape& part) { return part.pose == pose; })) return;

  // 1. Vertices of one place are one point.
  std::map<std::array<double, 3>, std::int32_t> numbers;
  for (const PosedShape& part : parts) {
    const ConvexPolytope& polytope = *part.shape->polytope();
    std::vector<std::int32_t>& points = points_.emplace_back();
    for (int v = 0; v < polytope.num_vertices(); ++v) {
      const Vec3 x = polytope.vertex(v);
      points.push_back(
          numbers.try_emplace({x.x(), x.y(), x.z()}, static_cast<std::int32_t>(numbers.size())).first->second);
    }
    buried_.emplace_back(static_cast<std::size_t>(polytope.num_facets()), 0);
  }

  // 2. Two solid parts on the two sides of one facet.
  struct Place {
    std::size_t part;
    int facet;
  };
  std::map<std::vector<std::int32_t>, std::vector<Place>> places;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ConvexPolytope& polytope = *parts[i].shape->polytope();
    if (polytope.affine_dimension() < 3) continue;
    for (int f = 0; f < polytope.num_facets(); ++f) {
      std::vector<std::int32_t> corners;
      for (const std::int32_t v : polytope.facet_vertices(f))
        corners.push_back(points_[i][static_cast<std::size_t>(v)]);
      std::sort(corners.begin(), corners.end());
      std::vector<Place>& same = places[corners];
      for (const Place& other : same) {
        const Vec3 normal = parts[other.part].shape->polytope()->facet_normal(other.facet);
        if (!(normal.dot(polytope.facet_normal(f)) < 0)) continue;
        buried_[i][static_cast<std::size_t>(f)] = buried_[other.part][static_cast<std::size_t>(other.facet)] = 1;
      }
      same.push_back({i, f});
    }
  }

  // 3. Edges and vertices of the other facets are bare.
  bare_points_.assign(numbers.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ConvexPolytope& polytope = *parts[i].shape->polytope();
    if (polytope.affine_dimension() < 3) {
      for (const std::int32_t p : points_[i]) bare_points_[static_cast<std::size_t>(p)] = 1;
      continue;
    }
    for (int f = 0; f < polytope.num_facets(); ++f) {
      if (buried_[i][static_cast<std::size_t>(f)] != 0) continue;
      const auto loop = polytope.facet_vertices(f);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const std::int32_t p = points_[i][static_cast<std::size_t>(loop[k])];
        const std::int32_t q = points_[i][static_cast<std::size_t>(loop[(k + 1) % loop.size()])];
        bare_points_[static_cast<std::size_t>(p)] = 1;
        bare_edges_.insert(edge(p, q));
      }
    }
  }
}

bool BuriedFaces::holds(std::int32_t part, const Feature& face) const {
  if (points_.empty()) return false;
  const auto i = static_cast<std::size_t>(part);
  const auto point = [&](std::int32_t v) { return points_[i][static_cast<std::size_t>(v)]; };
  switch (face.kind) {
    case Feature::Kind::facet:
      return buried_[i][static_cast<std::size_t>(face.first)] != 0;
    case Feature::Kind::edge: {
      // A flat part's edge may have no solid part around it.
      const std::int32_t p = point(face.first), q = point(face.second);
      const bool flat = buried_[i].size() < 4;
      return !flat && !bare_edges_.contains(edge(p, q));
    }
    case Feature::Kind::vertex:
      return bare_points_[static_cast<std::size_t>(point(face.first))] == 0;
    case Feature::Kind::none:
      break;
  }
  return false;
}

}  // namespace pd::detail
