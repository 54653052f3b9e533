/// @file
/// The expanding polytope: the nearest facet of P by growing a surface inside P where it is nearest to the origin.
///
/// Source: the expanding polytope algorithm (EPA) of van den Bergen (2001), with signed distances in front of it and
/// certificates behind it.
///
/// The algorithm, whose numbers stand at the steps below:
///  1. Take the direction in which the depth is expected: the last normal, or away from P's centre.
///  2. Ask for the supports of P in a few directions around it, until four of them span a tetrahedron
///     (initial_simplex.hpp). A support plane that has the origin beyond it shows the bodies separated.
///  3. Take the face f of the surface with the least signed distance from the origin. That distance bounds the depth
///     from below once it is positive: the surface encloses that ball (inner_surface.hpp), and lies in P.
///  4. Where the bound fell by more than rounding explains, the surface has lost its convexity: give up, undecided.
///  5. Ask for the support s of P in the normal n of f.
///  6. <s, n> / |n| bounds the depth from above, whatever n is. Where that may decide, s is certified first, since a
///     search may see single precision only.
///  7. Done where the bounds decide: separated, touching, or a bracket as narrow as asked.
///  8. Give up where s lies on f, so that f's plane supports P and yet the bracket is too wide for doubles (undecided),
///     or where too many facets of P are nearly tied (expansion_budget.hpp).
///  9. Insert s: the faces visible from it go, and a cone over the edge of that region takes their place
///     (inner_surface_insert.cpp). Then step 3.
///
/// The origin may start outside the surface (negative distances), so no separate search for a tetrahedron around it is
/// needed.
///
/// Why it ends: each pass of steps 3 to 9 adds a point of P that lies more than 4 errors outside the plane of the
/// nearest face. A polytope P has finitely many vertices; a smooth P of radius R has no more than (R / error)^3 points
/// that far apart, and `ExpansionGoal::max_steps` bounds the passes besides. Measured: 10 to 40 passes for most pairs,
/// growing like log n for shallow ones and n^0.9 for two concentric balls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "depth/expansion/expansion_budget.hpp"
#include "depth/expansion/expansion_goal.hpp"
#include "depth/expansion/initial_simplex.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

/// Whether every support is within its error of the maximum, so that its height bounds the depth as it is.
template <class Difference>
inline constexpr bool kSupportsCertify = std::is_same_v<Difference, SmoothDifference>;

/// Over any difference that offers `search_support`, `search_support_along`, `search_supports`, `certified_support`,
/// `centre`, `reach`, `point_error` and `support_error`, and for which there is an `initial_cone_sine`
/// (PolytopeDifference, SmoothDifference).
template <class Difference>
class ExpandingPolytope {
 public:
  ExpandingPolytope(const Difference& difference, InnerSurface& surface, std::vector<std::int32_t>& stack)
      : difference_(difference), surface_(surface), stack_(stack) {}

  std::int64_t support_calls() const { return support_calls_; }
  std::int64_t facets_visited() const { return facets_visited_; }
  /// Whether the last `run` began otherwise than `FirstDirections::plain` does.
  bool began_by_shape() const { return by_shape_; }

  /// From scratch; `start` is a direction in which the depth is expected (zero: away from P's centre).
  ExpansionResult run(const Vec3& start, const ExpansionGoal& goal, FirstDirections first = FirstDirections::plain) {
    surface_.clear();
    by_shape_ = false;
    // 1.
    Vec3 direction = start;
    if (!(direction.squaredNorm() > 0)) direction = -difference_.centre();
    const double length = direction.norm();
    // A direction lost in rounding is as good as any.
    direction =
        length > 0x1p-40 * difference_.reach() || start.squaredNorm() > 0 ? Vec3(direction / length) : Vec3::UnitX();
    // 2.
    ExpansionResult result;
    Probe probe{*this, result};
    Vec3 directions[4];
    const double sine = initial_cone_sine(difference_);
    if (first == FirstDirections::by_shape) by_shape_ = directions_by_shape(difference_, start, sine, directions);
    if (!by_shape_) surrounding_directions(direction, sine, directions);
    const bool found = InitialSimplex(surface_, flat_volume(), probe).find(directions, direction, sine) ==
                       InitialSimplexOutcome::found;
    if (found) result = grow(goal, result);
    if (surface_.watch) report_end(surface_.watch, kDoubleArithmetic, result);
    return result;
  }

  /// From the surface as it is (its vertices just recomputed): the warm certificate. Where its points have moved so
  /// that it is no longer convex, growth may lose ground instead of gaining it; then it goes on from the points' hull.
  ExpansionResult resume(const ExpansionGoal& goal) {
    ExpansionGoal convex = goal;
    convex.max_loss = 4 * lower_error();
    convex.loss_from = -std::numeric_limits<double>::infinity();
    ExpansionResult result = grow(convex, ExpansionResult{});
    if (result.status == ExpansionStatus::undecided && surface_.rebuild(flat_volume())) result = grow(goal, result);
    if (surface_.watch) report_end(surface_.watch, kDoubleArithmetic, result);
    return result;
  }

