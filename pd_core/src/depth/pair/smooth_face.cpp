#include "depth/pair/smooth_face.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "depth/expansion/cached_surface.hpp"
#include "depth/expansion/expanding_hull.hpp"
#include "depth/features/local_minimum.hpp"
#include "depth/features/thinnest_axis.hpp"

namespace pd::detail {

namespace {

/// Searches in doubles before an exact hull is made, which takes ten times as long.
constexpr int kMostSearches = 4;

/// Steps before a local minimum is looked for near the nearest face, again and again, and steps around one.
constexpr int kFirstSteps = 3;
constexpr int kFurtherSteps = 3;
constexpr int kMostMinima = 6;
constexpr int kStepsAroundMinimum = 96;
/// Times that another minimum may turn out to be less.
constexpr int kMostOthers = 2;
/// The apex of a cone stands for directions this much farther from its axis than the cone's own.
constexpr double kApexInside = 1 + 0x1p-12;

bool is_close(const ExpansionResult& found) {
  return found.face >= 0 && found.lower > 0 && found.upper - found.lower <= kContactClose * found.upper;
}

/// As narrow as asked, where a search ended for another reason.
bool is_reached(const ExpansionGoal& goal, ExpansionResult& found) {
  if (!(found.face >= 0 && found.lower > 0 && found.upper <= (1 + goal.relative) * found.lower)) return false;
  found.status = ExpansionStatus::certified;
  return true;
}

class SmoothFaceSearch {
 public:
  SmoothFaceSearch(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference, FacePurpose purpose,
                   ScratchBuffers& buffers)
      : a_(a),
        b_(b),
        difference_(difference),
        for_contact_(purpose == FacePurpose::contact),
        wants_foot_(purpose == FacePurpose::foot),
        buffers_(buffers),
        expansion_(difference, buffers.surface, buffers.stack) {}

  SmoothFace run(ExpansionGoal goal, Statistics& statistics) {
    SmoothFace nearest;
    nearest.searched = &buffers_.surface.vertices;
    goal.max_steps = kMaxSmoothSteps;
    if (for_contact_) {
      goal.close = kContactClose;
      goal.close_after = ContactBudget::kCurvedStepsToFull;
      goal.max_steps = ContactBudget::kCurvedSteps;
    }
    goal.max_loss = 4 * difference_.point_error();
    ExpansionResult& best = nearest.found;
    best =
        wants_foot_ ? run_around_minimum(Vec3::Zero(), goal, kMostOthers, nearest) : expansion_.run(Vec3::Zero(), goal);
    if (best.status == ExpansionStatus::over_budget) tighten_upper(best);
    // What is flat has no surface to go on from.
    const bool started = best.face >= 0 && std::isfinite(best.lower);
    if (best.status == ExpansionStatus::undecided && (for_contact_ || started)) search_again(goal, best);
    statistics.support_calls += expansion_.support_calls();
    statistics.facets_visited += expansion_.facets_visited();
    if (nearest.foot_known) return nearest;
    if (best.face >= 0) {
      const SurfaceTriangle& face = buffers_.surface.face(best.face);
      for (int i = 0; i < 3; ++i) nearest.corners[i] = buffers_.surface.vertices[face.v[i]];
    }
    if (best.status != ExpansionStatus::undecided || (for_contact_ && is_close(best))) return nearest;
    if (for_contact_) goal.max_steps = ContactBudget::kExactSteps;
    best = expand_exact_hull(difference_, buffers_.exact_hull, best.normal, goal, statistics.support_calls,
                             buffers_.surface.watch);
    if (best.face >= 0) {
      nearest.searched = &buffers_.exact_hull.vertices;
      const ExactHull::Face& face = buffers_.exact_hull.face(best.face);
      for (int i = 0; i < 3; ++i) {
        nearest.corners[i] = buffers_.exact_hull.vertices[static_cast<std::size_t>(face.v[i])];
      }
    }
    return nearest;
  }

 private:
  /// Steps of the expansion until a minimum near the nearest face has a cone of its own; then the others around it.
  ///
  /// The cone is put into the surface as a point p beyond P, its apex at `lower` / cos of its half angle: <p, n>
  /// reaches `lower` in the cone only. A surface that encloses the ball of radius r <= `lower` with it shows of every
  /// direction that P's height is at least r: by one of P's points, or because it lies in the cone, where no height is
  /// below `lower`.
  ExpansionResult run_around_minimum(const Vec3& direction, const ExpansionGoal& goal, int others,
                                     SmoothFace& nearest) {
    ExpansionGoal some = goal;
    some.max_steps = kFirstSteps;
    ExpansionResult result = expansion_.run(direction, some);
    for (int i = 0; i < kMostMinima && result.status == ExpansionStatus::over_budget; ++i) {
      const std::optional<LocalMinimum> minimum = minimum_near_face(goal);
      if (minimum && insert_apex(*minimum)) return expand_around(*minimum, goal, result, others, nearest);
      some.max_steps = kFurtherSteps;
      result = expansion_.go_on(some, result);
    }
    if (result.status != ExpansionStatus::over_budget) return result;
    some.max_steps = goal.max_steps - static_cast<int>(expansion_.support_calls());
    return expansion_.go_on(some, result);
  }

