#include "world/pieces_in_region.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// Returns a lower bound of the distance of two boxes, rounding included.
double distance_between(const ChildBox& a, const ChildBox& b) {
  Vec3 gap = Vec3::Zero();
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    gap[k] = std::max({0.0, static_cast<double>(a.lower[k]) - static_cast<double>(b.upper[k]),
                       static_cast<double>(b.lower[k]) - static_cast<double>(a.upper[k])});
    for (const btScalar x : {a.lower[k], a.upper[k], b.lower[k], b.upper[k]}) {
      largest = std::max(largest, std::abs(static_cast<double>(x)));
    }
  }
  return std::max(0.0, gap.norm() / kTurned - kRounded * largest);
}

}  // namespace

Expected<std::shared_ptr<const CachedShape>> exact_body(const btConvexShape& shape, BulletShapeCache* cache) {
  std::shared_ptr<const CachedShape> body = cache != nullptr ? cache->find(shape, 0) : converted(shape);
  if (!body->body) return body->refusal;
  return body;
}

bool convert(RegionCandidate& candidate) {
  if (candidate.piece.body != nullptr) return true;
  auto triangle = to_shape({candidate.corners, candidate.piece.part, candidate.piece.index}, candidate.margin);
  if (triangle == nullptr) return false;
  auto body = std::make_shared<CachedShape>();
  body->body = std::move(triangle);
  candidate.piece.body = std::move(body);
  return true;
}

bool Pieces::add(const btCollisionShape& shape, const btTransform& pose, int part, int index, bool outermost) {
  const ChildBox box = box_of(shape, pose);
  if (apart(box, region_.reached, 0)) return true;
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    bool all = true;
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      all = add(*compound.getChildShape(i), pose * compound.getChildTransform(i), -1, outermost ? i : index, false) &&
            all;
    }
    return all;
  }
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
    add_plane(static_cast<const btStaticPlaneShape&>(shape), pose);
    return true;
  }
  if (shape.isConcave()) {
    add_triangles(static_cast<const btConcaveShape&>(shape), pose, box);
    return true;
  }
  if (!shape.isConvex()) return false;
  auto body = exact_body(static_cast<const btConvexShape&>(shape), cache_);
  if (!body) return false;
  pieces.push_back({{std::move(body).value(), pose, part, index}, {}, 0, distance_between(box, region_.way)});
  return true;
}

void Pieces::sort() {
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const RegionCandidate& x, const RegionCandidate& y) { return x.nearest < y.nearest; });
}

// `own` is the shape's box in the world. A region may be so wide that its middle loses the shape.
void Pieces::add_triangles(const btConcaveShape& shape, const btTransform& pose, const ChildBox& own) {
  btVector3 lower = region_.reached.lower, upper = region_.reached.upper;
  lower.setMax(own.lower);
  upper.setMin(own.upper);
  // The box of the box in the shape's frame, wider by what these sums are rounded by.
  const btScalar rounded = 8 * SIMD_EPSILON * std::max({lower.length(), upper.length(), pose.getOrigin().length()});
  const btVector3 middle = pose.invXform(btScalar(0.5) * (lower + upper));
  const btMatrix3x3 turn = pose.getBasis().transpose().absolute();
  const btVector3 half = turn * (btScalar(0.5) * (upper - lower)) + btVector3(rounded, rounded, rounded);
  const Whereabouts around = whereabouts(pose);
  const Whereabouts near{around.centre, around.radius + region_.reach};
  const double margin = margin_of_triangles(shape);
  // The nearest triangle is no farther than this. One without an area has no distance.
  double most = HUGE_VAL;
  for (const auto& triangle : corners_in_box(shape, middle - half, middle + half, &near)) {
    const double distance = distance_from(around.centre, triangle.corners);
    const double least = distance / kTurned - around.radius - margin;
    if (region_.nearest && least > most) continue;
    if (distance * kTurned + around.radius < most) most = distance * kTurned + around.radius;
    pieces.push_back({{nullptr, pose, triangle.part, triangle.index}, triangle.corners, margin, least > 0 ? least : 0});
  }
}

// The part of a plane below the way, as one triangle of doubles. Bullet's triangles of floats lie off the plane by a
// share of the box's size.
void Pieces::add_plane(const btStaticPlaneShape& plane, const btTransform& pose) {
  const Vec3 lower = to_pd(region_.way.lower), upper = to_pd(region_.way.upper);
  const Pose placed = to_pd(pose);
  const Vec3 middle = placed.rotation().transpose() * (0.5 * (lower + upper) - placed.translation());
  const Vec3 normal = to_pd(plane.getPlaneNormal()).normalized();
  const Vec3 foot = middle - (normal.dot(middle) - static_cast<double>(plane.getPlaneConstant())) * normal;
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  const Vec3 half = 0.5 * (upper - lower);
  const auto width = [&](const Vec3& axis) { return (placed.rotation() * axis).cwiseAbs().dot(half); };
  // No way past an edge is as short as the way out along the normal.
  const double radius = 4 * (width(u) + width(v) + region_.diameter);
  const double height = std::sqrt(3.0);
  const std::array corners{Vec3(foot - radius * u - height * radius * v), Vec3(foot - radius * u + height * radius * v),
                           Vec3(foot + 2 * radius * u)};
  auto triangle = ConvexPolytope::from_points(corners);
  if (!triangle) return;
  auto body = std::make_shared<CachedShape>();
  body->body = std::make_shared<const ConvexShape>(std::move(triangle).value());
  pieces.push_back({{std::move(body), pose, 0, 0}, {}, 0, 0});
}

Whereabouts Pieces::whereabouts(const btTransform& pose) const {
  const Vec3 lower = to_pd(region_.way.lower), upper = to_pd(region_.way.upper);
  const Vec3 middle = 0.5 * (lower + upper);
  const double rounded = kRounded * (middle.norm() + to_pd(pose.getOrigin()).norm());
  return {to_pd(pose.invXform(to_bullet(middle))), kTurned * 0.5 * (upper - lower).norm() + rounded};
}

}  // namespace pd::detail
