#include "depth/pair/smooth_face.hpp"

#include <cmath>
#include <limits>

#include "depth/expansion/cached_surface.hpp"
#include "depth/expansion/expanding_hull.hpp"
#include "depth/pair/thinnest_axis.hpp"

namespace pd::detail {

namespace {

/// Searches in doubles before an exact hull is made, which takes ten times as long.
constexpr int kMostSearches = 4;

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
  SmoothFaceSearch(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference, bool for_contact,
                   ScratchBuffers& buffers)
      : a_(a),
        b_(b),
        difference_(difference),
        for_contact_(for_contact),
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
    best = expansion_.run(Vec3::Zero(), goal);
    if (best.status == ExpansionStatus::over_budget) tighten_upper(best);
    // What is flat has no surface to go on from.
    const bool started = best.face >= 0 && std::isfinite(best.lower);
    if (best.status == ExpansionStatus::undecided && (for_contact_ || started)) search_again(goal, best);
    statistics.support_calls += expansion_.support_calls();
    statistics.facets_visited += expansion_.facets_visited();
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
  ScratchBuffers& buffers_;
  ExpandingPolytope<SmoothDifference> expansion_;
};

}  // namespace

SmoothFace nearest_smooth_face(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference,
                               ExpansionGoal goal, bool for_contact, ScratchBuffers& buffers, Statistics& statistics) {
  return SmoothFaceSearch(a, b, difference, for_contact, buffers).run(goal, statistics);
}

}  // namespace pd::detail
