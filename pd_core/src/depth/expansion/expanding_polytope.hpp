/// @file
/// Signed certified best-first expansion: the nearest facet of P by growing a surface inside P where it is nearest.
///
/// The faces of a surface of points of P are keyed by the signed distance of their planes from the origin. The least
/// one, f, asks for the support s of P in its normal: <s, n> / |n| bounds the depth from above for any n; s is inserted
/// unless it lies on f. At the end every face is at least as far as f, the surface encloses that ball
/// (inner_surface.hpp), and f's plane supports P: the depth. The origin may start outside the surface (negative keys),
/// so no separate search for a first simplex round it is needed; h_P(n) < 0 shows the bodies apart.
///
/// Source: the expanding polytope algorithm of van den Bergen (2001), with signed distances in front of it and
/// certificates behind it. Each step adds a vertex of P, so it ends; measured steps: 10-40 for most pairs, growing like
/// log n for shallow ones and n^0.9 for two concentric balls.
#pragma once

#include <cmath>
#include <limits>

#include "depth/expansion/expansion_budget.hpp"
#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

enum class ExpansionStatus : std::uint8_t {
  certified,   ///< 0 < lower <= depth <= upper, the bracket as narrow as asked
  separated,   ///< h_P(normal) < 0 for certain
  touching,    ///< |signed distance| <= goal.touching times the largest |coordinate| seen (smooth bodies)
  undecided,   ///< doubles cannot tell (touching, flat, or bracket not reached): exact arithmetic must
  over_budget  ///< too many nearly equal facets: the overlay is faster
};

struct ExpansionResult {
  ExpansionStatus status = ExpansionStatus::undecided;
  double lower = 0;  ///< -infinity when nothing is known
  double upper = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitX();  ///< unit, of `upper` (or of the separating plane)
  int face = -1;                ///< nearest face of the surface, -1 when separated
};

struct ExpansionGoal {
  double relative = 0;  ///< stop when upper <= (1 + relative) lower
  double absolute = 0;  ///< or when upper - lower <= absolute times the largest |coordinate| seen
  double touching = 0;  ///< see ExpansionStatus::touching
  int budget = std::numeric_limits<int>::max();
  int vertices = 0;  ///< of both bodies, for ExpansionBudget; 0: given up after `budget` steps only
  /// `undecided` when a lower bound above `fold_from` falls by more than `fold`: the surface has folded.
  double fold = std::numeric_limits<double>::infinity();
  double fold_from = 0;
};

/// Two directions that span the plane across d (unit) with it, without a root (Duff et al. 2017).
inline void frame_across(const Vec3& d, Vec3& u, Vec3& w) {
  const double sign = std::copysign(1.0, d.z());
  const double a = -1 / (sign + d.z());
  const double b = d.x() * d.y() * a;
  u = {1 + sign * d.x() * d.x() * a, sign * b, -sign * d.x()};
  w = {b, sign + d.y() * d.y() * a, -d.y()};
}

/// Three directions round d (unit), each at the angle of this sine from it (below a right one), and the one opposite:
/// 120 degrees apart as seen along d.
inline void surrounding_directions(const Vec3& d, double sine, Vec3 (&out)[4]) {
  constexpr double kHeight = 0.86602540378443864676;  // sqrt(3) / 2
  Vec3 u, w;
  frame_across(d, u, w);
  const Vec3 axial = std::sqrt(1 - sine * sine) * d;
  out[0] = axial + sine * u;
  out[1] = axial - 0.5 * sine * u + kHeight * sine * w;
  out[2] = axial - 0.5 * sine * u - kHeight * sine * w;
  out[3] = -d;
}

/// Whether a bracket is as narrow as asked; `largest` as in ExpansionGoal::absolute.
inline bool reached(const ExpansionGoal& goal, double lower, double upper, double largest) {
  return lower > 0 && (upper - lower <= goal.absolute * largest || upper <= (1 + goal.relative) * lower);
}

/// Expansion over any difference that offers `search_support`, `search_support_along`, `search_supports`,
/// `certified_support`, `centre`, `reach`, `spread`, `point_error` and `support_error` (PolytopeDifference,
/// SmoothDifference).
template <class Difference>
class Expansion {
 public:
  Expansion(const Difference& difference, Surface& surface, std::vector<std::int32_t>& stack)
      : difference_(difference), surface_(surface), stack_(stack) {}

