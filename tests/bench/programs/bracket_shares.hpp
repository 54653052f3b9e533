/// @file
/// How much of their brackets closed forms need: the true depth or distance of posed bodies in numbers of any length,
/// as the share of half the bracket's width by which it lies off the bracket's middle. For `bound_ratios`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "bench/programs/real.hpp"
#include "depth/facets/gauss_sat_boxes.hpp"
#include "depth/features/nearest_of_segments.hpp"
#include "depth/pair/slender_near_box.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/hull/affine_frame.hpp"
#include "shape/hull/hull_points.hpp"
#include "shape/hull/quickhull.hpp"

namespace pd::bench {

/// Of a bracket as wide as asked: the widest is enough.
inline constexpr detail::BracketWidth kAnyWidth{1, 0};

inline double share_of_bracket(const Real& truth, double lower, double upper) {
  if (!(upper > lower)) return truth == lower ? 0 : HUGE_VAL;
  return static_cast<double>(abs(2 * truth - lower - upper) / (Real(upper) - lower));
}

/// A body's pose by seven numbers: a quaternion, whose length is brought to 1, and a translation.
inline std::optional<Pose> pose_of(const Numbers& x, std::size_t first) {
  const Eigen::Vector4d q = Eigen::Vector4d(x[first], x[first + 1], x[first + 2], x[first + 3]).normalized();
  const auto pose = Pose::from_quaternion({q[0], q[1], q[2], q[3]}, {x[first + 4], x[first + 5], x[first + 6]});
  return pose ? std::optional<Pose>(*pose) : std::nullopt;
}

/// The rotation that the pose's quaternion stands for, unrounded.
inline std::array<RealVector, 3> true_columns(const Pose& pose) {
  const auto& q = pose.quaternion_wxyz();
  const Real w = q[0], x = q[1], y = q[2], z = q[3];
  const Real n = w * w + x * x + y * y + z * z;
  return {RealVector{(w * w + x * x - y * y - z * z) / n, 2 * (x * y + w * z) / n, 2 * (x * z - w * y) / n},
          RealVector{2 * (x * y - w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z + w * x) / n},
          RealVector{2 * (x * z + w * y) / n, 2 * (y * z - w * x) / n, (w * w - x * x - y * y + z * z) / n}};
}
inline RealVector true_place(const Pose& pose, const Vec3& local) {
  const auto c = true_columns(pose);
  return c[0] * Real(local.x()) + c[1] * Real(local.y()) + c[2] * Real(local.z()) + real(pose.translation());
}

/// Two boxes: half extents, then poses, 20 numbers in all.
struct BoxesAtPoses {
  std::optional<ConvexPolytope> a, b;
  std::optional<Pose> pose_a, pose_b;

  explicit BoxesAtPoses(const Numbers& x) : pose_a(pose_of(x, 6)), pose_b(pose_of(x, 13)) {
    const auto box_a = ConvexPolytope::box(Vec3(x[0], x[1], x[2]).cwiseAbs());
    const auto box_b = ConvexPolytope::box(Vec3(x[3], x[4], x[5]).cwiseAbs());
    if (box_a) a = *box_a;
    if (box_b) b = *box_b;
  }
  [[nodiscard]] bool valid() const { return a && b && pose_a && pose_b; }

  /// The least height of P's supporting planes across the fifteen axes, above 0 where the boxes overlap.
  [[nodiscard]] Real least_height() const {
    std::array<RealVector, 6> generators;
    const auto of_a = true_columns(*pose_a), of_b = true_columns(*pose_b);
    const Vec3 half_a = a->vertex(7), half_b = b->vertex(7);
    for (std::size_t k = 0; k < 3; ++k) {
      generators[k] = of_a[k] * Real(half_a[static_cast<Eigen::Index>(k)]);
      generators[k + 3] = of_b[k] * Real(half_b[static_cast<Eigen::Index>(k)]);
    }
    const RealVector centre = real(pose_b->translation()) - real(pose_a->translation());
    std::optional<Real> least;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = i + 1; j < 6; ++j) {
        const RealVector n = cross(generators[i], generators[j]);
        const Real squared = dot(n, n);
        if (squared == 0) continue;
        Real height = -abs(dot(n, centre));
        for (const RealVector& g : generators) height += abs(dot(n, g));
        height /= sqrt(squared);
        if (!least || height < *least) least = height;
      }
    }
    return *least;
  }
};

inline double box_share(const Numbers& x, detail::BoxQuestion question) {
  const BoxesAtPoses boxes(x);
  if (!boxes.valid()) return 0;
  const auto frame_a = detail::box_frame(*boxes.a), frame_b = detail::box_frame(*boxes.b);
  const detail::GaussSatDepth found = detail::gauss_sat_of_boxes(
      {*boxes.a, *frame_a, *boxes.pose_a}, {*boxes.b, *frame_b, *boxes.pose_b}, kAnyWidth, question, nullptr);
  if (!found.nearest.certified || !(found.nearest.lower > 0)) return 0;
  return share_of_bracket(boxes.least_height(), found.nearest.lower, found.nearest.upper);
}
inline double box_depth_share(const Numbers& x) { return box_share(x, detail::BoxQuestion::depth); }
/// Of boxes that overlap.
inline double box_contact_share(const Numbers& x) { return box_share(x, detail::BoxQuestion::signed_depth); }

