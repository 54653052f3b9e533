#include "union/flat_ground.hpp"

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <algorithm>

#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "union/sheet_sides.hpp"
#include "union/union_algorithm.hpp"

namespace pd::detail {

namespace {

/// Of coordinates: corners of a plane that its author rounded to Bullet's scalar.
constexpr double kFlat = sizeof(btScalar) == sizeof(float) ? 0x1p-22 : 0x1p-50;
/// Sine of two normals that are not one plane's.
constexpr double kTurned = 1e-3;

std::array<Vec3, 3> corners_of(const MetTriangle& triangle) {
  return {to_pd(triangle.corners[0]), to_pd(triangle.corners[1]), to_pd(triangle.corners[2])};
}

/// Whether a point of the triangle's plane lies in it, moved out by `slack`.
bool holds(const MetTriangle& triangle, const Vec3& across, const Vec3& point, double slack) {
  const std::array<Vec3, 3> corners = corners_of(triangle);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 outward = (corners[(i + 1) % 3] - corners[i]).cross(across);
    const double height = outward.dot(point - corners[i]);
    if (height > 0 && height * height > slack * slack * outward.squaredNorm()) return false;
  }
  return true;
}

/// Whether four of the triangles are in four planes for certain, which few of them tell where the ground is uneven.
bool are_of_many_planes(std::span<const MetTriangle> triangles, const std::vector<Vec3>& across, double rounding) {
  std::array<const Vec3*, FlatGround::kMostPlanes> found;
  std::size_t count = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Vec3& n = across[i];
    const double squared = n.squaredNorm();
    const bool repeated =
        std::any_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), [&](const Vec3* other) {
          return n.cross(*other).squaredNorm() <= kTurned * kTurned * squared * other->squaredNorm();
        });
    if (repeated) continue;
    const std::array<Vec3, 3> at = corners_of(triangles[i]);
    const double longest =
        std::max({(at[1] - at[0]).squaredNorm(), (at[2] - at[1]).squaredNorm(), (at[0] - at[2]).squaredNorm()});
    // So narrow that rounding of its corners may turn it.
    if (kTurned * kTurned * squared <= 64 * rounding * rounding * longest) continue;
    if (count == found.size()) return true;
    found[count++] = &n;
  }
  return false;
}

}  // namespace

bool FlatGround::sort_by_plane(std::span<const MetTriangle> triangles) {
  across_.clear();
  farthest_ = 0;
  for (const MetTriangle& triangle : triangles) {
    const std::array<Vec3, 3> corners = corners_of(triangle);
    across_.push_back((corners[1] - corners[0]).cross(corners[2] - corners[0]));
    for (const Vec3& corner : corners) farthest_ = std::max(farthest_, corner.cwiseAbs().maxCoeff());
  }
  const double rounding = kFlat * farthest_;
  if (are_of_many_planes(triangles, across_, rounding)) return false;
  plane_of_.assign(triangles.size(), -1);
  planes_.clear();
  for (std::size_t left = triangles.size(); left > 0;) {
    if (planes_.size() == kMostPlanes) return false;
    std::size_t seed = triangles.size();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (plane_of_[i] >= 0) continue;
      if (seed == triangles.size() || across_[i].squaredNorm() > across_[seed].squaredNorm()) seed = i;
    }
    const Vec3 normal = across_[seed].normalized();
    const double offset = normal.dot(to_pd(triangles[seed].corners[0]));
    const int number = static_cast<int>(planes_.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (plane_of_[i] >= 0) continue;
      const std::array<Vec3, 3> corners = corners_of(triangles[i]);
      const bool flat = std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
        return std::abs(normal.dot(corner) - offset) <= rounding;
      });
      if (!flat && i != seed) continue;
      plane_of_[i] = number;
      --left;
    }
    planes_.push_back({seed, {}, {}, Vec3::Zero()});
  }
  return true;
}

Vec3 FlatGround::known_front(const Body& body, std::span<const MetTriangle> triangles, const Plane& plane,
                             int number) const {
  const Vec3 normal = across_[plane.seed].normalized();
  const int child = is_part(body.wrapper) ? body.wrapper.m_index : -1;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (plane_of_[i] != number) continue;
    const Vec3 front = body.sides->front_of(number_of_pieces(child, triangles[i]), normal);
    if (!front.isZero()) return front;
  }
  return Vec3::Zero();
}

