#include "solid/overlap_depth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/root_sum.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid/solid_contact.hpp"
#include "solid/solid_distance.hpp"
#include "solid/surface_distance.hpp"
#include "solid/winding.hpp"

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
    if (reached() || narrow_by_parts(0)) return;
    // Parts within a share of the depth of the solids: fewer of them, and a bracket as wide as that.
    if (narrow_by_parts(settings_.delta * out_.upper) && reached()) return;
    raise_by_balls();
    lower_by_trials();
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
  bool narrow_by_parts(double tolerance) {
    const auto parts_of = [&](const MeshSolid& solid) -> Expected<SolidParts> {
      if (solid.triangles().size() > kMostTriangles) return Error{ErrorCode::limit_exceeded, "too many triangles", ""};
      return SolidParts::from_solid(solid, {.parts = kMostExactPairs, .tolerance = tolerance, .polygons = 10'000});
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

  /// A vertex that lies in the other solid, at a distance r from its surface, stays there while A moves by less than r.
  void raise_by_balls() {
    constexpr std::size_t kMostVertices = 400;
    double best = std::ldexp(out_.lower, -solids_.scale_exponent());
    for (const Body body : {Body::a, Body::b}) {
      const auto& vertices = solids_.solid(body).vertices();
      const std::size_t step = std::max<std::size_t>(1, vertices.size() / kMostVertices);
      for (std::size_t v = 0; v < vertices.size(); v += step) {
        const PosedPoint p = solids_.point(body, static_cast<std::int32_t>(v));
        const double radius = distance_to_surface(solids_, other(body), p.x, best);
        if (radius <= best) continue;
        const PointPlace place = place_in(solids_, other(body), p);
        if (!place.on_surface && place.winding > 0) best = radius;
      }
    }
    raise(std::ldexp(best, solids_.scale_exponent()));
  }

  /// True if A, moved by the vector as stored, is apart from B, exactly. Places where the two touch are not taken: they
  /// may be slots of zero width.
  [[nodiscard]] bool is_apart(const Vec3& way) const {
    return contact_of(PosedSolids(*a_.solid, a_.pose, *b_.solid, b_.pose, way)).contact == ContactClass::separated;
  }

  /// The least way along a direction that was found to be free, if one is shorter than the upper end.
  bool try_direction(const Vec3& unit) {
    constexpr double kShorter = 1 - 0x1p-7;
    constexpr int kHalvings = 12;
    double high = kShorter * out_.upper;
    if (!(high > out_.lower) || !is_apart(high * unit)) return false;
    double low = out_.lower;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (is_apart(middle * unit) ? high : low) = middle;
    }
    const Vec3 way = high * unit;
    out_.translation = way;
    out_.depth = out_.upper = length_rounded_up(way);
    out_.normal = unit;
    improved_ = true;
    return true;
  }

  /// Translations that are tried: many directions, then those around the best.
  void lower_by_trials() {
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 2; ++y) {
        for (int z = -2; z <= 2; ++z) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2 && !reached()) {
            try_direction(Vec3(x, y, z).normalized());
          }
        }
      }
    }
    for (double step = 0.25; step > 0x1p-8 && !reached();) {
      bool better = false;
      const Vec3 best = out_.normal;
      for (int k = 0; k < 6; ++k) {
        const Vec3 aside = (k % 2 == 0 ? step : -step) * Vec3::Unit(k / 2);
        better = try_direction((best + aside).normalized()) || better;
      }
      if (!better) step /= 2;
    }
    if (improved_) set_witnesses();
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
  bool improved_ = false;
};

}  // namespace

void set_depth(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out) {
  Bracketing(question, scratch, out).run();
  out.bracket_reached = out.upper <= (1 + question.settings.delta) * out.lower;
}

}  // namespace pd::detail
