#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pd/bullet/compound.hpp"
#include "pd/bullet/scalar.hpp"

namespace pd {

namespace {

/// Volume, and its first and second moments about the origin.
struct Moments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  /// Adds the tetrahedron between the origin and a triangle.
  void add(const Vec3& p, const Vec3& q, const Vec3& r) {
    const double v = p.dot(q.cross(r)) / 6;
    const Vec3 sum = p + q + r;
    volume += v;
    first += v / 4 * sum;
    second += v / 20 * (sum * sum.transpose() + p * p.transpose() + q * q.transpose() + r * r.transpose());
  }
  /// Adds the moments of a body whose own are about `at`.
  void add(const Moments& other, const Vec3& at) {
    volume += other.volume;
    first += other.first + other.volume * at;
    second +=
        other.second + other.first * at.transpose() + at * other.first.transpose() + other.volume * at * at.transpose();
  }
};

/// About `at`, which lies near the polytope, so that little cancels.
Moments moments_of(const ConvexPolytope& polytope, const Pose& pose, const Vec3& at) {
  Moments moments;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const auto loop = polytope.facet_vertices(f);
    const auto seen = [&](std::size_t k) -> Vec3 { return pose.apply(polytope.vertex(loop[k])) - at; };
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) moments.add(seen(0), seen(k), seen(k + 1));
  }
  return moments;
}

/// The vector as Bullet stores it. It passes through memory, since GCC 12 takes two numbers that are converted to float
/// and back, side by side in one register, for numbers that are not converted at all.
Vec3 as_stored(const Vec3& v) {
  const volatile btScalar stored[3] = {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()),
                                       static_cast<btScalar>(v.z())};
  return {static_cast<double>(stored[0]), static_cast<double>(stored[1]), static_cast<double>(stored[2])};
}

std::string name_of(std::size_t part) { return "parts[" + std::to_string(part) + "]"; }

Expected<std::unique_ptr<btConvexHullShape>> child_of(const Compound::Part& part, double margin, double& rounding) {
  const ConvexPolytope& polytope = *part.shape.polytope();
  auto child = std::make_unique<btConvexHullShape>();
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    const Vec3 exact = part.pose.apply(polytope.vertex(v));
    const Vec3 stored = as_stored(exact);
    const double moved = (stored - exact).norm();
    if (!std::isfinite(moved)) {
      return Error{ErrorCode::out_of_range, "a vertex lies beyond what Bullet's numbers hold", ""};
    }
    rounding = std::max(rounding, moved);
    child->addPoint(to_bullet(stored), false);
  }
  child->recalcLocalAabb();
  child->setMargin(static_cast<btScalar>(margin + part.shape.margin()));
  return child;
}

}  // namespace

Expected<BulletCompound> compound_of(const Compound& parts, const BulletCompoundSettings& settings) {
  if (!(settings.margin >= 0) || !std::isfinite(settings.margin)) {
    return Error{ErrorCode::bad_value, "a margin must be finite and 0 or greater", "margin"};
  }
  BulletCompound result;
  Moments sum;
  Vec3 middle = Vec3::Zero();
  for (std::size_t i = 0; i < parts.parts().size(); ++i) {
    const Compound::Part& part = parts.parts()[i];
    const ConvexPolytope* const polytope = part.shape.polytope();
    if (polytope == nullptr) {
      return Error{ErrorCode::unsupported, "the part is no convex polytope", name_of(i)};
    }
    auto child = child_of(part, settings.margin, result.rounding);
    if (!child) return Error{child.error().code, child.error().message, name_of(i)};
    // Moments are gathered about a point of the first part, so that a body far from the origin keeps its digits.
    const Vec3 centre = part.pose.apply(polytope->centre());
    if (i == 0) middle = centre;
    const Moments own = moments_of(*polytope, part.pose, centre);
    if (polytope->affine_dimension() < 3 || !(own.volume > 0)) {
      return Error{ErrorCode::not_full_dimensional, "the part has no volume that a double holds", name_of(i)};
    }
    if (!std::isfinite(own.volume)) {
      return Error{ErrorCode::out_of_range, "the part's volume is beyond what a double holds", name_of(i)};
    }
    sum.add(own, centre - middle);
    result.children.push_back(*std::move(child));
  }
  result.volume = sum.volume;
  const Vec3 offset = sum.first / sum.volume;
  result.centre_of_mass = middle + offset;
  const Mat3 spread = sum.second / sum.volume - offset * offset.transpose();
  result.inertia = spread.trace() * Mat3::Identity() - spread;
  if (!result.centre_of_mass.allFinite() || !result.inertia.allFinite()) {
    return Error{ErrorCode::out_of_range, "the moments are beyond what a double holds", "parts"};
  }
  if (settings.at_centre_of_mass) result.origin = as_stored(result.centre_of_mass);
  result.shape = std::make_unique<btCompoundShape>(true, static_cast<int>(result.children.size()));
  btTransform place = btTransform::getIdentity();
  place.setOrigin(to_bullet(-result.origin));
  for (const auto& child : result.children) result.shape->addChildShape(place, child.get());
  return result;
}

}  // namespace pd
