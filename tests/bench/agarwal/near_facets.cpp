#include "bench/agarwal/near_facets.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/structure/overlay.hpp"

namespace pd::bench {

namespace {

/// Squared distance of the origin from the segment p q.
double squared_distance(const Vec3& p, const Vec3& q) {
  const Vec3 edge = q - p;
  const double length = edge.squaredNorm();
  const double t = length > 0 ? std::clamp(-p.dot(edge) / length, 0.0, 1.0) : 0.0;
  return (p + t * edge).squaredNorm();
}

class NearCounter : public OverlayVisitor {
 public:
  NearCounter(const scenes::PolytopePair& pair, double radius) : pair_(pair), squared_radius_(radius * radius) {
    for (int i = 0; i < pair.a.num_vertices(); ++i) a_.push_back(pair.pose_a.apply(pair.a.vertex(i)));
    for (int i = 0; i < pair.b.num_vertices(); ++i) b_.push_back(pair.pose_b.apply(pair.b.vertex(i)));
  }

  bool visit(std::span<const OverlayFacet> facets) override {
    for (const OverlayFacet& facet : facets) {
      set_corners(facet);
      count_ += squared_distance_from_origin(corners_) <= squared_radius_ ? 1 : 0;
    }
    return true;
  }

  [[nodiscard]] std::int64_t count() const { return count_; }

 private:
  [[nodiscard]] Vec3 point(int a, int b) const {
    return b_[static_cast<std::size_t>(b)] - a_[static_cast<std::size_t>(a)];
  }

  void set_corners(const OverlayFacet& facet) {
    corners_.clear();
    const Feature &x = facet.on_a, &y = facet.on_b;
    if (x.kind == Feature::Kind::facet) {
      for (const std::int32_t v : pair_.a.facet_vertices(x.first)) corners_.push_back(point(v, y.first));
    } else if (y.kind == Feature::Kind::facet) {
      for (const std::int32_t v : pair_.b.facet_vertices(y.first)) corners_.push_back(point(x.first, v));
    } else {
      corners_ = {point(x.first, y.first), point(x.second, y.first), point(x.second, y.second),
                  point(x.first, y.second)};
    }
  }

  const scenes::PolytopePair& pair_;
  double squared_radius_;
  std::vector<Vec3> a_, b_;  ///< posed
  std::vector<Vec3> corners_;
  std::int64_t count_ = 0;
};

}  // namespace

double squared_distance_from_origin(std::span<const Vec3> corners) {
  Vec3 normal = Vec3::Zero();  // Newell's: twice the area
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  }
  double least = HUGE_VAL;
  bool inside = normal.squaredNorm() > 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3& p = corners[i];
    const Vec3& q = corners[(i + 1) % corners.size()];
    least = std::min(least, squared_distance(p, q));
    inside = inside && normal.dot((q - p).cross(-p)) >= 0;
  }
  if (!inside) return least;
  const double height = normal.dot(corners[0]);
  return height * height / normal.squaredNorm();
}

std::int64_t count_near_facets(const scenes::PolytopePair& pair, double radius) {
  NearCounter counter(pair, radius * (1 + 1e-12));
  Overlay overlay;
  overlay.walk(pair.a, pair.pose_a, pair.b, pair.pose_b, OverlayPieces::as_walked, counter);
  return counter.count();
}

}  // namespace pd::bench
