#include "depth/features/near_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "depth/difference/smooth_difference.hpp"
#include "numeric/length.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

double cross(const PlanePoint& u, const PlanePoint& v) { return u.x() * v.y() - u.y() * v.x(); }

PlanePoint left_of(const PlanePoint& v) { return {-v.y(), v.x()}; }

/// Andrew's monotone chain; rounding may keep or drop points next to an edge, which tolerances cover.
std::vector<PlanePoint> hull_of(std::vector<PlanePoint> points) {
  const auto before = [](const PlanePoint& u, const PlanePoint& v) {
    return u.x() != v.x() ? u.x() < v.x() : u.y() < v.y();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<PlanePoint> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t floor = hull.size() + 1;
    for (const PlanePoint& p : points) {
      while (hull.size() > floor && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// The part of a convex polygon with <p, normal> <= offset.
std::vector<PlanePoint> clipped(const std::vector<PlanePoint>& polygon, const PlanePoint& normal, double offset) {
  std::vector<PlanePoint> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const PlanePoint& p = polygon[i];
    const PlanePoint& q = polygon[(i + 1) % polygon.size()];
    const double over_p = p.dot(normal) - offset, over_q = q.dot(normal) - offset;
    if (over_p <= 0) kept.push_back(p);
    if ((over_p < 0 && over_q > 0) || (over_p > 0 && over_q < 0)) {
      kept.push_back(p + over_p / (over_p - over_q) * (q - p));
    }
  }
  return kept;
}

/// The hull grown by a square of half side `sideways`, as far as it lies within `half` of the centre.
std::vector<PlanePoint> grown_and_cut(const std::vector<PlanePoint>& hull, double sideways, double half) {
  std::vector<PlanePoint> corners;
  for (const PlanePoint& p : hull) {
    for (const double x : {-sideways, sideways}) {
      for (const double y : {-sideways, sideways}) corners.push_back(p + PlanePoint(x, y));
    }
  }
  std::vector<PlanePoint> polygon = hull_of(std::move(corners));
  for (int axis = 0; axis < 2; ++axis) {
    for (const double sign : {-1.0, 1.0}) polygon = clipped(polygon, sign * PlanePoint::Unit(axis), half);
  }
  return polygon;
}

double extent_along(const std::vector<PlanePoint>& hull, const PlanePoint& direction) {
  double most = -std::numeric_limits<double>::infinity();
  for (const PlanePoint& p : hull) most = std::max(most, p.dot(direction));
  return most;
}

const Sphere& farthest_sphere(const SphereHull& hull, const Vec3& unit) {
  const auto height = [&](const Sphere& s) { return s.centre.dot(unit) + s.radius; };
  return *std::max_element(hull.spheres().begin(), hull.spheres().end(),
                           [&](const Sphere& x, const Sphere& y) { return height(x) < height(y); });
}

/// The angle by which a unit vector must turn for `other` to reach as far as `first`, for small ones.
double fall_off(const Sphere& first, const Sphere& other, const Vec3& unit) {
  const Vec3 apart = first.centre - other.centre;
  const double along = apart.dot(unit);
  return (along + first.radius - other.radius) / (apart - along * unit).norm();
}

/// What a curved core shows of its curvature in its own frame.
struct LocalCurvature {
  Vec3 outward;
  Vec3 point;
  int flats;

  Mat3 operator()(const Ellipsoid& e) const {
    const Vec3 squares = e.radii.cwiseProduct(e.radii);
    const Vec3 scaled = squares.cwiseProduct(outward);
    const double h = std::sqrt(scaled.dot(outward));
    return Mat3(squares.asDiagonal()) / h - scaled * scaled.transpose() / (h * h * h);
  }
  Mat3 operator()(const Cylinder& c) const { return round(c.axis); }
  Mat3 operator()(const Cone& c) const { return round(c.axis); }
  Mat3 operator()(const ConvexPolytope&) const { return Mat3::Zero(); }
  /// On a line between two spheres the ball that touches there has a radius between theirs.
  Mat3 operator()(const SphereHull& hull) const {
    const Vec3 unit = outward.normalized();
    const Sphere& first = farthest_sphere(hull, unit);
    if (flats == 0) return first.radius * (Mat3::Identity() - unit * unit.transpose());
    const Sphere* second = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& s : hull.spheres()) {
      if (&s == &first || !(fall_off(first, s, unit) < least)) continue;
      least = fall_off(first, s, unit);
      second = &s;
    }
    const Vec3 line = second->centre + second->radius * unit - first.centre - first.radius * unit;
    const double squared = line.squaredNorm();
    const double share = squared > 0 ? (point - first.centre - first.radius * unit).dot(line) / squared : 0;
    const Vec3 tangent = unit.cross(line).normalized();
    return (first.radius + share * (second->radius - first.radius)) * tangent * tangent.transpose();
  }

  /// A circle of the point's own distance from the axis, seen in the outward direction.
  [[nodiscard]] Mat3 round(int axis) const {
    Vec3 radial = outward, arm = point;
    radial[axis] = arm[axis] = 0;
    if (radial.isZero(0)) return Mat3::Zero();
    const Vec3 tangent = radial.normalized().cross(Vec3::Unit(axis));
    return arm.norm() / radial.norm() * tangent * tangent.transpose();
  }
};

struct StraightDimensions {
  Vec3 outward;
  double lean;

  int operator()(const Ellipsoid&) const { return 0; }
  int operator()(const Cylinder& c) const {
    if (radial(c.axis) <= lean) return 2;
    return std::abs(outward[c.axis]) <= lean ? 1 : 0;
  }
  int operator()(const Cone& c) const {
    if (radial(c.axis) <= lean) return outward[c.axis] < 0 ? 2 : 0;
    const double along = c.radius * radial(c.axis) - 2 * c.half_height * outward[c.axis];
    return std::abs(along) <= lean * length(c.radius, 2 * c.half_height) ? 1 : 0;
  }
  int operator()(const ConvexPolytope&) const { return 2; }
  int operator()(const SphereHull& hull) const {
    const Sphere& first = farthest_sphere(hull, outward);
    int lines = 0;
    Vec3 line = Vec3::Zero();
    for (const Sphere& s : hull.spheres()) {
      if (&s == &first || !(fall_off(first, s, outward) <= lean)) continue;
      const Vec3 other = s.centre + s.radius * outward - first.centre - first.radius * outward;
      const bool same_line = lines > 0 && other.cross(line).norm() <= lean * other.norm() * line.norm();
      if (!same_line) ++lines;
      line = other;
    }
    return std::min(lines, 2);
  }

  [[nodiscard]] double radial(int axis) const {
    Vec3 flat = outward;
    flat[axis] = 0;
    return flat.norm();
  }
};

}  // namespace

PosedCore::PosedCore(const PosedShape& body, const Vec3& origin)
    : core_(&body.shape->core()),
      polytope_(body.shape->polytope()),
      rotation_(polytope_ ? body.pose.rotation() : body.pose.nearest_rotation()),
      offset_(body.pose.translation() - origin) {}

Vec3 PosedCore::support(const Vec3& direction) const {
  const Vec3 local = rotation_.transpose() * direction;
  if (polytope_) return rotation_ * polytope_->vertex(support_vertex(*polytope_, local, -1)) + offset_;
  return rotation_ * support_point(*core_, local) + offset_;
}

void PosedCore::near_face(const Vec3& outward, double height, double lean, std::vector<Vec3>& points) const {
  points.clear();
  const Vec3 local = rotation_.transpose() * outward;
  if (!polytope_) {
    constexpr int kLeaningsOfAQuarter = 8;
    const Vec3 u = outward.unitOrthogonal(), v = outward.cross(u);
    for (int k = 0; k < kLeaningsOfAQuarter; ++k) {
      // A rational point of the circle, the same bits everywhere, and its turns by quarters; 14.3 degrees apart at
      // most.
      const double t = static_cast<double>(k) / kLeaningsOfAQuarter;
      const double x = (1 - t * t) / (1 + t * t), y = 2 * t / (1 + t * t);
      const Vec3 first = x * u + y * v, second = x * v - y * u;
      for (const Vec3& aside : {first, second, Vec3(-first), Vec3(-second)}) {
        points.push_back(support(outward + lean * aside));
      }
    }
    return;
  }
  // The vertices above a height are connected by edges.
  std::vector<std::int32_t> queue{support_vertex(*polytope_, local, -1)};
  std::unordered_set<std::int32_t> met(queue.begin(), queue.end());
  const double least = polytope_->vertex(queue.front()).dot(local) - height;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    points.push_back(rotation_ * polytope_->vertex(queue[i]) + offset_);
    for (const std::int32_t next : polytope_->neighbours(queue[i])) {
      if (polytope_->vertex(next).dot(local) >= least && met.insert(next).second) queue.push_back(next);
    }
  }
}