  /// On from where a search stopped `over_budget`, with the bounds that it had; a tighter upper one that the caller has
  /// found may have taken their place.
  ExpansionResult go_on(const ExpansionGoal& goal, const ExpansionResult& from) {
    const ExpansionResult result = grow(goal, from);
    if (surface_.watch) report_end(surface_.watch, kDoubleArithmetic, result);
    return result;
  }

 private:
  /// What the search for the first tetrahedron asks for.
  struct Probe {
    ExpandingPolytope& polytope;
    ExpansionResult& result;

    bool add_support(const Vec3& unit) {
      return polytope.add_if_not_beyond(unit, polytope.difference_.search_support_along(unit), result);
    }
    bool add_support(const Vec3 (&units)[4]) {
      DifferenceVertex supports[4];
      polytope.difference_.search_supports(units, supports);
      for (int k = 0; k < 4; ++k) {
        if (!polytope.add_if_not_beyond(units[k], supports[k], result)) {
          // Found already, and a search for the closest point may begin from them.
          for (int j = k + 1; j < 4; ++j) polytope.surface_.vertices.push_back(supports[j]);
          return false;
        }
      }
      return true;
    }
    bool add_both_supports(const Vec3& unit) { return add_support(unit) && add_support(-unit); }
  };

  /// Adds a support. False when its plane has the origin beyond it: the bodies are separated.
  bool add_if_not_beyond(const Vec3& unit, DifferenceVertex s, ExpansionResult& result) {
    ++support_calls_;
    if (s.x.dot(unit) < 0) {
      s = difference_.certified_support(unit, s, stack_);
      const double height = s.x.dot(unit);
      if (height < -bound_error()) {
        result.status = ExpansionStatus::separated;
        result.upper = height + bound_error();
        result.normal = unit;
        result.separating = s;
        return false;
      }
    }
    surface_.vertices.push_back(s);
    return true;
  }

