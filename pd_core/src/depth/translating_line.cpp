#include "pd/depth/translating_line.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "depth/difference/direction_signs.hpp"
#include "depth/difference/exact_support.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/root_sum.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::PairVector;
using detail::PosedPair;
using detail::RoundedDirection;
using detail::VertexPair;

/// t = level / slope in units of |motion|; level carries the pair's homogeneous factor once more than slope > 0.
struct ShadowEnd {
  Dyadic level;
  Dyadic slope;
};

/// Both ends of the shadow Q along the ray's line. The shadow's plane is spanned by the motion v and the line's
/// direction d seen as a point; `across` = v x d, normal to both, tells the two sides of the ray's line apart.
class ShadowSearch {
 public:
  ShadowSearch(const PosedPair& pair, const Vec3& direction, const Vec3& motion)
      : pair_(pair),
        along_(pair, direction),
        direction_(detail::to_dyadic(direction)),
        motion_(detail::to_dyadic(motion)),
        across_(cross(motion_, direction_)),
        rounded_across_(detail::ExactDirection(across_).unit) {}

  /// False when the ray's whole line misses Q.
  bool reaches_line() {
    left_ = support(rounded_across_, across_);
    right_ = support(-rounded_across_, negated(across_));
    left_side_ = side(left_);
    right_side_ = side(right_);
    return left_side_ >= 0 && right_side_ <= 0;
  }

  /// The end of Q on the ray's line forwards (sense 1) or backwards (-1). Requires `reaches_line`.
  ShadowEnd end(int sense) {
    if (left_side_ == 0 && right_side_ == 0) return end_of_segment(sense);
    // Invariant: left lies on the line or to its left, right on it or to its right, not both on it.
    VertexPair left = left_, right = right_;
    int right_side = right_side_;
    for (;;) {
      const PairVector chord = step(right, left);
      const VertexPair beyond = support_across(chord, sense);
      if (sense * along_.turn(chord, step(left, beyond)) <= 0) return crossing(chord, left);
      const int beyond_side = side(beyond);
      if (beyond_side > 0 || (beyond_side == 0 && right_side != 0)) {
        left = beyond;
      } else {
        right = beyond;
        right_side = beyond_side;
      }
    }
  }

  [[nodiscard]] std::int64_t support_calls() const { return support_calls_; }

 private:
  static PairVector step(const VertexPair& from, const VertexPair& to) {
    return PairVector::difference(from.a, from.b, to.a, to.b);
  }
  static Dyadic3 negated(const Dyadic3& v) { return {-v.x, -v.y, -v.z}; }

  [[nodiscard]] int side(const VertexPair& x) const {
    return dot(pair_.exact(PairVector::point(x.a, x.b)), across_).sign();
  }

  VertexPair support(const Vec3& rounded, const Dyadic3& exact) {
    ++support_calls_;
    return support_exactly(pair_, RoundedDirection{rounded, 0x1p-50}, {-1, -1},
                           [&](const PairVector& edge) { return dot(pair_.exact(edge), exact).sign(); });
  }

  /// In the direction sense (d x chord): <edge, d x chord> = det(chord, edge, d).
  VertexPair support_across(const PairVector& chord, int sense) {
    ++support_calls_;
    const RoundedDirection normal =
        detail::rounded_cross(sense * along_.scaled(), 0, pair_.approximate(chord), pair_.vector_error());
    return support_exactly(pair_, normal, {-1, -1},
                           [&](const PairVector& edge) { return sense * along_.turn(chord, edge); });
  }

  /// Where the ray's line crosses the chord's: t <v, n> = <left, n> for n = d x chord, to which d is normal.
  /// <v, n> = <chord, v x d> > 0, because left lies to the left of right.
  [[nodiscard]] ShadowEnd crossing(const PairVector& chord, const VertexPair& left) const {
    const Dyadic3 normal = cross(direction_, pair_.exact(chord));
    return {dot(pair_.exact(PairVector::point(left.a, left.b)), normal), dot(motion_, normal)};
  }

  /// Q lies on the ray's line: its extreme vertex along the motion's part normal to d, d x (v x d).
  ShadowEnd end_of_segment(int sense) {
    const Dyadic3 forwards = cross(direction_, across_);
    const Dyadic3 towards = sense > 0 ? forwards : negated(forwards);
    const VertexPair last = support(detail::ExactDirection(towards).unit, towards);
    return {dot(pair_.exact(PairVector::point(last.a, last.b)), forwards), dot(motion_, forwards)};
  }

  const PosedPair& pair_;
  detail::DirectionSigns along_;
  Dyadic3 direction_;
  Dyadic3 motion_;
  Dyadic3 across_;
  Vec3 rounded_across_;
  VertexPair left_{}, right_{};
  int left_side_ = 0, right_side_ = 0;
  std::int64_t support_calls_ = 0;
};

/// t |motion| rounded down and up. Requires level >= 0.
void round(const PosedPair& pair, const Vec3& motion, const ShadowEnd& c, double& lower, double& upper) {
  const Dyadic3 v = detail::to_dyadic(motion);
  const Dyadic denominator = c.slope * pair.homogeneous_factor();
  const detail::RootSum exact(Dyadic(0.0), 1, c.level * c.level * dot(v, v), denominator * denominator);
  if (exact.compare(Dyadic(std::numeric_limits<double>::max())) > 0) {
    lower = std::numeric_limits<double>::max();
    upper = std::numeric_limits<double>::infinity();
    return;
  }
  lower = exact.round_down();
  upper = exact.round_up(lower);
}

Expected<Vec3> finite(const Vec3& v, const char* what) {
  if (v.allFinite()) return v;
  return Error{ErrorCode::non_finite, "three finite numbers are needed", what};
}

}  // namespace

Expected<TranslatingLine> translating_line_in_difference(const PosedShape& a, const PosedShape& b, const Vec3& point,
                                                         const Vec3& direction, const Vec3& motion) {
  const detail::FloatingPointGuard guard;
  for (const auto& [vector, what] :
       {std::pair(&point, "point"), std::pair(&direction, "direction"), std::pair(&motion, "motion")}) {
    if (const Expected<Vec3> checked = finite(*vector, what); !checked) return checked.error();
  }
  if (point.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e300", "point"};
  }
  if (direction.isZero(0)) {
    return Error{ErrorCode::zero_direction, "a direction needs a length other than zero", "direction"};
  }
  const Dyadic3 across = cross(detail::to_dyadic(motion), detail::to_dyadic(direction));
  if (across.x.sign() == 0 && across.y.sign() == 0 && across.z.sign() == 0) {
    return Error{ErrorCode::zero_direction, "the line must be moved by a vector that is not parallel to it", "motion"};
  }
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (!polytope_a || !polytope_b || a.shape->margin() > 0 || b.shape->margin() > 0) {
    return Error{ErrorCode::unsupported, "lines meet the difference of polytopes without a margin", ""};
  }
  const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose, point);
  ShadowSearch search(pair, direction, motion);
  TranslatingLine line;
  if (search.reaches_line()) {
    const ShadowEnd last = search.end(1);
    line.meets = last.level.sign() >= 0;
    if (line.meets) {
      round(pair, motion, last, line.last_lower, line.last_upper);
      const ShadowEnd first = search.end(-1);
      if (first.level.sign() > 0) round(pair, motion, first, line.first_lower, line.first_upper);
    }
  }
  line.support_calls = search.support_calls();
  return line;
}

}  // namespace pd
