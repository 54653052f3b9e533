#include "solid/overlap_depth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid/shape_beside.hpp"
#include "solid/solid_contact.hpp"
#include "solid/solid_distance.hpp"
#include "solid/translation_cover.hpp"

namespace pd::detail {

namespace {

/// Pairs of convex parts that a depth may be told by: some ten milliseconds each where corners are rounded, since faces
/// that nearly coincide ask for long numbers, and a tenth of that elsewhere.
constexpr std::int64_t kMostExactPairs = 1024;
constexpr std::int64_t kMostRoundedPairs = 160;
/// Parts beside a convex shape, some three milliseconds each.
constexpr std::int64_t kMostPartsBeside = 256;
/// Cutting a solid takes the square of its triangles.
constexpr std::size_t kMostTriangles = 2000;

void take(const PenetrationDepth& from, SolidDepth& out) {
  static_cast<PenetrationDepth&>(out) = from;
  out.feature_a = out.feature_b = {};
}

/// A body as two unions of convex parts: one lies in it, one covers it.
struct PartsOfBody {
  Compound inner;
  Compound outer;
  bool exact;  ///< both are the body itself
  Pose pose;

  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(outer.parts().size()); }
};

Expected<PartsOfBody> parts_of(const PosedSolid& body, const SolidPartsLimits& limits) {
  if (body.solid->triangles().size() > kMostTriangles) {
    return Error{ErrorCode::limit_exceeded, "too many triangles", ""};
  }
  const Expected<SolidParts> parts = SolidParts::from_solid(*body.solid, limits);
  if (!parts) return parts.error();
  return PartsOfBody{parts->inner(), parts->outer(), parts->exact(), body.pose};
}

/// The bracket of two bodies that overlap, narrowed from both ends.
class Bracketing {
 public:
  Bracketing(const SolidSettings& settings, Scratch& scratch, SolidDepth& out)
      : settings_(settings), scratch_(scratch), out_(out) {}

  [[nodiscard]] bool reached() const { return out_.upper <= (1 + settings_.delta) * out_.lower; }

  /// A translation that separates bodies that hold A and B separates these.
  void begin(const PosedShape& around_a, const PosedShape& around_b) {
    take(penetration_depth(around_a, around_b, scratch_, {.bracket = Bracket::tightest}), out_);
    out_.exact = false;
    out_.lower = 0;
  }

  /// The depth of the unions of convex parts that lie in the bodies is a lower bound, that of the unions that cover
  /// them an upper one.
  /// @return whether the bracket needs no more narrowing.
  bool narrow_by_parts(const PartsOfBody& a, const PartsOfBody& b) {
    UnionSettings union_settings;
    union_settings.delta = settings_.delta;
    const Expected<UnionDepth> outer =
        penetration_depth({&a.outer, a.pose}, {&b.outer, b.pose}, scratch_, union_settings);
    if (!outer || outer->contact != ContactClass::overlapping) return false;
    const bool same = a.exact && b.exact;
    const double known_lower = out_.lower;
    if (same || outer->upper <= out_.upper) take(*outer, out_);
    out_.work.parts_a = a.count();
    out_.work.parts_b = b.count();
    out_.exact = outer->exact && same;
    if (same) return out_.exact || reached();
    out_.lower = known_lower;
    const Expected<UnionDepth> inner =
        penetration_depth({&a.inner, a.pose}, {&b.inner, b.pose}, scratch_, union_settings);
    if (inner && inner->contact == ContactClass::overlapping) {
      out_.lower = std::min(std::max(out_.lower, inner->lower), out_.upper);
    }
    return reached();
  }

  void end() { out_.bracket_reached = reached(); }

 private:
  const SolidSettings& settings_;
  Scratch& scratch_;
  SolidDepth& out_;
};

/// The points that are nearest after the move, where A was before it.
void set_witnesses(const PenetrationDepth& after_the_move, SolidDepth& out) {
  out.witness_b = after_the_move.witness_b;
  out.witness_a = after_the_move.witness_b - out.translation;
}

}  // namespace

void set_depth(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out) {
  const PosedSolid &a = question.a, &b = question.b;
  const ConvexShape hull_a = *ConvexPolytope::from_points(a.solid->vertices());
  const ConvexShape hull_b = *ConvexPolytope::from_points(b.solid->vertices());
  Bracketing bracket(question.settings, scratch, out);
  bracket.begin({&hull_a, a.pose}, {&hull_b, b.pose});
  const auto told_by_parts = [&] {
    const SolidPartsLimits limits{.parts = kMostExactPairs, .polygons = 10'000};
    const Expected<PartsOfBody> parts_a = parts_of(a, limits);
    if (!parts_a) return false;
    const Expected<PartsOfBody> parts_b = parts_of(b, limits);
    if (!parts_b) return false;
    const std::int64_t most = parts_a->exact && parts_b->exact ? kMostExactPairs : kMostRoundedPairs;
    return parts_a->count() * parts_b->count() <= most && bracket.narrow_by_parts(*parts_a, *parts_b);
  };
  if (!bracket.reached() && !told_by_parts()) {
    const auto standing = standing_solid(a, b, question.solids);
    if (narrow_by_cover({question.solids, *standing, question.settings}, out)) {
      const Pose moved = placed_at(a.pose, a.pose.translation() + out.translation);
      const PosedSolids apart(*a.solid, moved, *b.solid, b.pose);
      if (contact_of(apart).contact == ContactClass::separated) {
        SolidDepth near;
        set_distance(apart, scratch, near);
        set_witnesses(near, out);
        out.face_a = near.face_a;
        out.face_b = near.face_b;
      }
    }
  }
  bracket.end();
}

void set_depth_beside(const PosedSolid& a, const PosedShape& b, ShapeBeside& beside, const SolidSettings& settings,
                      Scratch& scratch, SolidDepth& out) {
  const ConvexShape hull = *ConvexPolytope::from_points(a.solid->vertices());
  Bracketing bracket(settings, scratch, out);
  bracket.begin({&hull, a.pose}, b);
  const auto told_by_parts = [&] {
    const Expected<PartsOfBody> parts = parts_of(a, {.parts = kMostPartsBeside});
    if (!parts) return false;
    const Compound shape(*b.shape);
    return bracket.narrow_by_parts(*parts, {shape, shape, true, b.pose});
  };
  if (!told_by_parts() && narrow_by_cover({beside.solids(), beside, settings}, out)) {
    const Pose moved = placed_at(a.pose, a.pose.translation() + out.translation);
    const ShapeBeside::Found near = beside.meet(moved, out.translation, HUGE_VAL);
    if (near.contact == ContactClass::separated) {
      set_witnesses(near.answer, out);
      out.face_a = a.solid->triangle(near.triangle).face;
    }
  }
  bracket.end();
}

}  // namespace pd::detail
