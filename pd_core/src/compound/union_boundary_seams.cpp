/// @file
/// The nearest boundary point with seams closed, in doubles: `UnionBoundary::nearest_past_seams`.
#include <algorithm>
#include <cmath>
#include <utility>

#include "compound/nearest_first.hpp"
#include "compound/union_boundary.hpp"

namespace pd::detail {

namespace {

/// A P_k that faces a facet may lie three slacks outside of a point of the facet that it covers, one that looks the
/// same way one slack inside.
constexpr double kSeam = 3;

/// The point of a convex polygon, counter-clockwise about the plane's normal, nearest to the origin.
Vec3 nearest_to_origin(const std::vector<Vec3>& polygon, const RoughPlane& plane) {
  const Vec3 foot = plane.offset * plane.normal;
  Vec3 best = foot;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& from = polygon[i];
    const Vec3 along = polygon[i + 1 < polygon.size() ? i + 1 : 0] - from;
    if (plane.normal.cross(along).dot(foot - from) >= 0) continue;
    const double squared = along.squaredNorm();
    const double t = squared > 0 ? std::clamp(-from.dot(along) / squared, 0.0, 1.0) : 0.0;
    const Vec3 x = from + t * along;
    if (x.squaredNorm() < least) {
      least = x.squaredNorm();
      best = x;
    }
  }
  return best;
}

}  // namespace

class UnionBoundary::SeamSearch {
 public:
  SeamSearch(UnionBoundary& boundary, double slack, const Measure& measure)
      : boundary_(boundary), slack_(slack), measure_(measure), depths_(boundary.boxes_.size(), kUnmeasured) {}

  std::optional<PastSeams> run() {
    for (std::size_t k = 0; k < boundary_.boxes_.size(); ++k) {
      const Box& box = boundary_.boxes_[k];
      push_piece((box.low.cwiseMax(Vec3::Zero()) + box.high.cwiseMin(Vec3::Zero())).norm(), k);
    }
    while (!queue_.empty()) {
      Part top = queue_.pop();
      if (top.corners.empty()) {
        if (depths_[top.piece] == kUnmeasured) {
          measure(top.piece);
        } else if (!made(top.piece)) {
          make(top.piece);
        }
      } else if (const auto cover = find_cover(top)) {
        subtract(std::move(top), *cover);
      } else if (!boundary_.differences_.limit_exceeded()) {
        return PastSeams{top.piece, top.nearest};
      }
      if (boundary_.differences_.limit_exceeded()) break;
    }
    return std::nullopt;
  }

 private:
  /// A P_k (it has no corners) or a part of one of its facets.
  struct Part {
    std::size_t piece = 0;
    std::size_t facet = 0;
    Vec3 nearest = Vec3::Zero();
    std::vector<Vec3> corners;
    ClippedSet clipped;
  };
  static constexpr double kUnmeasured = -1;

  [[nodiscard]] const std::vector<RoughPlane>& planes(std::size_t k) const {
    return boundary_.differences_.pieces()[k].planes;
  }
  [[nodiscard]] bool made(std::size_t k) const {
    return boundary_.differences_.pieces()[k].made != PartDifference::Made::nothing;
  }
  /// A P_k may cover what is nearer than itself by a seam.
  void push_piece(double distance, std::size_t k) {
    Part whole;
    whole.piece = k;
    queue_.push(std::max(distance - kSeam * slack_, 0.0), std::move(whole));
  }
  void push_part(Part part) {
    part.nearest = nearest_to_origin(part.corners, planes(part.piece)[part.facet]);
    const double distance = part.nearest.norm();
    queue_.push(distance, std::move(part));
  }

