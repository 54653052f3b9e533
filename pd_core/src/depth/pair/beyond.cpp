#include "depth/pair/beyond.hpp"

#include <algorithm>
#include <optional>

#include "depth/difference/smooth_difference.hpp"
#include "depth/distance/closest_of_few.hpp"
#include "depth/distance/lane_simplex.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/facets/gauss_sat_boxes.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

/// More are the business of the full query, which ends with the closest points.
constexpr int kMostSupports = 12;

struct SeparatingPlane {
  Vec3 normal;         ///< unit
  double lower;        ///< certified: every point of P has <x, normal> <= -lower
  DifferenceVertex s;  ///< the point of P next to it
  bool at_once;        ///< by the direction that the search began with
};

/// @param least  of the cores' distance.
template <class Difference>
std::optional<SeparatingPlane> find_plane(const Difference& difference, const Vec3& start, double least,
                                          std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  const double error = support_plane_error(difference);
  const double length_of_start = start.norm();
  if (!(length_of_start > 0)) return std::nullopt;
  Vec3 unit = start / length_of_start;
  LaneSimplex simplex;
  for (int step = 0; step < kMostSupports; ++step) {
    DifferenceVertex s = difference.support_in_bodies(unit);
    ++support_calls;
    if (-s.x.dot(unit) - error > least) {
      s = difference.certified_support(unit, s, stack);
      const double lower = -s.x.dot(unit) - error;
      if (lower > least) return SeparatingPlane{unit, lower, s, step == 0};
    }
    // A point of P so close to the origin: no plane lies farther from it.
    if (!simplex.add(s) || !(simplex.point().norm() > least)) return std::nullopt;
    unit = simplex.toward();
  }
  return std::nullopt;
}

struct BodyPoints {
  Vec3 a;  ///< of A's core, relative to its translation
  Vec3 b;  ///< of B's core, relative to A's translation
};
BodyPoints points_of(const PolytopeDifference& difference, const DifferenceVertex& s) {
  return {difference.rotation_a() * difference.a().vertex(s.a),
          difference.rotation_b() * difference.b().vertex(s.b) + difference.offset()};
}
BodyPoints points_of(const SmoothDifference& difference, const DifferenceVertex& s) {
  return {difference.points(s).a, difference.points(s).b};
}

class BeyondQuery {
 public:
  BeyondQuery(const PosedShape& a, const PosedShape& b, double beyond, ScratchBuffers& buffers, WarmCertificate* warm,
              PenetrationDepth& out)
      : a_(a),
        b_(b),
        beyond_(std::max(beyond, 0.0)),
        margin_(a.shape->margin() + b.shape->margin()),
        buffers_(buffers),
        warm_(warm),
        remembered_(warm ? warm->state().direction : Vec3(Vec3::Zero())),
        remembers_(remembered_.squaredNorm() > 0),
        out_(out) {}

  template <class Difference>
  bool answer(const Difference& difference) {
    const Vec3 start = remembers_ ? remembered_ : Vec3(-difference.centre());
    const double reach = difference.reach();
    const auto plane = find_plane(difference, start, least(reach), buffers_.stack, out_.statistics.support_calls);
    if (plane) fill(*plane, points_of(difference, plane->s), difference.point_error(), reach);
    return plane.has_value();
  }

  /// Two polytopes of few vertices: one support of the bodies as they are, and where that does not tell, a search over
  /// their posed vertices.
  bool answer_few(const ConvexPolytope& a, const ConvexPolytope& b) {
    const Mat3& turn_a = a_.pose.rotation();
    const Mat3& turn_b = b_.pose.rotation();
    const Vec3 offset = b_.pose.translation() - a_.pose.translation();
    const double reach = a.radius() + b.radius() + offset.norm();
    const Vec3 start = remembers_ ? remembered_ : Vec3(turn_a * a.centre() - turn_b * b.centre() - offset);
    const double length = start.norm();
    if (!is_ordinary(reach) || !(length > 0)) return false;
    const Vec3 unit = start / length;
    const SupportOfFew s =
        support_of_few({arrays_of(a), arrays_of(b), turn_a.data(), turn_b.data()}, {unit.x(), unit.y(), unit.z()});
    ++out_.statistics.support_calls;
    const BodyPoints points{Vec3(s.on_a[0], s.on_a[1], s.on_a[2]), Vec3(s.on_b[0], s.on_b[1], s.on_b[2]) + offset};
    // As `support_plane_error`.
    constexpr double kError = PolytopeDifference::kPointError + PolytopeDifference::kSupportError + 8 * kUnitRoundoff;
    const double lower = (points.a - points.b).dot(unit) - kError * reach;
    if (lower > least(reach)) {
      fill({unit, lower, {Vec3::Zero(), s.ids.a, s.ids.b}, true}, points, PolytopeDifference::kPointError * reach,
           reach);
      return true;
    }
    if (const auto plane = plane_of_boxes(a, b, reach)) {
      fill(*plane, points_of(PolytopeDifference(a, a_.pose, b, b_.pose), plane->s),
           PolytopeDifference::kPointError * reach, reach);
      return true;
    }
    PolytopeDifference difference(a, a_.pose, b, b_.pose);
    difference.prepare_supports(buffers_.posed);
    const DifferenceVertex first = difference.vertex(s.ids.a, s.ids.b);
    const auto plane = plane_of_few(difference, first, least(reach), out_.statistics.support_calls);
    if (!plane) return false;
    fill({plane->normal, plane->lower, plane->s, false}, points_of(difference, plane->s), difference.point_error(),
         reach);
    return true;
  }

