#include "union/sheet_sides.hpp"

#include <algorithm>
#include <cmath>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// cos 25 degrees: triangles of nearly one direction, and answers that lead off a triangle by its sides.
constexpr double kOfOneWay = 0.9;
/// cos 60 degrees: an answer that leads off a triangle by one of its edges, whose other side may be next.
constexpr double kOverEdge = 0.5;
/// Of the way that a body comes in a step at its speed: who has come farther was put there by the host.
constexpr double kPutThere = 3;
/// A triangle that is met farther off a plane than this many reaches of contacts is not beside it.
constexpr double kBeside = 4;

/// True if a way leads from one side of a triangle's plane to the other.
bool crosses_plane(const Vec3& from, const Vec3& to, const Vec3& normal, const btVector3* corners) {
  const Vec3 corner = to_pd(corners[0]);
  return normal.dot(from - corner) * normal.dot(to - corner) < 0;
}

/// True if a place lies over or under a triangle, seen along its normal.
bool is_over(const Vec3& place, const Vec3& normal, const btVector3* corners) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 begin = to_pd(corners[i]), end = to_pd(corners[i < 2 ? i + 1 : 0]);
    if ((end - begin).cross(place - begin).dot(normal) < 0) return false;
  }
  return true;
}

/// True if a way leads from one side of a triangle's plane to the other through the triangle.
bool leads_through(const Vec3& from, const Vec3& to, const Vec3& normal, const btVector3* corners) {
  if (!crosses_plane(from, to, normal, corners)) return false;
  const Vec3 corner = to_pd(corners[0]);
  const double before = normal.dot(from - corner), after = normal.dot(to - corner);
  return is_over(from + before / (before - after) * (to - from), normal, corners);
}

/// True if a way that crosses a triangle's plane leads through it or through a triangle of nearly its direction. A body
/// that comes aslant has come through the triangle beside the one that is the nearest now.
bool leads_through_one(const Vec3& from, const Vec3& to, const Vec3& normal, const SheetSides::Around& around) {
  const Vec3 rounding = Vec3::Constant(kPoseRounding * (from.norm() + to.norm()));
  const btVector3 lower = to_bullet(Vec3(from.cwiseMin(to) - rounding));
  const btVector3 upper = to_bullet(Vec3(from.cwiseMax(to) + rounding));
  bool found = false;
  around.read.for_each_in(lower, upper, [&](std::size_t i) {
    if (found || !std::binary_search(around.places.begin(), around.places.end(), i)) return;
    const MeshTriangle& triangle = around.read.triangles()[i];
    const Vec3 own = triangle.across.normalized();
    found = std::abs(own.dot(normal)) > kOfOneWay && leads_through(from, to, own, triangle.corners);
  });
  return found;
}

}  // namespace

void SheetSides::begin(const SheetMemory& memory) {
  memory_ = &memory;
  fresh_.clear();
  poses_.clear();
  behind_ = 0;
}

void SheetSides::enter(int child, const btTransform& pose, const Pose& mesh, const Vec3& middle, double way,
                       double reach) {
  first_of_child_ = fresh_.size();
  child_ = child;
  mesh_ = mesh;
  reach_ = reach;
  pose_ = last_pose_ = pose;
  poses_.push_back({child, pose});
  const auto last = std::find_if(memory_->poses.begin(), memory_->poses.end(),
                                 [&](const SheetMemory::LastPose& other) { return other.child == child; });
  known_ = last != memory_->poses.end();
  if (known_) last_pose_ = last->pose;
  const Vec3 now = mesh_.rotation().transpose() * (middle - mesh_.translation());
  before_ = before(middle);
  if ((now - before_).norm() > kPutThere * way + reach) {
    known_ = false;
    last_pose_ = pose;
    before_ = now;
  }
  looked_around_ = false;
  fast_ = known_ && (way > reach || memory_->behind > 0);
}

Vec3 SheetSides::before(const Vec3& place) const {
  const Vec3 local = mesh_.rotation().transpose() * (place - mesh_.translation());
  return known_ ? to_pd(last_pose_ * pose_.invXform(to_bullet(local))) : local;
}

Vec3 SheetSides::beside(std::span<const KnownFront> fronts, const Vec3& normal, const Vec3& place) const {
  Vec3 best = Vec3::Zero();
  double most = kOfOneWay;
  for (const KnownFront& known : fronts) {
    const double cosine = known.front.dot(normal);
    if (std::abs(cosine) <= most || std::abs(known.front.dot(place) - known.level) > kBeside * reach_) continue;
    most = std::abs(cosine);
    best = cosine > 0 ? normal : Vec3(-normal);
  }
  return best;
}

