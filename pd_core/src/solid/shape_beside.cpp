#include "solid/shape_beside.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "depth/difference/smooth_difference.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "shape/core_radius.hpp"
#include "solid/winding.hpp"

namespace pd::detail {

namespace {

/// A point of a core's interior, or of a flat core, which a margin makes one of the body's.
Vec3 inner_point(const ConvexShape::Core& core) {
  if (const auto* const polytope = std::get_if<ConvexPolytope>(&core)) return polytope->vertex(0);
  if (const auto* const spheres = std::get_if<SphereHull>(&core)) return largest_sphere(*spheres).centre;
  return Vec3::Zero();
}

Expected<MeshSolid> solid_of_points(std::span<const Vec3> points) {
  const Expected<ConvexPolytope> hull = ConvexPolytope::from_points(points);
  if (!hull) return hull.error();
  return MeshSolid::from_polytope(*hull);
}

ConvexShape point_shape() {
  const std::array<Vec3, 1> origin{Vec3::Zero()};
  return *ConvexPolytope::from_points(origin);
}

}  // namespace

Expected<std::unique_ptr<ShapeBeside>> ShapeBeside::place(const PosedSolid& a, const PosedShape& b, Scratch& scratch) {
  std::unique_ptr<ShapeBeside> out(new ShapeBeside(a, b, scratch));
  if (auto refused = out->arrange()) return *std::move(refused);
  return out;
}

std::optional<Error> ShapeBeside::arrange() {
  const ConvexShape& shape = *b_.shape;
  const Vec3 apart = b_.pose.translation() - a_.pose.translation();
  if (!(apart.cwiseAbs().maxCoeff() <= kMaxCoordinate)) {
    return Error{ErrorCode::out_of_range, "the poses lie farther apart than numbers reach", "pose_b"};
  }
  near_b_ = placed_at(b_.pose, apart);
  inner_ = inner_point(shape.core());
  std::vector<Vec3> corners;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (int k = 0; k < 3; ++k) {
      const double side = (corner >> k & 1) != 0 ? 1 : -1;
      at[k] = support_point(shape.core(), side * Vec3::Unit(k))[k] + side * shape.margin();
    }
    corners.push_back(at.cwiseMin(kMaxCoordinate).cwiseMax(-kMaxCoordinate));
  }
  Expected<MeshSolid> box = solid_of_points(corners);
  if (!box) return box.error();
  box_ = *std::move(box);
  const double size = (corners.back() - corners.front()).maxCoeff() * 0.5;
  const double step = inner_.maxCoeff() > 0 ? -size : size;
  const std::array<Vec3, 4> tetrahedron{inner_, inner_ + step * Vec3::UnitX(), inner_ + step * Vec3::UnitY(),
                                        inner_ + step * Vec3::UnitZ()};
  Expected<MeshSolid> corner = solid_of_points(tetrahedron);
  if (!corner) return corner.error();
  corner_ = *std::move(corner);
  const auto& vertices = corner_->vertices();
  corner_vertex_ = static_cast<std::int32_t>(std::find(vertices.begin(), vertices.end(), inner_) - vertices.begin());
  solids_.emplace(*a_.solid, a_.pose, *box_, b_.pose);
  // Lengths outside are whole multiples of the least double, and a sum of a few of them is rounded to one.
  slack_ = std::ldexp(16 * solids_->error(), solids_->scale_exponent()) + 4 * std::numeric_limits<double>::denorm_min();
  return std::nullopt;
}

PenetrationDepth ShapeBeside::answer_at(const Vec3& x, double beyond) {
  static const ConvexShape kPoint = point_shape();
  const Vec3 at = std::ldexp(1.0, solids_->scale_exponent()) * x;
  const Pose pose = Pose::from_trusted_matrix(Mat3::Identity(), at);
  return penetration_depth({&kPoint, pose}, {b_.shape, near_b_}, scratch_,
                           {.bracket = Bracket::certified, .beyond = beyond});
}

double ShapeBeside::gap(std::int32_t at, const Vec3& way, double beyond) {
  const TriangleBox box = solids_->box(Body::a, node(at));
  const double scale = std::ldexp(1.0, solids_->scale_exponent());
  const double radius = 0.5 * scale * (box.high - box.low).norm() * (1 + 0x1p-48) + slack_;
  const PenetrationDepth answer = answer_at(0.5 * (box.low + box.high) + way / scale, beyond + radius);
  return answer.contact == ContactClass::separated ? answer.distance_lower - radius : -radius;
}

