#include "solid/overlap_depth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid/surface_distance.hpp"
#include "solid/winding.hpp"

namespace pd::detail {

namespace {

/// Pairs of convex parts that a depth may be told by; more take seconds and minutes.
constexpr std::int64_t kMostPairs = 4096;

void take(const PenetrationDepth& from, SolidDepth& out) {
  static_cast<PenetrationDepth&>(out) = from;
  out.feature_a = out.feature_b = {};
}

/// The depth of the unions of convex parts that lie in the solids is a lower bound, that of the unions that cover them
/// an upper one.
bool set_by_parts(const PosedSolid& a, const PosedSolid& b, const SolidSettings& settings, Scratch& scratch,
                  SolidDepth& out) {
  const auto parts_of = [](const MeshSolid& solid) {
    return SolidParts::from_solid(solid, {.parts = kMostPairs / 4, .polygons = 10'000});
  };
  const Expected<SolidParts> parts_a = parts_of(*a.solid);
  if (!parts_a) return false;
  const Expected<SolidParts> parts_b = parts_of(*b.solid);
  if (!parts_b) return false;
  const auto count = [](const Compound& compound) { return static_cast<std::int64_t>(compound.parts().size()); };
  if (count(parts_a->outer()) * count(parts_b->outer()) > kMostPairs) return false;
  UnionSettings exactly;
  exactly.delta = settings.delta;
  const Expected<UnionDepth> outer =
      penetration_depth({&parts_a->outer(), a.pose}, {&parts_b->outer(), b.pose}, scratch, exactly);
  if (!outer || outer->contact != ContactClass::overlapping) return false;
  take(*outer, out);
  out.work.parts_a = count(parts_a->outer());
  out.work.parts_b = count(parts_b->outer());
  out.exact = parts_a->exact() && parts_b->exact();
  if (out.exact) return true;
  const Expected<UnionDepth> inner =
      penetration_depth({&parts_a->inner(), a.pose}, {&parts_b->inner(), b.pose}, scratch, exactly);
  out.lower = inner && inner->contact == ContactClass::overlapping ? std::min(inner->lower, out.upper) : 0;
  return true;
}

// ---- without parts -----------------------------------------------------------------------------------------------

/// Balls about one point, one inside of each solid, of radii r and s: the solids overlap while A moves by less than
/// r + s.
class BallSearch {
 public:
  explicit BallSearch(const PosedSolids& solids) : solids_(solids) {}

  double run() {
    for (const Body body : {Body::a, Body::b}) {
      const auto& vertices = solids_.solid(body).vertices();
      const std::size_t step = std::max<std::size_t>(1, vertices.size() / kMostVertices);
      for (std::size_t v = 0; v < vertices.size(); v += step) {
        try_vertex(body, static_cast<std::int32_t>(v));
      }
    }
    return best_;
  }

 private:
  static constexpr std::size_t kMostVertices = 400;

  /// A vertex belongs to its own closed solid.
  void try_vertex(Body body, std::int32_t vertex) {
    const PosedPoint p = solids_.point(body, vertex);
    const double radius = distance_to_surface(solids_, other(body), p.x, best_);
    if (radius <= best_) return;
    const PointPlace place = place_in(solids_, other(body), p);
    if (!place.on_surface && place.winding > 0) best_ = radius;
  }

  const PosedSolids& solids_;
  double best_ = 0;
};

/// A translation that separates the hulls separates the solids.
void set_by_hulls(const PosedSolid& a, const PosedSolid& b, const PosedSolids& solids, Scratch& scratch,
                  SolidDepth& out) {
  const ConvexShape hull_a = *ConvexPolytope::from_points(a.solid->vertices());
  const ConvexShape hull_b = *ConvexPolytope::from_points(b.solid->vertices());
  take(penetration_depth({&hull_a, a.pose}, {&hull_b, b.pose}, scratch, {.bracket = Bracket::tightest}), out);
  out.exact = false;
  out.lower = std::min(out.upper, std::ldexp(BallSearch(solids).run(), solids.scale_exponent()));
}

}  // namespace

std::optional<Error> set_depth(const PosedSolid& a, const PosedSolid& b, const PosedSolids& solids,
                               const SolidSettings& settings, Scratch& scratch, SolidDepth& out) {
  if (!set_by_parts(a, b, settings, scratch, out)) set_by_hulls(a, b, solids, scratch, out);
  out.bracket_reached = out.upper <= (1 + settings.delta) * out.lower;
  return std::nullopt;
}

}  // namespace pd::detail
