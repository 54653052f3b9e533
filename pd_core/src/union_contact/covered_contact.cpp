#include "pd/union_contact/covered_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "pd/contact/time_of_impact.hpp"
#include "union_contact/lazy_points.hpp"
#include "union_contact/piece_exit.hpp"

namespace pd {

using namespace detail;

namespace {

/// cos 25 degrees: what is turned to a facet's own normal without asking whether that is far.
constexpr double kNearNormal = 0.9;
/// Facets tried in place of a covered one.
constexpr std::size_t kTries = 4;
/// Of the reach of exits: the other body may stand so far through the plane of one, beside it.
constexpr double kBeside = 4;
/// Bodies that are in each other by less than this share of the reach of contacts may wait for a step.
constexpr double kSunk = 1.0 / 16;

/// What one side's piece does to the manifold.
class SideRule {
 public:
  SideRule(const PieceSide& side, const PiecePair& pair, double window, double slack)
      : side_(side),
        threshold_(pair.threshold),
        window_(window),
        slack_(slack),
        buffers_(pair.cover),
        manifold_(pair.manifold),
        cover_(side_, slack, window, pair.cover) {}

  /// @return whether `points` was changed
  bool apply(double depth, const Vec3& witness, LazyPoints& points) {
    const Vec3 outward = side_.outward(points.normal());
    if (pushes_from_triangle(outward)) return false;
    cover_.take_own();
    const UnionPiece& own = cover_.own();
    if (own.planes.empty()) return false;
    const Vec3 n = cover_.frame().turn(outward);
    const Vec3 foot = cover_.frame().place(witness - own.margin * outward);
    std::size_t best = 0;
    double cosine = own.planes[0].normal.dot(n);
    for (std::size_t f = 1; f < own.planes.size() - (own.flat ? 3 : 0); ++f) {
      const double other = own.planes[f].normal.dot(n);
      if (other <= cosine) continue;
      best = f;
      cosine = other;
    }
    const bool facet = cosine >= 1 - kSameNormal;
    // Most have nothing near that could cover.
    if (facet && !own.flat) {
      const FacetCover known = cover_.cover_of(best);
      if (known == FacetCover::none) return false;
      if (known == FacetCover::all) {
        points.set(nearest_free(n, depth, foot));
        return true;
      }
    }
    if (!own.flat && ((!facet && !cover_.may_be_covered(foot)) || !cover_.look_round(foot, n))) return false;
    if (facet) return !own.flat && facet_contact(depth, own.planes[best].normal, foot, points.get());
    const double sine = covered_here(foot, n);
    if (sine <= kLevel) return false;
    if (sine < kDecided && (cosine < kNearNormal || is_facet_of_other(outward))) return false;
    points.set(own.flat && cosine >= kNearNormal ? turned(own.planes[best]) : nearest_free(n, depth, foot));
    return true;
  }

 private:
  /// Whether n is the normal of one side of a triangle: nothing covers those, and most contacts end here.
  [[nodiscard]] bool pushes_from_triangle(const Vec3& n) const {
    return is_flat(side_.own) &&
           std::abs((side_.own.pose.rotation() * side_.own.shape->polytope()->facet_normal(0)).dot(n)) >=
               1 - kSameNormal;
  }

  /// Whether the other body meets this one with a facet: -n is its normal then, and no noise.
  [[nodiscard]] bool is_facet_of_other(const Vec3& n) const {
    const ConvexPolytope* polytope = side_.other.shape->polytope();
    if (polytope == nullptr) return false;
    const Vec3 local = -(side_.other.pose.rotation().transpose() * n);
    for (int f = 0; f < polytope->num_facets(); ++f) {
      if (polytope->facet_normal(f).dot(local) >= 1 - kSameNormal) return true;
    }
    return false;
  }

  /// A contact in the middle of a triangle that does not push along its normal is the triangle's own: what lies round
  /// it is not looked for.
  double covered_here(const Vec3& foot, const Vec3& n) {
    const UnionPiece& own = cover_.own();
    if (own.flat) {
      const double own_sine = covered_sine(own, foot, n, slack_, kBeyondDoubt, buffers_.active);
      if (own_sine > kDecided) return own_sine;
      cover_.look_round(foot, n);
    }
    return cover_.covered(foot, n);
  }

  /// A point of the piece's core, in the frame.
  [[nodiscard]] Vec3 foot_of(const ContactPoint& point, const Vec3& n) const {
    return cover_.frame().place(side_.on_piece(point)) - cover_.own().margin * n;
  }