  /// Steps 3 to 9, at most `goal.max_steps` times.
  ExpansionResult grow(const ExpansionGoal& asked, ExpansionResult result) {
    ExpansionGoal goal = asked;
    double largest = 0;  // asked for by the goals of curved bodies alone
    if constexpr (kSupportsCertify<Difference>) {
      for (const DifferenceVertex& v : surface_.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
    }
    const double error = lower_error();
    double highest = -std::numeric_limits<double>::infinity();
    ExpansionBudget budget(goal.vertices);
    double least = std::numeric_limits<double>::infinity();
    Vec3 least_unit = Vec3::UnitX();
    int f = surface_.nearest();
    for (int step = 0; step < goal.max_steps; ++step) {
      if (step == goal.close_after) goal.relative = std::max(goal.relative, goal.close);
      // 3.
      ++facets_visited_;
      const double key = surface_.key(f);
      const double distance = signed_root(key);
      result.lower = distance - error;
      result.face = f;
      // 4.
      if (result.lower < highest - goal.max_loss && highest > goal.loss_from) return undecided(result);
      if constexpr (kSupportsCertify<Difference>) {
        const double fold = kFold * difference_.reach();
        if (result.lower < highest - fold && highest > -fold) return undecided(result);
      }
      highest = std::max(highest, result.lower);
      // An earlier upper bound may be the least, and no later support need tell.
      if constexpr (kSupportsCertify<Difference>) {
        if (reached(goal, result.lower, result.upper, largest)) {
          result.status = ExpansionStatus::certified;
          return result;
        }
      }
      // 5. The search needs no unit vector, which takes a root and a quotient; both run beside it.
      const Vec3 normal = surface_.normal(f);
      const double squared = normal.squaredNorm();
      if (!(squared > 0)) return undecided(result);
      DifferenceVertex s = difference_.search_support(normal);
      ++support_calls_;
      const Vec3 unit = normal / std::sqrt(squared);
      double height = s.x.dot(unit);
      if (height < least) {
        least = height;
        least_unit = unit;
      }
      if (surface_.watch) [[unlikely]]
        report_step(surface_.watch, kDoubleArithmetic, step, surface_, result, unit, s.x);
      // 6. and 7.
      if (height + bound_error() < result.upper && decide(goal, largest, unit, s, height, result)) return result;
      if constexpr (kSupportsCertify<Difference>) {
        if (height + bound_error() < result.upper) {
          result.upper = height + bound_error();
          result.normal = unit;
          if (result.upper < goal.upper_expected) break;
        }
      }
      // 8.
      if (height - distance <= 4 * error) {
        // On the face, and yet not narrow enough, unless the search saw too little.
        s = difference_.certified_support(unit, s, stack_);
        height = s.x.dot(unit);
        if (height - distance <= 4 * error) return undecided(result);
      }
      if (budget.exhausted(step, distance, height, surface_)) break;
      // 9.
      surface_.vertices.push_back(s);
      if constexpr (kSupportsCertify<Difference>) largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
      f = surface_.insert(f, static_cast<int>(surface_.vertices.size()) - 1, s.x.x(), s.x.y(), s.x.z());
      if (f < 0) return undecided(result);
    }
    result.status = ExpansionStatus::over_budget;
    if (goal.close > 0) take_least(least, least_unit, result);
    return result;
  }

  /// The least height met on the way bounds the depth, too, where nothing decided.
  void take_least(double least, const Vec3& unit, ExpansionResult& result) {
    if (!(least + bound_error() < result.upper)) return;
    const DifferenceVertex s = difference_.certified_support(unit, difference_.search_support_along(unit), stack_);
    ++support_calls_;
    const double upper = s.x.dot(unit) + bound_error();
    if (!(upper < result.upper)) return;
    result.upper = upper;
    result.normal = unit;
  }

  /// Steps 6 and 7: whether the support s, at `height` along `unit`, ends the search. It is certified, and `height`
  /// with it, where its bound may.
  bool decide(const ExpansionGoal& goal, double largest, const Vec3& unit, DifferenceVertex& s, double& height,
              ExpansionResult& result) {
    const double bound = height + bound_error();
    if (!(height < 0 || reached(goal, result.lower, bound, largest) || touches(goal, result.lower, bound, largest))) {
      return false;
    }
    s = difference_.certified_support(unit, s, stack_);
    height = s.x.dot(unit);
    if (height < -bound_error() - std::max(goal.touching * largest, goal.touching_width)) {
      result.status = ExpansionStatus::separated;
      result.upper = height + bound_error();
      result.normal = unit;
      result.separating = s;
      return true;
    }
    if (height + bound_error() < result.upper) {
      result.upper = height + bound_error();
      result.normal = unit;
    }
    if (touches(goal, result.lower, result.upper, largest)) {
      result.status = ExpansionStatus::touching;
      return true;
    }
    if (reached(goal, result.lower, result.upper, largest)) {
      result.status = ExpansionStatus::certified;
      return true;
    }
    return false;
  }

  static ExpansionResult undecided(ExpansionResult result) {
    result.status = ExpansionStatus::undecided;
    return result;
  }

  double lower_error() const { return face_error(difference_); }
  double bound_error() const { return support_plane_error(difference_); }
  /// Error bound of six volumes.
  double flat_volume() const {
    return 64 * kUnitRoundoff * difference_.reach() * difference_.reach() * difference_.reach();
  }

  /// Near contact, where no lower bound is above 0, a face that lies farther beyond the origin than the one before it
  /// by this share of the reach was turned over by rounding. A search would go on from it for thousands of steps.
  static constexpr double kFold = 0x1p-30;

  const Difference& difference_;
  InnerSurface& surface_;
  std::vector<std::int32_t>& stack_;
  bool by_shape_ = false;
  std::int64_t support_calls_ = 0;
  std::int64_t facets_visited_ = 0;
};

/// False for what a face without area has in place of a unit normal.
inline bool is_direction(const Vec3& unit) { return std::abs(unit.squaredNorm() - 1) < 1e-12; }

/// An upper bound on the depth: the height of P along a face's normal.
struct HeightOfFace {
  double upper = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitX();  ///< unit
  int face = -1;
};

/// An upper bound on the depth from a surface whose expansion stopped early: the least height of P, certified, over the
/// normals of the surface's nearest faces. The support in any direction bounds the depth from above, and the nearest
/// faces' directions bound it well. Time: a few supports.
inline HeightOfFace upper_bound_of_nearest_faces(const PolytopeDifference& difference, const InnerSurface& surface,
                                                 std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  constexpr std::size_t kTried = 8;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<std::pair<double, int>, kTried> nearest;
  nearest.fill({kNone, -1});
  for (int f = 0; f < surface.slots(); ++f) {
    if (!(surface.key(f) < nearest.back().first)) continue;
    nearest.back() = {surface.key(f), f};
    for (std::size_t k = kTried - 1; k > 0 && nearest[k].first < nearest[k - 1].first; --k) {
      std::swap(nearest[k], nearest[k - 1]);
    }
  }
  HeightOfFace least;
  for (const auto& [key, f] : nearest) {
    if (f < 0) break;
    const Vec3 unit = surface.normal(f).normalized();
    if (!is_direction(unit)) continue;
    const DifferenceVertex s = difference.certified_support(unit, difference.support(unit, nullptr), stack);
    ++support_calls;
    const double height = s.x.dot(unit) + support_plane_error(difference);
    if (height < least.upper) least = {height, unit, f};
  }
  return least;
}

}  // namespace pd::detail