  std::int64_t support_calls() const { return support_calls_; }
  std::int64_t facets_visited() const { return facets_visited_; }

  /// From scratch; `start` is a direction in which the depth is expected (zero: away from P's centre).
  ExpansionResult run(const Vec3& start, const ExpansionGoal& goal) {
    surface_.clear();
    Vec3 direction = start;
    if (!(direction.squaredNorm() > 0)) direction = -difference_.centre();
    const double length = direction.norm();
    // A direction lost in rounding is as good as any.
    direction =
        length > 0x1p-40 * difference_.reach() || start.squaredNorm() > 0 ? Vec3(direction / length) : Vec3::UnitX();
    ExpansionResult result;
    if (!first_simplex(direction, result)) return result;
    return grow(goal, result);
  }

  /// From the surface as it is (its vertices just recomputed): the warm certificate. Where its points have moved so
  /// that it is no longer convex, growth may lose ground instead of gaining it; then it goes on from the points' hull.
  ExpansionResult resume(const ExpansionGoal& goal) {
    ExpansionGoal convex = goal;
    convex.fold = 4 * lower_error();
    convex.fold_from = -std::numeric_limits<double>::infinity();
    if (surface_.size() <= kMostStraightened) surface_.straighten();
    const ExpansionResult result = grow(convex, ExpansionResult{});
    if (result.status != ExpansionStatus::undecided || !surface_.rebuild(flat_volume())) return result;
    return grow(goal, result);
  }

 private:
  /// Adds the support in a direction. False when it shows the bodies apart.
  bool look(const Vec3& unit, ExpansionResult& result) {
    return take(unit, difference_.search_support_along(unit), result);
  }
  bool look(const Vec3 (&units)[4], ExpansionResult& result) {
    DifferenceVertex supports[4];
    difference_.search_supports(units, supports);
    for (int k = 0; k < 4; ++k) {
      if (!take(units[k], supports[k], result)) return false;
    }
    return true;
  }
  bool take(const Vec3& unit, DifferenceVertex s, ExpansionResult& result) {
    ++support_calls_;
    if (s.x.dot(unit) < 0) {
      s = difference_.certified_support(unit, s, stack_);
      const double height = s.x.dot(unit);
      if (height < -bound_error()) {
        result.status = ExpansionStatus::separated;
        result.upper = height + bound_error();
        result.normal = unit;
        return false;
      }
    }
    add_vertex(s);
    return true;
  }
  bool look_both_ways(const Vec3& unit, ExpansionResult& result) { return look(unit, result) && look(-unit, result); }

  bool first_simplex(const Vec3& direction, ExpansionResult& result) {
    const double sine = difference_.spread();
    Vec3 directions[4];
    surrounding_directions(direction, sine, directions);
    if (!look(directions, result)) return false;
    const double flat = flat_volume();
    if (surface_.start_tetrahedron(flat)) return true;
    // Repeated or nearly coplanar vertices: look farther round, in between the first three.
    for (const double wider : {std::min(3 * sine, 0.8), 1.0}) {
      surrounding_directions(direction, -wider, directions);
      for (int i = 0; i < 3; ++i) {
        if (!look(directions[i], result)) return false;
      }
      if (surface_.start_from_spread_vertices(flat)) return true;
    }
    // Then along the axes and along the normals that the vertices leave open. Nearly all directions see but the two
    // ends of a needle; those across it see its sides.
    for (int axis = 0; axis < 3; ++axis) {
      if (!look_both_ways(Vec3::Unit(axis), result)) return false;
    }
    if (surface_.start_from_spread_vertices(flat)) return true;
    const std::vector<DifferenceVertex>& v = surface_.vertices;
    std::int32_t ids[4];
    surface_.find_spread_vertices(flat, ids);
    const Vec3 along = v[ids[1]].x - v[ids[0]].x;
    if (along.squaredNorm() > 0) {
      const Vec3 across = along.unitOrthogonal();
      if (!look_both_ways(across, result) || !look_both_ways(along.cross(across).normalized(), result)) return false;
      if (surface_.start_from_spread_vertices(flat)) return true;
      surface_.find_spread_vertices(flat, ids);
      const Vec3 normal = (v[ids[1]].x - v[ids[0]].x).cross(v[ids[2]].x - v[ids[0]].x);
      if (normal.squaredNorm() > 0) {
        if (!look_both_ways(normal.normalized(), result)) return false;
        if (surface_.start_from_spread_vertices(flat)) return true;
      }
    }
    result.status = ExpansionStatus::undecided;
    return false;
  }

