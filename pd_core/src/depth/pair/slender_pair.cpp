#include "depth/pair/slender_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/pair/double_answer.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// A point of P errs by 11u of the reach (`PolytopeDifference::point_error`), its length or height along a unit vector
/// by 6u more.
constexpr double kPointError = 20 * kUnitRoundoff;
/// Squares of squares of lengths within it are ordinary numbers.
constexpr double kLeastReach = 0x1p-100, kLargestReach = 0x1p100;

/// A segment or point at its pose, relative to its body's translation.
struct PosedSegment {
  Vec3 start;
  Vec3 along = Vec3::Zero();
  bool is_point;

  PosedSegment(const ConvexPolytope& body, const Mat3& rotation)
      : start(rotation * body.vertex(0)), is_point(body.num_vertices() == 1) {
    if (!is_point) along = rotation * body.vertex(1) - start;
  }
  [[nodiscard]] Vec3 at(double share) const { return start + share * along; }
  [[nodiscard]] Feature feature(double share) const {
    if (share <= 0) return {Feature::Kind::vertex, 0, -1};
    if (share >= 1) return {Feature::Kind::vertex, 1, -1};
    return {Feature::Kind::edge, 0, 1};
  }
};

double share_of(double along, double squared) { return squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0; }

/// How far along A and along B their nearest points lie, from 0 to 1 (Ericson, Real-Time Collision Detection, 5.1.9).
struct NearestShares {
  double a = 0;
  double b = 0;
};
NearestShares nearest_shares(const PosedSegment& a, const PosedSegment& b, const Vec3& between) {
  const double of_a = a.along.squaredNorm(), of_b = b.along.squaredNorm();
  const double toward_a = a.along.dot(between), toward_b = -b.along.dot(between);
  if (a.is_point) return {0, share_of(toward_b, of_b)};
  if (b.is_point) return {share_of(toward_a, of_a), 0};
  const double both = a.along.dot(b.along);
  // |e x f|^2, without the cancellation of |e|^2 |f|^2 - <e, f>^2.
  const double squared_sine = a.along.cross(b.along).squaredNorm();
  NearestShares share;
  share.a = share_of(toward_a * of_b + toward_b * both, squared_sine);
  share.b = share_of(both * share.a + toward_b, of_b);
  share.a = share_of(both * share.b + toward_a, of_a);
  return share;
}

class SlenderPair {
 public:
  explicit SlenderPair(const PolytopePair& pair)
      : offset_(pair.pose_b->translation() - pair.pose_a->translation()),
        a_(*pair.a, pair.pose_a->rotation()),
        b_(*pair.b, pair.pose_b->rotation()),
        reach_(pair.a->radius() + pair.b->radius() + offset_.norm()),
        between_(b_.start - a_.start + offset_),
        share_(nearest_shares(a_, b_, between_)) {}

  /// False where the bracket of the cores' distance is wider than asked, or may hold 0.
  bool bracket_distance(const BracketWidth& width) {
    if (!(reach_ > kLeastReach && reach_ < kLargestReach)) return false;
    const Vec3 nearest = between_ + (share_.b * b_.along - share_.a * a_.along);
    const double length = nearest.norm();
    const double error = kPointError * reach_;
    if (!(length > 4 * error)) return false;
    upper = length + error;
    bound_below(nearest / length, error);
    const Vec3 other = between_ + b_.along - a_.along, one = between_ + b_.along, two = between_ - a_.along;
    const double largest = std::max({between_.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff(),
                                     one.cwiseAbs().maxCoeff(), two.cwiseAbs().maxCoeff()});
    const double limit = width.limit(largest);
    const auto narrow = [&] { return lower > 0 && upper - lower <= limit; };
    if (narrow()) return true;
    // Close to each other: the point's own direction errs by u reach / distance, one across the segments does not.
    const Vec3 across = a_.along.cross(b_.along);
    if (across.squaredNorm() > 0) bound_below(facing(across, nearest), error);
    if (!narrow() && is_inner(share_.a)) bound_below(facing(across_one(nearest, a_.along), nearest), error);
    if (!narrow() && is_inner(share_.b)) bound_below(facing(across_one(nearest, b_.along), nearest), error);
    return narrow();
  }

  double lower = -std::numeric_limits<double>::infinity();
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< P lies below -lower along it

  [[nodiscard]] Vec3 point_a() const { return a_.at(share_.a); }
  [[nodiscard]] Vec3 point_b() const { return b_.at(share_.b); }
  [[nodiscard]] Feature feature_a() const { return a_.is_point ? a_.feature(0) : a_.feature(share_.a); }
  [[nodiscard]] Feature feature_b() const { return b_.is_point ? b_.feature(0) : b_.feature(share_.b); }

 private:
  static bool is_inner(double share) { return share > 0 && share < 1; }
  static Vec3 facing(const Vec3& direction, const Vec3& point) {
    return direction / (direction.dot(point) < 0 ? -direction.norm() : direction.norm());
  }
  static Vec3 across_one(const Vec3& point, const Vec3& along) {
    return point - (point.dot(along) / along.squaredNorm()) * along;
  }

  /// By the least height of P's corners along `unit`.
  void bound_below(const Vec3& unit, double error) {
    const double least = between_.dot(unit) + std::min(0.0, b_.along.dot(unit)) - std::max(0.0, a_.along.dot(unit));
    if (least - error <= lower) return;
    lower = least - error;
    normal = -unit;
  }

  Vec3 offset_;
  PosedSegment a_;
  PosedSegment b_;
  double reach_;
  Vec3 between_;  ///< from A's first vertex to B's
  NearestShares share_;
};

}  // namespace

bool answer_slender_pair(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                         PenetrationDepth& out) {
  if (pair.a->num_vertices() > 2 || pair.b->num_vertices() > 2) return false;
  SlenderPair cores(pair);
  const bool for_contact = bracket == Bracket::contact;
  if (!cores.bracket_distance({kCertifiedWidth, for_contact ? settings.contact_tolerance : 0})) return false;
  const double margin = pair.margins.both();
  const double round = 4 * kUnitRoundoff * (cores.upper + margin);
  const bool sign_unclear = cores.lower - margin <= round && cores.upper - margin >= -round;
  if (margin > 0 && sign_unclear && !for_contact) return false;
  out.method = Method::expansion;
  ++out.statistics.support_calls;
  out.normal = cores.normal;
  out.witness_a = cores.point_a() + pair.pose_a->translation() - pair.margins.a * cores.normal;
  out.witness_b = cores.point_b() + pair.pose_b->translation() + pair.margins.b * cores.normal;
  out.feature_a = cores.feature_a();
  out.feature_b = cores.feature_b();
  set_signed_distance(margin, cores.lower, cores.upper, out);
  return true;
}

}  // namespace pd::detail