ShapeBeside::Found ShapeBeside::meet(const Pose& pose_a, const Vec3& way, double beyond) {
  Found found;
  nearest_ = beyond;
  found.distance_lower = HUGE_VAL;
  const double first = gap(0, way, beyond);
  visit(0, first, pose_a, way, found);
  found.distance_lower = std::min(found.distance_lower, nearest_);
  if (found.contact != ContactClass::overlapping && first <= 0 && lies_inside(way)) {
    found.contact = ContactClass::overlapping;
    found.triangle = -1;
  }
  return found;
}

void ShapeBeside::visit(std::int32_t at, double least, const Pose& pose_a, const Vec3& way, Found& found) {
  if (least > nearest_ || found.contact == ContactClass::overlapping) return;
  const TriangleNode& here = node(at);
  if (here.is_leaf()) {
    for (std::int32_t t = here.first; t < here.last; ++t) test(t, pose_a, found);
    return;
  }
  const double left = gap(here.left, way, nearest_), right = gap(here.right, way, nearest_);
  if (left <= right) {
    visit(here.left, left, pose_a, way, found);
    visit(here.right, right, pose_a, way, found);
  } else {
    visit(here.right, right, pose_a, way, found);
    visit(here.left, left, pose_a, way, found);
  }
}

void ShapeBeside::test(std::int32_t triangle, const Pose& pose_a, Found& found) {
  if (found.contact == ContactClass::overlapping) return;
  ++found.triangles;
  const auto& v = a_.solid->triangle(triangle).vertices;
  const std::array<Vec3, 3> points{a_.solid->vertex(v[0]), a_.solid->vertex(v[1]), a_.solid->vertex(v[2])};
  const ConvexShape corners = *ConvexPolytope::from_points(points);
  const PenetrationDepth answer =
      penetration_depth({&corners, pose_a}, b_, scratch_, {.bracket = Bracket::tightest, .beyond = nearest_});
  const bool separated = answer.contact == ContactClass::separated;
  if (separated && answer.distance_lower > nearest_) return;
  if (separated) found.distance_lower = std::min(found.distance_lower, answer.distance_lower);
  if (found.triangle >= 0 && separated && !(answer.distance_upper < nearest_)) return;
  nearest_ = separated ? std::min(nearest_, answer.distance_upper) : 0;
  found.contact = answer.contact;
  found.triangle = triangle;
  found.answer = answer;
}

bool ShapeBeside::lies_inside(const Vec3& way) const {
  const PosedSolids exact(*a_.solid, a_.pose, *corner_, b_.pose, way);
  const PointPlace place = place_in(exact, Body::a, exact.point(Body::b, corner_vertex_));
  return place.on_surface || place.winding > 0;
}

SurfaceDepth ShapeBeside::depth_at(const Vec3& x) {
  const PenetrationDepth answer = answer_at(x, HUGE_VAL);
  const double outside = answer.contact == ContactClass::overlapping ? answer.lower : -answer.distance_upper;
  return {std::ldexp(outside - slack_, -solids_->scale_exponent()), -answer.normal};
}

SurfaceDepth ShapeBeside::depth_at(const Vec3& x, const SurfaceDepth& /*near*/, double /*moved*/) {
  return depth_at(x);
}

std::vector<Vec3> ShapeBeside::landmarks() const { return {solids_->inside(near_b_.apply(inner_))}; }

StandingBody::Meeting ShapeBeside::meeting_after(const Vec3& way) {
  const Vec3 translation = a_.pose.translation() + way;
  // The sum is rounded, and so are the triangles that stand there.
  const double rounding = slack_ + 8 * kUnitRoundoff * (a_.pose.translation().norm() + way.norm());
  const Found found = meet(placed_at(a_.pose, translation), way, rounding);
  Meeting out{.contact = found.contact, .points = 1 + found.triangles};
  if (found.triangle < 0) return out;
  if (found.contact == ContactClass::separated) out.contact = ContactClass::touching;
  for (const PosedPoint& p : solids_->corners(Body::a, found.triangle)) out.corners_a.push_back(p.x);
  out.corners_b.push_back(solids_->inside(found.answer.witness_b - a_.pose.translation()));
  return out;
}

}  // namespace pd::detail