  [[nodiscard]] std::optional<LocalMinimum> minimum_near_face(const ExpansionGoal& goal) const {
    const InnerSurface& surface = buffers_.surface;
    const Vec3 unit = surface.normal(surface.nearest()).normalized();
    if (!is_direction(unit)) return std::nullopt;
    const SurfaceTriangle& face = surface.face(surface.nearest());
    const DifferenceVertex corners[3] = {surface.vertices[face.v[0]], surface.vertices[face.v[1]],
                                         surface.vertices[face.v[2]]};
    return local_minimum(difference_, corners, unit, goal.relative);
  }

  bool insert_apex(const LocalMinimum& minimum) {
    const double cosine = minimum.cosine * kApexInside;
    if (!(cosine < 1)) return false;
    const Vec3 apex = (minimum.lower / cosine) * minimum.normal;
    InnerSurface& surface = buffers_.surface;
    const int f = surface.first_face_below(apex);
    if (f < 0) return false;
    surface.vertices.push_back({apex, -1, -1});
    return surface.insert(f, static_cast<int>(surface.vertices.size()) - 1);
  }

  /// Anew where another minimum is less, without cones where rounding spoils the surface.
  ExpansionResult expand_around(const LocalMinimum& minimum, const ExpansionGoal& goal, const ExpansionResult& before,
                                int others, SmoothFace& nearest) {
    ExpansionGoal around = goal;
    around.max_steps = kStepsAroundMinimum;
    around.upper_expected = minimum.lower;
    ExpansionResult start = before;
    if (minimum.upper < start.upper) {
      start.upper = minimum.upper;
      start.normal = minimum.normal;
    }
    ExpansionResult result = expansion_.go_on(around, start);
    const bool is_least = result.status == ExpansionStatus::certified && result.normal == minimum.normal;
    if (!is_least || !(result.lower * kApexInside >= minimum.lower)) {
      const bool other = others > 0 && result.upper < minimum.lower;
      return other ? run_around_minimum(result.normal, goal, others - 1, nearest) : expansion_.run(result.normal, goal);
    }
    result.lower = std::min(result.lower, minimum.lower);
    nearest.foot_known = true;
    std::copy(std::begin(minimum.corners), std::end(minimum.corners), nearest.corners);
    std::copy(std::begin(minimum.weights), std::end(minimum.weights), nearest.weights);
    return result;
  }

  /// Where rounding folded the surface (corners of discs, all in one plane): on from the hull of its points, which
  /// does for nine of ten, or anew from the nearest way out so far. All searches share one budget.
  void search_again(ExpansionGoal goal, ExpansionResult& best) {
    const double max_loss = goal.max_loss;
    const int most_steps = for_contact_ ? ContactBudget::kCurvedSteps : kMaxSmoothSteps;
    for (int search = 1; search < kMostSearches; ++search) {
      tighten_upper(best);
      if (for_contact_ ? is_close(best) : is_reached(goal, best)) return;
      const int left = most_steps - static_cast<int>(expansion_.support_calls());
      if (left <= 0) return;
      const Vec3 normal = best.normal;
      goal.max_steps = left;
      goal.max_loss = max_loss;
      best = search % 2 == 1 ? expansion_.resume(goal) : expansion_.run(normal, goal);
      if (best.status == ExpansionStatus::over_budget) tighten_upper(best);
      if (best.status != ExpansionStatus::undecided) return;
      if (!(best.upper < std::numeric_limits<double>::infinity())) best.normal = normal;
    }
    tighten_upper(best);
  }

  /// A search that was ended has bounds from below only, but for those that looked decisive: any support is one.
  void tighten_upper(ExpansionResult& best) const {
    WayOut out = thinnest_axis(a_, b_, difference_);
    const Vec3 unit = best.face >= 0 ? Vec3(buffers_.surface.normal(best.face).normalized()) : Vec3(Vec3::Zero());
    if (is_direction(unit)) {
      const double height = difference_.support(unit, nullptr).x.dot(unit) + support_plane_error(difference_);
      if (height < out.upper) out = {unit, height};
    }
    if (out.upper < best.upper) {
      best.upper = out.upper;
      best.normal = out.normal;
    }
  }

  const PosedShape& a_;
  const PosedShape& b_;
  const SmoothDifference& difference_;
  bool for_contact_;
  bool wants_foot_;
  ScratchBuffers& buffers_;
  ExpandingPolytope<SmoothDifference> expansion_;
};

}  // namespace

SmoothFace nearest_smooth_face(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference,
                               ExpansionGoal goal, FacePurpose purpose, ScratchBuffers& buffers,
                               Statistics& statistics) {
  return SmoothFaceSearch(a, b, difference, purpose, buffers).run(goal, statistics);
}

}  // namespace pd::detail