bool FlatGround::ask(const Body& body, const UnionQuestion& question, std::span<const MetTriangle> triangles,
                     SolverCore& core, ThreadBuffers& buffers, Plane& plane, int number) {
  const auto& shape = static_cast<const btConvexShape&>(*body.wrapper.getCollisionShape());
  const btTransform& body_pose = body.wrapper.getWorldTransform();
  const Pose mesh_pose = to_pd(question.b.getWorldTransform());
  const auto margin = static_cast<double>(question.b.getCollisionShape()->getMargin());

  // 1. The plane in the world, its normal to the side where the body is.
  const std::array<Vec3, 3> local = corners_of(triangles[plane.seed]);
  const Vec3 corner = mesh_pose.apply(local[0]);
  Vec3 normal = (mesh_pose.apply(local[1]) - corner).cross(mesh_pose.apply(local[2]) - corner).normalized();
  const auto turn_to = [&](const Vec3& place) {
    if (normal.dot(place - corner) < 0) normal = -normal;
  };
  const Vec3 front = normal;
  turn_to(to_pd(body_pose.getOrigin()));
  bool known = false;      // on which side the body belongs
  bool came_over = false;  // its middle was on the other side in the last step
  if (body.sides != nullptr) {
    const Vec3 before = mesh_pose.rotation() * known_front(body, triangles, plane, number);
    known = !before.isZero();
    if (known && normal.dot(before) < 0) normal = -normal;
    came_over = !known && normal.dot(mesh_pose.apply(body.sides->middle_before()) - corner) < 0;
  }
  if (core.settings.one_sided_meshes) {
    // Fronts are where corners run counter-clockwise.
    const bool behind = normal.dot(front) < 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (plane_of_[i] == number && (across_[i].dot(across_[plane.seed]) < 0) != behind) return false;
    }
  }

  // 2. The body on it.
  HalfspaceContact found;
  const auto threshold = static_cast<double>(question.threshold);
  const bool part = is_part(body.wrapper);
  const auto stand = [&] {
    const Halfspace3 ground{normal, normal.dot(corner) + margin};
    const GroundQuestion asked{.body = shape,
                               .pose = body_pose,
                               .ground = ground,
                               .stamp = question.stamp,
                               .shape = body.known,
                               .threshold = threshold,
                               .sharp_box = part};
    return core.stand_on(asked, buffers, found) == SolverCore::Outcome::answered;
  };
  if (!stand()) return false;
  if (came_over && found.manifold.count > 0) return false;
  if (found.manifold.count > 0 && -found.lower > kShallow * (found.highest - found.lower)) {
    // Children that a sheet cuts leave it where the whole is, or some would push one way and some the other for good.
    if (!part || known || core.settings.one_sided_meshes) return false;
    turn_to(to_pd(question.a.getWorldTransform().getOrigin()));
    if (!stand() || -found.lower - margin > (1 - kShallow) * (found.highest - found.lower)) return false;
  }
  plane.points = found.manifold;
  plane.front = mesh_pose.rotation().transpose() * normal;
  if (found.manifold.count == 0) return true;
  const PosedShape posed{(part && body.known->sharp ? body.known->sharp : body.known->body).get(), to_pd(body_pose)};
  if (is_piece(body.wrapper)) {
    AskedPieces pieces = question.of_pieces(body.wrapper, question.b, core, buffers);
    count_covered(drop_covered(pieces.as(posed, posed), plane.points), buffers);
  }

  // 3. What is under its points.
  const double slack = seam_slack(bounding_radius(*posed.shape),
                                  std::max(farthest_, to_pd(body_pose.getOrigin()).cwiseAbs().maxCoeff()));
  for (int k = 0; k < plane.points.count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Vec3 foot = mesh_pose.rotation().transpose() *
                      (plane.points.points[at].position_b - margin * normal - mesh_pose.translation());
    std::size_t under = 0;
    while (under < triangles.size() &&
           (plane_of_[under] != number || !holds(triangles[under], across_[under], foot, slack))) {
      ++under;
    }
    if (under == triangles.size()) return false;
    plane.triangles[at] = static_cast<int>(under);
  }
  return true;
}

bool FlatGround::find(const Body& body, const UnionQuestion& question, std::span<const MetTriangle> triangles,
                      std::size_t first, SolverCore& core, ThreadBuffers& buffers, Patches& patches) {
  if (!sort_by_plane(triangles)) return false;
  // Planes of one triangle each are asked as triangles, which do not have to be asked again where a point lies aside.
  if (planes_.size() > 1 && planes_.size() == triangles.size()) return false;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    if (!ask(body, question, triangles, core, buffers, planes_[p], static_cast<int>(p))) return false;
  }
  const int child = is_part(body.wrapper) ? body.wrapper.m_index : -1;
  for (std::size_t i = 0; i < triangles.size() && body.sides != nullptr; ++i) {
    const Plane& plane = planes_[static_cast<std::size_t>(plane_of_[i])];
    if (plane.points.count == 0) continue;
    body.sides->keep(number_of_pieces(child, triangles[i]), plane.front, to_pd(triangles[i].corners[0]));
  }
  for (const Plane& plane : planes_) {
    for (int k = 0; k < plane.points.count; ++k) {
      ContactManifold point = plane.points;
      point.points[0] = plane.points.points[static_cast<std::size_t>(k)];
      point.count = 1;
      // Features are the body's alone, and go on from triangle to triangle.
      patches.add(point, static_cast<int>(first) + plane.triangles[static_cast<std::size_t>(k)], child, -1);
    }
  }
  return true;
}

}  // namespace pd::detail