Mat3 PosedCore::curvature(const Vec3& outward, const Vec3& point, int flats) const {
  const LocalCurvature local{rotation_.transpose() * outward, rotation_.transpose() * (point - offset_), flats};
  return rotation_ * std::visit(local, *core_) * rotation_.transpose();
}

int PosedCore::straight_dimensions(const Vec3& outward, double lean) const {
  return std::visit(StraightDimensions{rotation_.transpose() * outward, lean}, *core_);
}

PlaneFace::PlaneFace(const std::vector<Vec3>& points, const Vec3& centre, const std::array<Vec3, 2>& across) {
  std::vector<PlanePoint> flat;
  flat.reserve(points.size());
  for (const Vec3& p : points) flat.emplace_back((p - centre).dot(across[0]), (p - centre).dot(across[1]));
  hull_ = hull_of(std::move(flat));
}

int PlaneFace::extent(double reach, std::array<PlanePoint, 2>& directions) const {
  PlanePoint far = PlanePoint::Zero();
  for (const PlanePoint& p : hull_) {
    if ((p - hull_[0]).squaredNorm() > far.squaredNorm()) far = p - hull_[0];
  }
  if (far.norm() <= reach) return 0;
  directions[0] = far.normalized();
  directions[1] = left_of(directions[0]);
  const double wide = extent_along(hull_, directions[1]) + extent_along(hull_, -directions[1]);
  return wide <= reach ? 1 : 2;
}

