#include "pd/contact/box_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "contact/box_faces.hpp"
#include "contact/manifold_reduce.hpp"
#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/facets/gauss_boxes.hpp"
#include "depth/pair/double_answer.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd {

namespace {

using detail::BoxCorners;
using detail::BoxDistance;
using detail::FootPoints;
using detail::IdKind;
using detail::make_id;
using detail::Vec2;

/// The norm of half extents rounds.
constexpr double kRounded = 1 + 0x1p-50;

/// A contact point to be, on B's face.
struct Candidate {
  Vec3 place;
  double depth;
  std::int64_t id;
};

double norm_of(const double (&v)[4]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Both boxes, about the centre of A.
struct BoxPairInRows : detail::PosedBoxes {
  const Vec3& origin;  ///< the centre of A

  BoxPairInRows(const BoxInRows& box_a, const BoxInRows& box_b)
      : PosedBoxes{rows_of(box_a), rows_of(box_b), {}, 0}, origin(box_a.centre) {
    const Vec3 way = box_b.centre - box_a.centre;
    for (int i = 0; i < 3; ++i) centre[i] = way[i];
    reach = norm_of(a.half_extents) * kRounded + norm_of(b.half_extents) * kRounded + way.norm();
  }

  [[nodiscard]] bool in_range() const {
    return reach > 0x1p-100 && reach < 0x1p100 && least(a) > 0x1p-100 && least(b) > 0x1p-100;
  }

  /// How wide the bracket may be.
  [[nodiscard]] double limit(double tolerance) const {
    // A coordinate is at most |c| and, of either box, sqrt(3) times the norm of its half extents.
    if (tolerance >= 2 * detail::kCertifiedWidth * reach) return tolerance;
    return detail::BracketWidth{detail::kCertifiedWidth, tolerance}.limit(greatest_coordinate());
  }

 private:
  static detail::BoxRows rows_of(const BoxInRows& box) { return {box.x, box.y, box.z, box.half_extents}; }
  static double least(const detail::BoxRows& box) {
    return std::min({box.half_extents[0], box.half_extents[1], box.half_extents[2]});
  }
};

Vec3 vector_of(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

void take_all(const BoxPairInRows& boxes, const BoxCorners& corners, const double (&n)[3], ContactManifold& manifold) {
  const double origin[3] = {boxes.origin.x(), boxes.origin.y(), boxes.origin.z()};
  double points[4][8];
  points_at_corners(corners, n, origin, points);
  manifold.count = corners.count;
  for (int i = 0; i < corners.count; ++i) {
    const double* const from = points[i];
    ContactPoint& point = manifold.points[static_cast<std::size_t>(i)];
    point.position_a = Vec3(from[0], from[1], from[2]);
    point.position_b = Vec3(from[3], from[4], from[5]);
    point.depth = from[6];
    point.feature_id = detail::feature_id(corners.kind[i]);
  }
}

/// @param witness  joins the corners where they are not as deep as the boxes, else nullptr.
void keep_four(const BoxPairInRows& boxes, const BoxCorners& corners, const FootPoints* witness, double signed_depth,
               double noise, ContactManifold& manifold) {
  const Vec3& n = manifold.normal;
  const Vec3 centre = vector_of(corners.centre), first = vector_of(corners.first), second = vector_of(corners.second);
  Candidate candidates[detail::kMostBoxCorners + 1];
  int count = corners.count;
  for (int i = 0; i < count; ++i) {
    candidates[i] = {centre + corners.s[i] * first + corners.t[i] * second, corners.depth[i],
                     detail::feature_id(corners.kind[i])};
  }
  if (witness) candidates[count++] = {witness->point_b, signed_depth, make_id(IdKind::witness, 0, 0)};
  if (count > 4) {
    const detail::ContactFrame frame(n, centre);
    Vec2 flat[detail::kMostBoxCorners + 1];
    for (int i = 0; i < count; ++i) flat[i] = frame.flatten(candidates[i].place);
    const std::span<Candidate> points(candidates, static_cast<std::size_t>(count));
    const std::span<Vec2> places(flat, static_cast<std::size_t>(count));
    const std::size_t chosen =
        witness ? static_cast<std::size_t>(corners.count)
                : detail::deepest_point(std::span<const Candidate>(points), places, corners.deepest, noise);
    detail::reduce_to_four(points, places, chosen);
    count = 4;
  }
  manifold.count = count;
  const Vec3& origin = boxes.origin;
  for (int i = 0; i < count; ++i) {
    const Candidate& c = candidates[i];
    const Vec3 on_b = c.place + origin;
    manifold.points[static_cast<std::size_t>(i)] = {on_b - c.depth * n, on_b, c.depth, c.id};
  }
}

void solve(const BoxInRows& a, const BoxInRows& b, double tolerance, double breaking_threshold, BoxWitness witness,
           BoxContact& out) {
  const BoxPairInRows boxes(a, b);
  if (!boxes.in_range()) return;
  const BoxDistance found = detail::distance_of_boxes(boxes);
  const double slack = boxes.slack();
  out.manifold.normal = found.normal.array() + 0.0;  // no negative zeros
  out.lower = -found.height - found.rounding;
  if (out.lower > breaking_threshold) {
    out.answered = true;
    out.upper = boxes.reach + slack;  // two centres are points of the boxes
    return;
  }
  const double limit = boxes.limit(tolerance);
  if (found.depth > 0 && out.lower < -found.depth - limit) return;
  // 0 at the deepest where the class is in doubt.
  const double signed_depth = found.depth > 0 ? -out.lower : out.lower > 0 ? found.height : 0;
  const double n[3] = {found.normal.x(), found.normal.y(), found.normal.z()};
  BoxCorners corners;
  detail::box_corners(a, b, boxes.centre, n, signed_depth, breaking_threshold, corners);
  const double noise = std::max(detail::kNoiseRatio * breaking_threshold, detail::kMergeRatio * corners.size);
  const bool reached = corners.count > 0 && corners.deepest >= signed_depth - noise;
  // A corner shows how near the boxes are at most; where none is near enough, the foot of the origin does.
  double missed = signed_depth - corners.deepest;
  FootPoints at;
  if (!reached || (found.depth <= 0 && missed > limit) || witness == BoxWitness::placed) {
    at = foot_of_boxes(boxes, Vec3::Zero(), found, 0.125 * limit);
    if (!reached || at.missed < missed) missed = at.missed;
    out.witness_a = at.point_a + a.centre;
    out.witness_b = at.point_b + a.centre;
  }
  if (found.depth > 0) {
    out.upper = -found.depth;
    out.answered = reached || missed <= std::max(limit, slack);
  } else {
    out.upper = std::abs(found.height) + missed + slack;
    out.answered = out.upper - out.lower <= limit;
  }
  out.contact = out.lower > 0   ? ContactClass::separated
                : out.upper < 0 ? ContactClass::overlapping
                                : ContactClass::touching;
  if (!out.answered) return;
  if (reached && corners.count <= 4) {
    take_all(boxes, corners, n, out.manifold);
  } else {
    keep_four(boxes, corners, reached ? nullptr : &at, signed_depth, noise, out.manifold);
  }
}

}  // namespace

BoxInRows in_rows(const PosedBox& box) {
  const Mat3& rotation = box.pose->rotation();
  BoxInRows out;
  for (int k = 0; k < 3; ++k) {
    out.x[k] = rotation(0, k);
    out.y[k] = rotation(1, k);
    out.z[k] = rotation(2, k);
    out.half_extents[k] = box.half_extents[k];
  }
  out.x[3] = out.y[3] = out.z[3] = out.half_extents[3] = 0;
  out.centre = box.pose->translation();
  return out;
}

BoxContact box_contact(const PosedBox& a, const PosedBox& b, double tolerance, double breaking_threshold,
                       BoxWitness witness) {
  return box_contact(in_rows(a), in_rows(b), tolerance, breaking_threshold, witness);
}

BoxContact box_contact(const BoxInRows& a, const BoxInRows& b, double tolerance, double breaking_threshold,
                       BoxWitness witness) {
  const detail::FloatingPointGuard guard;
  BoxContact out;
  solve(a, b, tolerance, breaking_threshold, witness, out);
  return out;
}

PenetrationDepth depth_of(const BoxContact& contact) {
  PenetrationDepth out;
  out.method = Method::overlay;
  out.normal = contact.manifold.normal;
  out.witness_a = contact.witness_a;
  out.witness_b = contact.witness_b;
  detail::set_signed_distance(0, contact.lower, contact.upper, out);
  return out;
}

}  // namespace pd
