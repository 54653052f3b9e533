#include "solid/overlap_depth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid/solid_contact.hpp"
#include "solid/solid_distance.hpp"
#include "solid/translation_cover.hpp"

namespace pd::detail {

namespace {

/// Pairs of convex parts that a depth may be told by: some ten milliseconds each where corners are rounded, since faces
/// that nearly coincide ask for long numbers, and a tenth of that elsewhere.
constexpr std::int64_t kMostExactPairs = 1024;
constexpr std::int64_t kMostRoundedPairs = 160;
/// Cutting a solid takes the square of its triangles.
constexpr std::size_t kMostTriangles = 2000;

void take(const PenetrationDepth& from, SolidDepth& out) {
  static_cast<PenetrationDepth&>(out) = from;
  out.feature_a = out.feature_b = {};
}

/// The bracket of two solids that overlap, narrowed from both ends.
class Bracketing {
 public:
  Bracketing(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out)
      : a_(question.a),
        b_(question.b),
        solids_(question.solids),
        settings_(question.settings),
        scratch_(scratch),
        out_(out) {}

  void run() {
    set_by_hulls();
    if (reached() || (narrow_by_parts() && (out_.exact || reached()))) return;
    if (narrow_by_cover({a_, b_, solids_, settings_}, out_)) set_witnesses();
  }

 private:
  [[nodiscard]] bool reached() const { return out_.upper <= (1 + settings_.delta) * out_.lower; }

  /// A translation that separates the hulls separates the solids; two convex solids are their hulls.
  void set_by_hulls() {
    const ConvexShape hull_a = *ConvexPolytope::from_points(a_.solid->vertices());
    const ConvexShape hull_b = *ConvexPolytope::from_points(b_.solid->vertices());
    take(penetration_depth({&hull_a, a_.pose}, {&hull_b, b_.pose}, scratch_, {.bracket = Bracket::tightest}), out_);
    out_.exact = false;
    out_.lower = 0;
  }

  /// The depth of the unions of convex parts that lie in the solids is a lower bound, that of the unions that cover
  /// them an upper one.
  /// @return whether there were parts, few enough.
  bool narrow_by_parts() {
    const auto parts_of = [&](const MeshSolid& solid) -> Expected<SolidParts> {
      if (solid.triangles().size() > kMostTriangles) return Error{ErrorCode::limit_exceeded, "too many triangles", ""};
      return SolidParts::from_solid(solid, {.parts = kMostExactPairs, .polygons = 10'000});
    };
    const Expected<SolidParts> parts_a = parts_of(*a_.solid);
    if (!parts_a) return false;
    const Expected<SolidParts> parts_b = parts_of(*b_.solid);
    if (!parts_b) return false;
    const auto count = [](const Compound& compound) { return static_cast<std::int64_t>(compound.parts().size()); };
    const bool exact = parts_a->exact() && parts_b->exact();
    const std::int64_t pairs = count(parts_a->outer()) * count(parts_b->outer());
    if (pairs > (exact ? kMostExactPairs : kMostRoundedPairs)) return false;
    UnionSettings union_settings;
    union_settings.delta = settings_.delta;
    const Expected<UnionDepth> outer =
        penetration_depth({&parts_a->outer(), a_.pose}, {&parts_b->outer(), b_.pose}, scratch_, union_settings);
    if (!outer || outer->contact != ContactClass::overlapping) return false;
    const double known_lower = out_.lower;
    if (exact || outer->upper <= out_.upper) take(*outer, out_);
    out_.work.parts_a = count(parts_a->outer());
    out_.work.parts_b = count(parts_b->outer());
    out_.exact = exact;
    if (exact) return true;
    out_.lower = known_lower;
    const Expected<UnionDepth> inner =
        penetration_depth({&parts_a->inner(), a_.pose}, {&parts_b->inner(), b_.pose}, scratch_, union_settings);
    if (inner && inner->contact == ContactClass::overlapping) raise(inner->lower);
    return true;
  }

  /// The points that are nearest after the move, where A was before it.
  void set_witnesses() {
    const Vec3 translation = a_.pose.translation() + out_.translation;
    const Pose moved = a_.pose.is_quaternion() ? *Pose::from_quaternion(a_.pose.quaternion_wxyz(), translation)
                                               : Pose::from_trusted_matrix(a_.pose.rotation(), translation);
    const PosedSolids apart(*a_.solid, moved, *b_.solid, b_.pose);
    if (contact_of(apart).contact != ContactClass::separated) return;
    SolidDepth near;
    set_distance(apart, scratch_, near);
    out_.witness_b = near.witness_b;
    out_.witness_a = near.witness_b - out_.translation;
    out_.face_a = near.face_a;
    out_.face_b = near.face_b;
  }

  void raise(double lower) { out_.lower = std::min(std::max(out_.lower, lower), out_.upper); }

  const PosedSolid& a_;
  const PosedSolid& b_;
  const PosedSolids& solids_;
  const SolidSettings& settings_;
  Scratch& scratch_;
  SolidDepth& out_;
};

}  // namespace

void set_depth(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out) {
  Bracketing(question, scratch, out).run();
  out.bracket_reached = out.upper <= (1 + question.settings.delta) * out.lower;
}

}  // namespace pd::detail