double PlaneFace::inside(int extent, const std::array<PlanePoint, 2>& directions) const {
  if (extent == 0) return 0;
  if (extent == 1) return std::min(extent_along(hull_, directions[0]), extent_along(hull_, -directions[0]));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull_.size(); ++i) {
    const PlanePoint edge = hull_[(i + 1) % hull_.size()] - hull_[i];
    least = std::min(least, -left_of(edge).normalized().dot(hull_[i]));
  }
  return least;
}

bool share_more_than_the_centre(const PlaneFace& a, const PlaneFace& b, double sideways, double reach) {
  if (a.hull().size() == 1 || b.hull().size() == 1) return false;
  // Next to the centre a face has few corners, however many it has in all.
  std::vector<PlanePoint> common = grown_and_cut(a.hull(), sideways, 4 * reach);
  const std::vector<PlanePoint> other = grown_and_cut(b.hull(), sideways, 4 * reach);
  for (std::size_t i = 0; i < other.size(); ++i) {
    const PlanePoint edge = other[(i + 1) % other.size()] - other[i];
    if (edge.isZero(0)) continue;
    const PlanePoint outward = -left_of(edge).normalized();
    common = clipped(common, outward, outward.dot(other[i]));
  }
  return std::any_of(common.begin(), common.end(), [&](const PlanePoint& p) { return p.norm() > reach; });
}

double disc_in_difference(const PlaneFace& a, const PlaneFace& b) {
  // The support function of the sum is least, over unit vectors, across an edge of one of the two.
  double least = std::numeric_limits<double>::infinity();
  const auto across_edges = [&](const std::vector<PlanePoint>& hull) {
    if (hull.size() < 2) return;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const PlanePoint edge = hull[(i + 1) % hull.size()] - hull[i];
      if (edge.isZero(0)) continue;
      for (const double sign : {-1.0, 1.0}) {
        const PlanePoint d = sign * left_of(edge).normalized();
        least = std::min(least, extent_along(b.hull(), d) + extent_along(a.hull(), -d));
      }
    }
  };
  // 0 is always right, and only slower for the search that asks.
  constexpr std::size_t kFewCorners = 256;
  if (a.hull().size() > kFewCorners || b.hull().size() > kFewCorners) return 0;
  across_edges(a.hull());
  across_edges(b.hull());
  return std::isfinite(least) ? std::max(0.0, least) : 0;
}

}  // namespace pd::detail