  /// A solid's facet: each point by itself. All stay where none would and yet nothing lies on their middle: a body in a
  /// notch that is narrower than the window.
  bool facet_contact(double depth, const Vec3& n, const Vec3& foot, ContactManifold& points) {
    std::array<bool, 4> covered{};
    Vec3 middle = Vec3::Zero();
    for (int i = 0; i < points.count; ++i) {
      const Vec3 place = foot_of(points.points[static_cast<std::size_t>(i)], n);
      covered[static_cast<std::size_t>(i)] = cover_.covered(place, n) > kDecided;
      middle += place / points.count;
    }
    const auto dropped = std::count(covered.begin(), covered.end(), true);
    if (dropped == 0 || (dropped == points.count && cover_.lies_free(middle, n))) return false;
    for (int i = points.count - 1; i >= 0; --i) {
      if (covered[static_cast<std::size_t>(i)]) drop_point(points, i);
    }
    if (points.count == 0) points = nearest_free(n, depth, foot);
    return true;
  }

  /// Out along a facet of the piece.
  [[nodiscard]] PieceExit exit_over(const PiecePlane& facet) const {
    const Vec3 n = cover_.frame().turn_back(facet.normal);
    const Vec3 farthest = farthest_point(side_.other, -n);
    const double depth =
        side_.other.shape->margin() + cover_.own().margin - facet.height(cover_.frame().place(farthest));
    return exit_along(side_, n, depth, farthest);
  }

  /// Out against a facet of the other body, a solid polytope.
  [[nodiscard]] PieceExit exit_against(int facet) const {
    const ConvexPolytope& polytope = *side_.other.shape->polytope();
    const Vec3 against = side_.other.pose.rotation() * polytope.facet_normal(facet);
    const Vec3 on_facet = side_.other.pose.apply(polytope.vertex(polytope.facet_vertices(facet)[0]));
    const Vec3 farthest = farthest_point(side_.own, -against);
    const double depth = side_.other.shape->margin() + side_.own.shape->margin() + against.dot(on_facet - farthest);
    const Vec3 on_own = farthest - side_.own.shape->margin() * against;
    return {depth, -against, on_own, on_own + depth * against};
  }

  ContactManifold manifold_along(const PieceExit& exit) {
    return points_along(exit, side_, cover_.frame(), cover_.own(), threshold_, slack_, manifold_);
  }

  ContactManifold turned(const PiecePlane& facet) {
    const PieceExit exit = exit_over(facet);
    return exit.depth < -threshold_ ? ContactManifold() : manifold_along(exit);
  }

  /// The contact along the nearest facet of the piece, but that of n, that is not covered and lies within reach. Of
  /// solids that are in each other and have none, also along one that the other body reaches through beside it, or
  /// against one of the other body's.
  ContactManifold nearest_free(const Vec3& n, double depth, const Vec3& foot) {
    const UnionPiece& own = cover_.own();
    std::vector<std::pair<double, int>>& facets = buffers_.facets;
    facets.clear();
    const double limit = std::max(4 * depth, window_);
    const int count = static_cast<int>(own.planes.size()) - (own.flat ? 3 : 0);
    for (int f = 0; f < count; ++f) {
      const PiecePlane& facet = own.planes[static_cast<std::size_t>(f)];
      if (facet.normal.dot(n) >= 1 - kSameNormal || facet.normal.dot(side_.front) < 0) continue;
      const double far = exit_over(facet).depth;
      if (far < -threshold_) return {};  // apart along a facet: nothing of this piece is near
      if (far <= kBeside * limit) facets.emplace_back(far, f);
    }
    std::sort(facets.begin(), facets.end());
    // A triangle is left by the nearer of its sides or not at all: it does not lie below a body that would leave it by
    // the other.
    if (own.flat && facets.size() > 1) facets.resize(1);
    bool looked = own.flat;
    const auto within =
        std::partition_point(facets.begin(), facets.end(), [&](const auto& facet) { return facet.first <= limit; });
    ContactManifold points = first_free(
        std::span<const std::pair<double, int>>(facets).first(static_cast<std::size_t>(within - facets.begin())), foot,
        looked);
    const ConvexPolytope* const other = side_.other.shape->polytope();
    const bool solids = !own.flat && other != nullptr && other->affine_dimension() == 3;
    if (points.count > 0 || !solids || depth < kSunk * threshold_) return points;
    facets.erase(facets.begin(), within);
    const Vec3 outward = cover_.frame().turn_back(n);
    for (int f = 0; f < other->num_facets(); ++f) {
      const PieceExit exit = exit_against(f);
      if (exit.depth < -threshold_) return {};
      if (exit.depth > kBeside * limit || exit.n.dot(outward) >= 1 - kSameNormal) continue;
      facets.emplace_back(exit.depth, count + f);
    }
    std::sort(facets.begin(), facets.end());
    points = first_free(facets, foot, looked);
    return points.count > 0 && deepest_of(points) <= limit ? points : ContactManifold();
  }

