#include "pd/union_contact/flat_ground.hpp"

#include <algorithm>
#include <cmath>

#include "pd/contact/time_of_impact.hpp"
#include "pd/union_contact/straddled.hpp"
#include "pd/union_contact/union_piece.hpp"
#include "union_contact/column.hpp"

namespace pd {

namespace {

using Corners = std::array<Vec3, 3>;

/// If the sine of two normals is larger, they belong to two planes.
constexpr double kTurned = 1e-3;

/// True if a point of the triangle's plane lies in the triangle, whose sides are moved out by `slack`.
bool holds(const Corners& corners, const Vec3& across, const Vec3& point, double slack) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 outward = (corners[(i + 1) % 3] - corners[i]).cross(across);
    const double height = outward.dot(point - corners[i]);
    if (height > 0 && height * height > slack * slack * outward.squaredNorm()) return false;
  }
  return true;
}

/// True if four of the triangles are in four planes for certain. If the ground is uneven, the first few tell.
bool are_of_many_planes(std::span<const Corners> triangles, const std::vector<Vec3>& across, double rounding) {
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
    const Corners& at = triangles[i];
    const double longest =
        std::max({(at[1] - at[0]).squaredNorm(), (at[2] - at[1]).squaredNorm(), (at[0] - at[2]).squaredNorm()});
    // The triangle is so narrow that rounding of its corners may turn it.
    if (kTurned * kTurned * squared <= 64 * rounding * rounding * longest) continue;
    if (count == found.size()) return true;
    found[count++] = &n;
  }
  return false;
}

}  // namespace

bool FlatGround::sort_by_plane(const GroundTriangles& ground) {
  const std::span<const Corners> triangles = ground.corners;
  across_.clear();
  farthest_ = 0;
  for (const Corners& corners : triangles) {
    across_.push_back((corners[1] - corners[0]).cross(corners[2] - corners[0]));
    for (const Vec3& corner : corners) farthest_ = std::max(farthest_, corner.cwiseAbs().maxCoeff());
  }
  const double rounding = ground.corner_rounding * farthest_;
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
    const double offset = normal.dot(triangles[seed][0]);
    const int number = static_cast<int>(planes_.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (plane_of_[i] >= 0) continue;
      const Corners& corners = triangles[i];
      const bool flat = std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
        return std::abs(normal.dot(corner) - offset) <= rounding;
      });
      if (!flat && i != seed) continue;
      plane_of_[i] = number;
      --left;
    }
    planes_.emplace_back().seed = seed;
  }
  return true;
}

Vec3 FlatGround::known_front(const StandingBody& body, std::size_t num_triangles, int number) const {
  const Vec3 normal = across_[planes_[static_cast<std::size_t>(number)].seed].normalized();
  for (std::size_t i = 0; i < num_triangles; ++i) {
    if (plane_of_[i] != number) continue;
    const Vec3 front = body.side_of(i, normal);
    if (!front.isZero()) return front;
  }
  return Vec3::Zero();
}

bool FlatGround::ask(StandingBody& body, const GroundPlace& place, const GroundTriangles& ground, int number) {
  Plane& plane = planes_[static_cast<std::size_t>(number)];
  const std::size_t count = ground.corners.size();

  // 1. The plane is put into the world, its normal to the side where the body is.
  const Corners& local = ground.corners[plane.seed];
  const Vec3 corner = ground.mesh.apply(local[0]);
  Vec3 normal = (ground.mesh.apply(local[1]) - corner).cross(ground.mesh.apply(local[2]) - corner).normalized();
  const auto turn_to = [&](const Vec3& to) {
    if (normal.dot(to - corner) < 0) normal = -normal;
  };
  const Vec3 front = normal;
  turn_to(place.origin);
  bool known = false;      // on which side the body belongs
  bool came_over = false;  // its middle was on the other side in the last step
  if (body.remembers_sides()) {
    const Vec3 before = ground.mesh.rotation() * known_front(body, count, number);
    known = !before.isZero();
    if (known && normal.dot(before) < 0) normal = -normal;
    came_over = !known && normal.dot(ground.mesh.apply(body.middle_before()) - corner) < 0;
  }
  if (ground.one_sided) {
    const bool behind = normal.dot(front) < 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (plane_of_[i] == number && (across_[i].dot(across_[plane.seed]) < 0) != behind) return false;
    }
  }

  // 2. The body is put on the plane.
  if (came_over) return false;
  HalfspaceContact found;
  const auto stand = [&] { return body.stand_on({normal, normal.dot(corner) + ground.margin}, found); };
  if (!stand()) return false;
  if (found.manifold.count > 0 && -found.lower > kShallow * (found.highest - found.lower)) {
    // Parts that a sheet cuts leave it on the side of the whole. Else some would push one way and some the other.
    if (!place.is_part || known || ground.one_sided) return false;
    turn_to(place.origin_of_whole);
    if (!stand() || -found.lower - ground.margin > (1 - kShallow) * (found.highest - found.lower)) return false;
  }
  if (!ground.one_sided && !comes_through(body.posed(), found, ground, number)) return false;
  plane.points = found.manifold;
  plane.front = ground.mesh.rotation().transpose() * normal;
  if (found.manifold.count == 0) return true;
  body.drop_covered(plane.points);
  if (plane.points.count == 0 && place.is_part && !ground.one_sided) {
    // A part that others cover on its own side leaves on the side of the whole.
    const Vec3 side = side_towards(place.origin_of_whole, front, corner);
    if (normal.dot(side) < 0) {
      normal = side;
      if (!stand()) return false;
      plane.points = found.manifold;
      plane.front = ground.mesh.rotation().transpose() * normal;
      body.drop_covered(plane.points);
    }
  }
  return find_under(body.posed(), normal, ground, number);
}