  /// Lets a P_k wait again until it has to be made.
  void measure(std::size_t k) {
    const SignedDistance distance = measure_(k);
    depths_[k] = std::max(-distance.most, 0.0);
    push_piece(std::max(distance.least, -distance.most), k);
  }
  void make(std::size_t k) {
    const std::size_t count = boundary_.differences_.roughly(k).planes.size();
    made_.push_back(k);
    for (std::size_t f = 0; f < count; ++f) {
      Part part{k, f, Vec3::Zero(), {}, boundary_.own(k)};
      boundary_.rough_corners(k, f, part.corners);
      push_part(std::move(part));
    }
  }

  /// How far a P_k reaches beyond the origin along one of its planes, for facets of normal n.
  [[nodiscard]] double level(const RoughPlane& plane, const Vec3& n) const {
    return plane.offset + slack_ * (1 - (kSeam - 1) * plane.normal.dot(n));
  }
  [[nodiscard]] bool near(std::size_t k, const Part& part) const {
    const Box& box = boundary_.boxes_[k];
    return !has(part.clipped, k) && (part.nearest - box.high).maxCoeff() <= kSeam * slack_ &&
           (box.low - part.nearest).maxCoeff() <= kSeam * slack_;
  }
  /// A P_k that holds the part's nearest point, leads on from there and was not subtracted yet.
  std::optional<std::size_t> find_cover(const Part& part) {
    const Vec3 n = planes(part.piece)[part.facet].normal;
    const auto covers = [&](std::size_t k) {
      return near(k, part) && !planes(k).empty() &&
             std::all_of(planes(k).begin(), planes(k).end(),
                         [&](const RoughPlane& plane) { return plane.normal.dot(part.nearest) <= level(plane, n); });
    };
    // What covers one facet covers its neighbours.
    const auto found = std::find_if(made_.begin(), made_.end(), covers);
    if (found != made_.end()) {
      std::rotate(made_.begin(), found, found + 1);
      return made_.front();
    }
    // What is not made yet lies farther than this point, or holds the ball to it and beyond.
    const double far = part.nearest.norm();
    for (std::size_t k = 0; k < depths_.size() && !boundary_.differences_.limit_exceeded(); ++k) {
      if (made(k) || depths_[k] <= far || !near(k, part)) continue;
      make(k);
      if (covers(k)) return k;
    }
    return std::nullopt;
  }

  /// Lets what P_k leaves of a part wait.
  void subtract(Part part, std::size_t k) {
    const Vec3 n = planes(part.piece)[part.facet].normal;
    mark(part.clipped, k);
    std::vector<Vec3> inside = std::move(part.corners);
    for (const RoughPlane& plane : planes(k)) {
      heights_.clear();
      for (const Vec3& corner : inside) heights_.push_back(plane.normal.dot(corner) - level(plane, n));
      if (*std::max_element(heights_.begin(), heights_.end()) <= 0) continue;
      part.corners.clear();
      inner_.clear();
      for (std::size_t i = 0; i < inside.size(); ++i) {
        const std::size_t next = i + 1 < inside.size() ? i + 1 : 0;
        (heights_[i] > 0 ? part.corners : inner_).push_back(inside[i]);
        if ((heights_[i] > 0) == (heights_[next] > 0)) continue;
        const Vec3 crossing = inside[i] + heights_[i] / (heights_[i] - heights_[next]) * (inside[next] - inside[i]);
        part.corners.push_back(crossing);
        inner_.push_back(crossing);
      }
      push_part(part);
      inside.swap(inner_);
      if (inside.empty()) return;
    }
  }

  UnionBoundary& boundary_;
  const double slack_;
  const Measure& measure_;
  std::vector<double> depths_;     ///< P_k holds the ball of this radius around the origin
  std::vector<std::size_t> made_;  ///< what covered last comes first
  NearestFirst<Part> queue_;       ///< nothing of an item is nearer than its key
  std::vector<Vec3> inner_;
  std::vector<double> heights_;
};

std::optional<UnionBoundary::PastSeams> UnionBoundary::nearest_past_seams(double slack, const Measure& measure) {
  return SeamSearch(*this, slack, measure).run();
}

}  // namespace pd::detail