  /// The points along the first of these exits, by depth, where any is not covered.
  /// @param facets  from the piece's number of facets on, those of the other body
  ContactManifold first_free(std::span<const std::pair<double, int>> facets, const Vec3& foot, bool& looked) {
    const UnionPiece& own = cover_.own();
    const int count = static_cast<int>(own.planes.size()) - (own.flat ? 3 : 0);
    for (std::size_t i = 0; i < std::min(kTries, facets.size()); ++i) {
      const int f = facets[i].second;
      const FacetCover known = f < count ? cover_.cover_of(static_cast<std::size_t>(f)) : FacetCover::some;
      if (known == FacetCover::all) continue;
      const PieceExit exit = f < count ? exit_over(own.planes[static_cast<std::size_t>(f)]) : exit_against(f - count);
      const Vec3 along = f < count ? own.planes[static_cast<std::size_t>(f)].normal : cover_.frame().turn(exit.n);
      ContactManifold points = manifold_along(exit);
      if (points.count == 0) continue;
      if (known == FacetCover::none) return points;
      if (!looked) {
        cover_.look_round(foot, Vec3::Zero());
        looked = true;
      }
      for (int k = points.count - 1; k >= 0 && !own.flat; --k) {
        if (cover_.covered(foot_of(points.points[static_cast<std::size_t>(k)], along), along) > kDecided) {
          drop_point(points, k);
        }
      }
      if (points.count > 0) return points;
    }
    return {};
  }

  const PieceSide& side_;
  double threshold_;
  double window_;
  double slack_;
  CoverBuffers& buffers_;
  ManifoldScratch& manifold_;
  Cover cover_;
};

/// How far from a contact a union is looked at: as far as the bodies may move before contacts are found again.
double window_of(const PiecePair& pair, double depth) { return pair.threshold + std::abs(depth) + pair.way; }

}  // namespace

int keep_uncovered(const PiecePair& pair, const PenetrationDepth& answer, AnswerPoints given, ContactManifold& points) {
  LazyPoints lazy(pair, answer, given, points);
  if (lazy.none()) return 0;
  const double slack = seam_slack(pair.a, pair.b, pair.pose_rounding);
  double depth = -answer.signed_distance();
  const double window = window_of(pair, depth);
  Vec3 witness_b = answer.witness_b;
  int changed = 0;
  if (pair.around_b != nullptr) {
    const PieceSide side{*pair.around_b, pair.b, pair.a, true, pair.front};
    SideRule rule(side, pair, window, slack);
    if (rule.apply(depth, witness_b, lazy)) {
      ++changed;
      if (points.count == 0) return changed;
      const auto deepest = std::max_element(points.points.begin(), points.points.begin() + points.count,
                                            [](const auto& x, const auto& y) { return x.depth < y.depth; });
      depth = deepest->depth;
      witness_b = deepest->position_b;
    }
  }
  if (pair.around_a != nullptr) {
    const PieceSide side{*pair.around_a, pair.a, pair.b, false};
    SideRule rule(side, pair, window, slack);
    if (rule.apply(depth, witness_b - depth * lazy.normal(), lazy)) ++changed;
  }
  lazy.get();
  return changed;
}

int drop_covered(const PiecePair& pair, ContactManifold& points) {
  const double slack = seam_slack(pair.a, pair.a, pair.pose_rounding);
  const PieceSide side{*pair.around_a, pair.a, pair.a, false};
  const int before = points.count;
  for (int i = points.count - 1; i >= 0; --i) {
    const ContactPoint& point = points.points[static_cast<std::size_t>(i)];
    Cover cover(side, slack, window_of(pair, point.depth), pair.cover);
    cover.take_own();
    if (cover.own().planes.empty()) break;
    const Vec3 n = cover.frame().turn(-points.normal);
    const Vec3 foot = cover.frame().place(point.position_a) - cover.own().margin * n;
    if (cover.look_round(foot, n) && cover.covered(foot, n) > kDecided) drop_point(points, i);
  }
  return before - points.count;
}

ContactManifold along_front(const PiecePair& pair, FrontPoints which) {
  UnionPiece& own = pair.cover.made;
  set_piece(pair.b, own);
  if (own.planes.empty()) return {};
  const PiecePlane& side = own.planes[own.planes[0].normal.dot(pair.front) > 0 ? 0 : 1];
  const Vec3 farthest = farthest_point(pair.a, -side.normal);
  const double depth = pair.a.shape->margin() + own.margin - side.height(farthest);
  const PieceSide sides{*pair.around_b, pair.b, pair.a, true, pair.front};
  const PieceExit exit = exit_along(sides, side.normal, depth, farthest);
  ContactManifold points =
      points_along(exit, sides, {}, own, pair.threshold, seam_slack(pair.a, pair.b, pair.pose_rounding), pair.manifold);
  if (points.count == 0 && which == FrontPoints::any) {
    points.normal = exit.n;
    points.points[0] = {exit.on_other, exit.on_own, depth, 0};
    points.count = 1;
  }
  return points;
}

}  // namespace pd