bool FlatGround::lies_over(const Vec3& place, const GroundTriangles& ground, int number, double slack) const {
  for (std::size_t i = 0; i < ground.corners.size(); ++i) {
    if (plane_of_[i] == number && holds(ground.corners[i], across_[i], place, slack)) return true;
  }
  return false;
}

bool FlatGround::comes_through(const PosedShape& body, const HalfspaceContact& found, const GroundTriangles& ground,
                               int number) const {
  const ContactManifold& points = found.manifold;
  const auto begin = points.points.begin();
  const auto deepest = std::max_element(begin, begin + points.count,
                                        [](const ContactPoint& x, const ContactPoint& y) { return x.depth < y.depth; });
  if (deepest == begin + points.count || deepest->depth <= detail::kLookedAt * (found.highest - found.lower))
    return true;
  const double depth = deepest->depth - ground.margin;
  if (detail::reaches_back(body, deepest->position_a, points.normal, depth)) return true;
  // The body may also pass the plane aslant, on the way from there to its middle.
  const Vec3 way = detail::middle_of(body) - deepest->position_a;
  const double height = points.normal.dot(way);
  if (height <= depth) return false;
  const Vec3 place = deepest->position_a + depth / height * way;
  return lies_over(ground.mesh.rotation().transpose() * (place - ground.mesh.translation()), ground, number, 0);
}

bool FlatGround::find_under(const PosedShape& body, const Vec3& normal, const GroundTriangles& ground, int number) {
  Plane& plane = planes_[static_cast<std::size_t>(number)];
  const std::size_t count = ground.corners.size();
  const double slack =
      seam_slack(bounding_radius(*body.shape), std::max(farthest_, body.pose.translation().cwiseAbs().maxCoeff()),
                 ground.pose_rounding);
  for (std::size_t k = 0; k < static_cast<std::size_t>(plane.points.count); ++k) {
    const Vec3 foot = ground.mesh.rotation().transpose() *
                      (plane.points.points[k].position_b - ground.margin * normal - ground.mesh.translation());
    std::size_t under = 0;
    while (under < count &&
           (plane_of_[under] != number || !holds(ground.corners[under], across_[under], foot, slack))) {
      ++under;
    }
    if (under == count) return false;
    plane.triangles[k] = under;
  }
  return true;
}

bool FlatGround::find(StandingBody& body, const GroundPlace& place, const GroundTriangles& ground) {
  if (!sort_by_plane(ground)) return false;
  // Planes of one triangle each are asked as triangles, which do not have to be asked again where a point lies aside.
  const std::size_t count = ground.corners.size();
  if (planes_.size() > 1 && planes_.size() == count) return false;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    if (!ask(body, place, ground, static_cast<int>(p))) return false;
  }
  for (std::size_t i = 0; i < count && body.remembers_sides(); ++i) {
    const Plane& plane = planes_[static_cast<std::size_t>(plane_of_[i])];
    if (plane.points.count > 0) body.keep_side(i, plane.front);
  }
  return true;
}

}  // namespace pd