Vec3 SheetSides::front_of(std::uint64_t triangle, const Vec3& normal) const {
  if (!known_) return Vec3::Zero();
  const std::vector<KnownFront>& old = memory_->fronts;
  const auto found = std::lower_bound(old.begin(), old.end(), triangle,
                                      [](const KnownFront& x, std::uint64_t n) { return x.triangle < n; });
  if (found == old.end() || found->triangle != triangle) return Vec3::Zero();
  const double cosine = found->front.dot(normal);
  if (std::abs(cosine) <= kOfOneWay) return Vec3::Zero();
  return cosine > 0 ? normal : Vec3(-normal);
}

bool SheetSides::was_behind_one(const Vec3& side, std::span<const MetTriangle> met) {
  if (!looked_around_) {
    looked_around_ = true;
    towards_middle_.clear();
    for (const MetTriangle& triangle : met) {
      const Vec3 corner = to_pd(triangle.corners[0]);
      const Vec3 own = (to_pd(triangle.corners[1]) - corner).cross(to_pd(triangle.corners[2]) - corner).normalized();
      if (!is_over(before_, own, triangle.corners)) continue;
      towards_middle_.push_back(own.dot(before_ - corner) < 0 ? Vec3(-own) : own);
    }
  }
  return std::any_of(towards_middle_.begin(), towards_middle_.end(),
                     [&](const Vec3& front) { return front.dot(side) < -kOfOneWay; });
}

Vec3 SheetSides::judge(const MetTriangle& met, const Vec3& normal, const Around& around, const PairAnswer& answer) {
  const std::uint64_t triangle = number_of_pieces(child_, met);
  const Vec3 corner = to_pd(met.corners[0]);
  const bool overlapping = answer.depth.contact == ContactClass::overlapping;
  const bool within = answer.depth.signed_distance() <= reach_;
  const double cosine = (mesh_.rotation() * normal).dot(answer.depth.normal);
  front_ = Vec3::Zero();
  if (std::abs(cosine) < kOverEdge || (!within && !fast_)) return Vec3::Zero();
  const bool aligned = std::abs(cosine) > kOfOneWay;
  const Vec3 side = cosine > 0 ? normal : Vec3(-normal);
  Vec3 front = front_of(triangle, normal);
  const bool was_over = !front.isZero();
  bool sure = true, came_through = false;
  if (!was_over && known_ && (overlapping || fast_)) {
    const Vec3 came = before(answer.depth.witness_a);
    const auto in_mesh = [&](const Vec3& place) -> Vec3 {
      return mesh_.rotation().transpose() * (place - mesh_.translation());
    };
    const Vec3 now = in_mesh(answer.depth.witness_a);
    // On the triangle, where the body is nearest: a large neighbour may be far off elsewhere.
    const Vec3 met_at = in_mesh(answer.depth.witness_b);
    const Vec3 place = met_at - normal.dot(met_at - corner) * normal;
    const bool comes_through = side.dot(now - came) > 0;
    const bool crossed = !overlapping && crosses_plane(came, now, normal, met.corners);
    if (overlapping || crossed) {
      front = beside(std::span(fresh_).subspan(first_of_child_), normal, place);
      if (front.isZero() && (comes_through || memory_->behind > 0)) front = beside(memory_->fronts, normal, place);
    }
    if (front.isZero() && overlapping && comes_through && side.dot(before_ - corner) < 0 &&
        was_behind_one(side, around.met)) {
      front = -side;
    }
    if (crossed) {
      // A body that crossed the plane where no triangle is known came through a triangle or around a rim. One whose
      // middle was ahead of the plane already did not come: it was in the triangle by a little, and was pushed out.
      came_through = side.dot(before_ - corner) < 0 && leads_through_one(came, now, normal, around);
      sure = came_through || !front.isZero();
      if (came_through && front.isZero()) front = -side;
    }
  }
  const bool through = front.dot(side) < 0 && (overlapping || aligned || came_through);
  front_ = mesh_.rotation() * (front.isZero() ? side : front);
  if (!through && !within) return Vec3::Zero();
  if (through) {
    keep(triangle, front, corner);
    return front_;
  }
  if (sure && (aligned || was_over)) keep(triangle, side, corner);
  return Vec3::Zero();
}

void SheetSides::end(SheetMemory& memory) {
  const auto earlier = [](const KnownFront& x, const KnownFront& y) { return x.triangle < y.triangle; };
  if (!std::is_sorted(fresh_.begin(), fresh_.end(), earlier)) std::stable_sort(fresh_.begin(), fresh_.end(), earlier);
  memory.fronts.swap(fresh_);
  memory.poses.swap(poses_);
  memory.behind = behind_;
}

}  // namespace pd::detail