/// The distance of the segments from p[0] to p[1] and from p[2] to p[3].
inline Real true_distance(const std::array<RealVector, 4>& p) {
  const auto to_segment = [](const RealVector& x, const RealVector& from, const RealVector& to) {
    const RealVector along = to - from;
    const Real squared = dot(along, along);
    const Real share = squared > 0 ? std::clamp<Real>(dot(x - from, along) / squared, 0, 1) : Real(0);
    const RealVector gap = x - from - along * share;
    return Real(dot(gap, gap));
  };
  Real least = std::min({to_segment(p[0], p[2], p[3]), to_segment(p[1], p[2], p[3]), to_segment(p[2], p[0], p[1]),
                         to_segment(p[3], p[0], p[1])});
  const RealVector u = p[1] - p[0], v = p[3] - p[2], w = p[2] - p[0], n = cross(u, v);
  const Real squared = dot(n, n);
  if (squared > 0) {
    const Real s = dot(cross(w, v), n) / squared, t = dot(cross(w, u), n) / squared;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min<Real>(least, dot(w, n) * dot(w, n) / squared);
  }
  return sqrt(least);
}

/// Between two points, six numbers.
inline Expected<ConvexPolytope> segment_of(const Numbers& x, std::size_t first) {
  const std::array<Vec3, 2> ends = {Vec3(x[first], x[first + 1], x[first + 2]),
                                    Vec3(x[first + 3], x[first + 4], x[first + 5])};
  return ConvexPolytope::from_points(ends);
}

/// Two segments by their ends and poses, 26 numbers in all.
inline double segments_share(const Numbers& x) {
  const auto a = segment_of(x, 0), b = segment_of(x, 6);
  const auto pose_a = pose_of(x, 12), pose_b = pose_of(x, 19);
  if (!a || !b || a->num_vertices() != 2 || b->num_vertices() != 2 || !pose_a || !pose_b) return 0;
  const Vec3 offset = pose_b->translation() - pose_a->translation();
  detail::NearestOfSegments cores({*a, pose_a->rotation()}, {*b, pose_b->rotation()}, offset,
                                  a->radius() + b->radius() + offset.norm());
  if (!cores.bracket_distance(kAnyWidth)) return 0;
  const Real truth = true_distance({true_place(*pose_a, a->vertex(0)), true_place(*pose_a, a->vertex(1)),
                                    true_place(*pose_b, b->vertex(0)), true_place(*pose_b, b->vertex(1))});
  return share_of_bracket(truth, cores.lower, cores.upper);
}

/// A segment before one face of a box: its ends, half extents, poses, 23 numbers in all.
inline double slender_over_face_share(const Numbers& x) {
  const auto body = segment_of(x, 0);
  const auto box = ConvexPolytope::box(Vec3(x[6], x[7], x[8]).cwiseAbs());
  const auto pose_body = pose_of(x, 9), pose_box = pose_of(x, 16);
  if (!body || !box || !pose_body || !pose_box) return 0;
  PenetrationDepth out;
  const DepthSettings any{.contact_tolerance = HUGE_VAL};
  const detail::PolytopePair pair{&*body, &*box, &*pose_body, &*pose_box, {}};
  if (!detail::answer_slender_near_box(pair, any, Bracket::contact, out)) return 0;
  if (out.feature_b.kind != Feature::Kind::facet) return 0;
  const auto columns = true_columns(*pose_box);
  Real height = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    for (const int side : {1, -1}) {
      Real least = HUGE_VAL;
      for (int v = 0; v < body->num_vertices(); ++v) {
        const RealVector place = true_place(*pose_body, body->vertex(v)) - real(pose_box->translation());
        least = std::min<Real>(least, side * dot(columns[k], place));
      }
      height = std::max<Real>(height, least - box->vertex(7)[static_cast<Eigen::Index>(k)]);
    }
  }
  return share_of_bracket(height, out.distance_lower, out.distance_upper);
}

/// Heights of a fifth point over the faces of a tetrahedron.
inline double hull_height_share(const Numbers& x) {
  std::vector<Vec3> source;
  double largest = 0;
  for (std::size_t k = 0; k < 15; k += 3) {
    source.emplace_back(x[k], x[k + 1], x[k + 2]);
    largest = std::max(largest, source.back().cwiseAbs().maxCoeff());
  }
  detail::HullPoints points(source, largest);
  for (std::int32_t id = 0; id < 4; ++id) points.append(id);
  const detail::AffineFrame frame = detail::find_affine_frame(points);
  if (frame.dimension < 3) return 0;
  const detail::Quickhull hull(points, frame);
  points.append(4);
  const auto place = [&](int i) { return RealVector{points[i].x, points[i].y, points[i].z}; };
  double share = 0;
  for (const detail::HullTriangle& t : hull.triangles()) {
    if (t.error == 0) continue;
    const RealVector p = place(t.vertex[0]);
    const RealVector normal = cross(place(t.vertex[1]) - p, place(t.vertex[2]) - p);
    const Real error = Real(t.height(points[4])) - dot(normal, place(4) - p);
    share = std::max(share, static_cast<double>(abs(error) / t.error));
  }
  return share;
}

}  // namespace pd::bench