  /// Squares of lengths are ordinary numbers.
  static bool is_ordinary(double reach) { return reach > 0x1p-100 && reach < 0x1p100; }

 private:
  /// Three sums round, each by u of what it sums.
  [[nodiscard]] double rounding(double reach) const { return 8 * kUnitRoundoff * (beyond_ + margin_ + reach); }
  /// What the cores' distance must exceed.
  [[nodiscard]] double least(double reach) const { return beyond_ + margin_ + rounding(reach); }

  /// Of two boxes that are far enough apart along one of their fifteen axes: next to each other, most are.
  std::optional<SeparatingPlane> plane_of_boxes(const ConvexPolytope& a, const ConvexPolytope& b, double reach) const {
    const std::optional<BoxFrame> box_a = box_frame(a);
    if (!box_a) return std::nullopt;
    const std::optional<BoxFrame> box_b = box_frame(b);
    if (!box_b) return std::nullopt;
    const GaussSatDepth boxes =
        gauss_sat_of_boxes({a, *box_a, a_.pose}, {b, *box_b, b_.pose}, {}, BoxQuestion::depth, nullptr);
    if (boxes.status != GaussSatStatus::separated || boxes.nearest.facets == 0) return std::nullopt;
    const double lower = -boxes.nearest.upper;
    if (!(lower > least(reach))) return std::nullopt;
    return SeparatingPlane{boxes.nearest.normal, lower, {Vec3::Zero(), boxes.corner.a, boxes.corner.b}, false};
  }

  void fill(const SeparatingPlane& plane, const BodyPoints& points, double point_error, double reach) {
    const double round = rounding(reach);
    out_.contact = ContactClass::separated;
    out_.method = Method::expansion;
    out_.warm = remembers_ && plane.at_once;
    out_.normal = plane.normal;
    out_.witness_a = points.a - a_.shape->margin() * plane.normal;
    out_.witness_b = points.b + b_.shape->margin() * plane.normal;
    out_.distance_lower = plane.lower - margin_ - round / 2;
    // Both are points of the bodies, up to the error of points.
    out_.distance = std::max((out_.witness_a - out_.witness_b).norm(), out_.distance_lower);
    out_.distance_upper = out_.distance + 2 * point_error + round;
    if (a_.shape->polytope() && b_.shape->polytope()) {
      out_.feature_a = {Feature::Kind::vertex, plane.s.a, -1};
      out_.feature_b = {Feature::Kind::vertex, plane.s.b, -1};
    }
    out_.witness_a += a_.pose.translation();
    out_.witness_b += a_.pose.translation();
    if (warm_) warm_->state().direction = plane.normal;
  }

  const PosedShape& a_;
  const PosedShape& b_;
  const double beyond_;
  const double margin_;
  ScratchBuffers& buffers_;
  WarmCertificate* const warm_;
  const Vec3 remembered_;  ///< the last frame's direction, or zero
  const bool remembers_;
  PenetrationDepth& out_;
};

}  // namespace

bool answer_beyond(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                   WarmCertificate* warm, PenetrationDepth& out) {
  BeyondQuery query(a, b, settings.beyond, buffers, warm, out);
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (polytope_a == nullptr || polytope_b == nullptr) {
    if (extreme_exponent(a, b) != 0) return false;
    return query.answer(SmoothDifference(a, b, buffers.points));
  }
  if (std::max(polytope_a->num_vertices(), polytope_b->num_vertices()) <= kScanLimit) {
    return query.answer_few(*polytope_a, *polytope_b);
  }
  const PolytopeDifference difference(*polytope_a, a.pose, *polytope_b, b.pose);
  return BeyondQuery::is_ordinary(difference.reach()) && query.answer(difference);
}

void remember_plane(const PenetrationDepth& out, WarmCertificate& warm) {
  warm.state().direction = out.contact == ContactClass::separated ? out.normal : Vec3(Vec3::Zero());
}

}  // namespace pd::detail
