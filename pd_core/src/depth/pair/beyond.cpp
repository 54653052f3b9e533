#include "depth/pair/beyond.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>

#include "depth/difference/smooth_difference.hpp"
#include "depth/distance/closest_of_few.hpp"
#include "depth/expansion/cached_surface.hpp"
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

/// From a vertex of P on, of bodies of few vertices: a search in lanes.
std::optional<SeparatingPlane> find_plane_of_few(PolytopeDifference& difference, const DifferenceVertex& first,
                                                 double least, PosedVerticesPair& posed, std::int64_t& support_calls) {
  difference.prepare_supports(posed);
  FewSettings settings;
  settings.beyond = least;
  const ClosestOfFew found = closest_of_few(difference, {&first, 1}, Vec3::Zero(), settings, support_calls);
  if (!found.beyond) return std::nullopt;
  return SeparatingPlane{found.nearest.normal, found.nearest.lower, found.next_to_plane, false};
}

DifferenceVertex support(const PolytopeDifference& difference, const Vec3& unit) {
  return difference.climbs() ? difference.support_in_bodies(unit) : support_of_few(difference, unit);
}
DifferenceVertex support(const SmoothDifference& difference, const Vec3& unit) {
  return difference.support_in_bodies(unit);
}

/// @param least  of the cores' distance.
template <class Difference>
std::optional<SeparatingPlane> find_plane(Difference& difference, const Vec3& start, double least,
                                          ScratchBuffers& buffers, std::int64_t& support_calls) {
  const double error = support_plane_error(difference);
  const double length_of_start = start.norm();
  if (!(length_of_start > 0)) return std::nullopt;
  Vec3 unit = start / length_of_start;
  DifferenceVertex simplex[4];
  double weights[4];
  int count = 0;
  for (int step = 0; step < kMostSupports; ++step) {
    DifferenceVertex s = support(difference, unit);
    ++support_calls;
    if (-s.x.dot(unit) - error > least) {
      s = difference.certified_support(unit, s, buffers.stack);
      const double lower = -s.x.dot(unit) - error;
      if (lower > least) return SeparatingPlane{unit, lower, s, step == 0};
    }
    if constexpr (std::is_same_v<Difference, PolytopeDifference>) {
      if (!difference.climbs()) return find_plane_of_few(difference, s, least, buffers.posed, support_calls);
    }
    for (int i = 0; i < count; ++i) {
      if (simplex[i].a == s.a && simplex[i].b == s.b) return std::nullopt;
    }
    simplex[count++] = s;
    const Vec3 point = count == 1 ? simplex[0].x : closest_point_with_newest(simplex, count, weights);
    const double length = point.norm();
    // A point of P so close to the origin: no plane lies farther from it.
    if (count == 4 || !(length > least)) return std::nullopt;
    unit = point / -length;
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
      : a_(a), b_(b), beyond_(std::max(beyond, 0.0)), buffers_(buffers), warm_(warm), out_(out) {}

  template <class Difference>
  bool answer(Difference& difference) {
    const Vec3 remembered = warm_ ? warm_->state().direction : Vec3(Vec3::Zero());
    const bool warm = remembered.squaredNorm() > 0;
    const double margin = a_.shape->margin() + b_.shape->margin();
    // Three sums round, each by u of what it sums.
    const double round = 8 * kUnitRoundoff * (beyond_ + margin + difference.reach());
    const auto plane = find_plane(difference, warm ? remembered : Vec3(-difference.centre()), beyond_ + margin + round,
                                  buffers_, out_.statistics.support_calls);
    if (!plane) return false;
    out_.contact = ContactClass::separated;
    out_.method = Method::expansion;
    out_.warm = warm && plane->at_once;
    out_.normal = plane->normal;
    const BodyPoints points = points_of(difference, plane->s);
    out_.witness_a = points.a - a_.shape->margin() * plane->normal;
    out_.witness_b = points.b + b_.shape->margin() * plane->normal;
    out_.distance_lower = plane->lower - margin - round / 2;
    // Both are points of the bodies, up to the error of points.
    out_.distance = std::max((out_.witness_a - out_.witness_b).norm(), out_.distance_lower);
    out_.distance_upper = out_.distance + 2 * difference.point_error() + round;
    if (a_.shape->polytope() && b_.shape->polytope()) {
      out_.feature_a = {Feature::Kind::vertex, plane->s.a, -1};
      out_.feature_b = {Feature::Kind::vertex, plane->s.b, -1};
    }
    out_.witness_a += a_.pose.translation();
    out_.witness_b += a_.pose.translation();
    if (warm_) warm_->state().direction = plane->normal;
    return true;
  }

 private:
  const PosedShape& a_;
  const PosedShape& b_;
  double beyond_;
  ScratchBuffers& buffers_;
  WarmCertificate* warm_;
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
    SmoothDifference difference(a, b, buffers.points);
    return query.answer(difference);
  }
  PolytopeDifference difference(*polytope_a, a.pose, *polytope_b, b.pose);
  // Squares of lengths are ordinary numbers.
  return difference.reach() > 0x1p-100 && difference.reach() < 0x1p100 && query.answer(difference);
}

void remember_plane(const PenetrationDepth& out, WarmCertificate& warm) {
  warm.state().direction = out.contact == ContactClass::separated ? out.normal : Vec3(Vec3::Zero());
}

}  // namespace pd::detail