  ExpansionResult grow(const ExpansionGoal& goal, ExpansionResult result) {
    double largest = 0;
    for (const DifferenceVertex& v : surface_.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
    const double error = lower_error();
    double highest = goal.fold_from;
    ExpansionBudget budget(goal.vertices);
    int f = surface_.nearest();
    for (int step = 0; step < goal.budget; ++step) {
      ++facets_visited_;
      const double key = surface_.key(f);
      const double distance = key >= 0 ? std::sqrt(key) : -std::sqrt(-key);
      result.lower = distance - error;
      result.face = f;
      if (result.lower < highest - goal.fold && highest > goal.fold_from) return undecided(result);
      highest = std::max(highest, result.lower);
      const Vec3 normal = surface_.normal(f);
      const double squared = normal.squaredNorm();
      if (!(squared > 0)) return undecided(result);
      // The search needs no unit vector, which takes a root and a quotient; both run beside it.
      DifferenceVertex s = difference_.search_support(normal);
      ++support_calls_;
      const Vec3 unit = normal / std::sqrt(squared);
      double height = s.x.dot(unit);
      if (height + bound_error() < result.upper) {
        // A bound is worth proving when it may decide the matter.
        if (height < 0 || reached(goal, result.lower, height + bound_error(), largest) ||
            touches(goal, result.lower, height + bound_error(), largest)) {
          s = difference_.certified_support(unit, s, stack_);
          height = s.x.dot(unit);
          if (height < -bound_error() - goal.touching * largest) {
            result.status = ExpansionStatus::separated;
            result.upper = height + bound_error();
            result.normal = unit;
            return result;
          }
          if (height + bound_error() < result.upper) {
            result.upper = height + bound_error();
            result.normal = unit;
          }
          if (touches(goal, result.lower, result.upper, largest)) {
            result.status = ExpansionStatus::touching;
            return result;
          }
          if (reached(goal, result.lower, result.upper, largest)) {
            result.status = ExpansionStatus::certified;
            return result;
          }
        }
      }
      if (height - distance <= 4 * error) {
        // On the face, and yet not narrow enough, unless the search saw too little.
        s = difference_.certified_support(unit, s, stack_);
        height = s.x.dot(unit);
        if (height - distance <= 4 * error) return undecided(result);
      }
      if (budget.spent(step, distance, height, surface_)) break;
      add_vertex(s);
      largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
      f = surface_.insert(f, static_cast<int>(surface_.vertices.size()) - 1, s.x.x(), s.x.y(), s.x.z());
      if (f < 0) return undecided(result);
    }
    result.status = ExpansionStatus::over_budget;
    return result;
  }

  static bool touches(const ExpansionGoal& goal, double lower, double upper, double largest) {
    return upper <= goal.touching * largest && lower >= -goal.touching * largest;
  }
  static ExpansionResult undecided(ExpansionResult result) {
    result.status = ExpansionStatus::undecided;
    return result;
  }

  void add_vertex(const DifferenceVertex& s) { surface_.vertices.push_back(s); }

  double lower_error() const { return face_error(difference_); }
  double bound_error() const { return support_plane_error(difference_); }
  /// Error bound of six volumes.
  double flat_volume() const { return 64 * 0x1p-53 * difference_.reach() * difference_.reach() * difference_.reach(); }

  /// Larger surfaces are rebuilt where they fold, which makes them smaller: measured on coherent frames.
  static constexpr int kMostStraightened = 40;

  const Difference& difference_;
  Surface& surface_;
  std::vector<std::int32_t>& stack_;
  std::int64_t support_calls_ = 0;
  std::int64_t facets_visited_ = 0;
};

}  // namespace pd::detail
