#include "depth/pair/polytope_depth.hpp"

#include "depth/facets/box_sat.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

namespace {

constexpr int kBoxAxes = 15;

}  // namespace

void PolytopeQuery::solve() {
  const bool exactly = settings_.bracket == Bracket::tightest && settings_.delta == 0;
  bracket_ = exactly ? Bracket::tightest : Bracket::certified;
  if (settings_.method == Method::overlay) {
    difference_.turn(buffers_.posed);
    solve_by_overlay();
    return;
  }
  doubles_suffice_ = !exactly && settings_.method != Method::decomposition;
  if (doubles_suffice_ && (solve_from_memory() || solve_apart_from_memory())) return;
  if (!exactly && settings_.method == Method::automatic && solve_boxes()) return;
  out_.method = Method::expansion;
  ExpansionResult result;
  if (within_range()) {
    result = expand();
    remember(result);
  }
  if (settings_.method == Method::decomposition && result.status != ExpansionStatus::separated) {
    solve_by_decomposition(result);
    return;
  }
  switch (result.status) {
    case ExpansionStatus::certified:
      if (!exactly && bound_is_of_face(result)) {
        fill_overlapping(result);
      } else if (!solve_by_proof(result)) {
        solve_overlapping_exactly(result);
      }
      return;
    case ExpansionStatus::separated:
      if (!fill_separated(result) || exactly) solve_exactly(result);
      return;
    case ExpansionStatus::over_budget:
      if (result.lower > 0) {
        tighten_upper(result);
        if (!solve_among_ties(result)) solve_by_decomposition(result);
        return;
      }
      [[fallthrough]];
    default:
      if (solve_by_proof(result)) return;
      // A needle's first simplex may be flat to doubles although the bodies are far apart.
      if (result.face < 0 && within_range() && fill_separated(result) && !exactly) return;
      solve_exactly(result);
  }
}

/// Whether the upper bound comes from the side of the nearest face: two facets on opposite sides of the origin may be
/// as far from it to within the bracket.
bool PolytopeQuery::bound_is_of_face(const ExpansionResult& result) const {
  const Vec3 normal = buffers_.surface.normal(result.face);
  return normal.dot(result.normal) > 0.9 * normal.norm();
}

ExpansionGoal PolytopeQuery::goal() const {
  ExpansionGoal goal;
  goal.absolute = kCertifiedWidth;
  goal.relative = settings_.delta;
  goal.vertices = pair_.a->num_vertices() + pair_.b->num_vertices();
  goal.max_steps = ExpansionBudget::max_steps(goal.vertices);
  return goal;
}

/// Two boxes by their axes of separation. False when that does not decide the matter.
bool PolytopeQuery::solve_boxes() {
  const std::optional<BoxFrame> box_a = box_frame(*pair_.a);
  if (!box_a) return false;
  const std::optional<BoxFrame> box_b = box_frame(*pair_.b);
  if (!box_b || !within_range()) return false;
  const BoxPairDepth boxes =
      box_pair_depth(*pair_.a, *box_a, *pair_.pose_a, *pair_.b, *box_b, *pair_.pose_b, kCertifiedWidth);
  out_.method = Method::overlay;
  out_.statistics.facets_visited += kBoxAxes;
  if (boxes.status == BoxPairStatus::separated) {
    difference_.turn(buffers_.posed);
    ExpansionResult result;
    result.normal = boxes.normal;
    return fill_separated(result);
  }
  if (boxes.status == BoxPairStatus::undecided) return false;
  set_depth(boxes.lower, boxes.upper, boxes.normal);
  out_.witness_a = boxes.point_a + pair_.pose_a->translation() - pair_.margins.a * boxes.normal;
  out_.witness_b = out_.witness_a + out_.translation;
  out_.feature_a = boxes.feature_a;
  out_.feature_b = boxes.feature_b;
  return true;
}

ExpansionResult PolytopeQuery::expand() {
  ExpansionResult result;
  const bool restored = warm_ && restore();
  if (restored && doubles_suffice_ && hold(result)) {
    out_.warm = memory_held_ = true;
    return result;
  }
  difference_.turn(buffers_.posed);
  ExpandingPolytope<PolytopeDifference> expansion(difference_, buffers_.surface, buffers_.stack);
  if (restored) {
    result = expansion.resume(goal());
    out_.warm = result.status == ExpansionStatus::certified || result.status == ExpansionStatus::separated;
  }
  if (!out_.warm) {
    const Vec3 start = warm_ ? warm_->state().direction : Vec3(Vec3::Zero());
    result = expansion.run(start, goal());
  }
  out_.statistics.support_calls += expansion.support_calls();
  out_.statistics.facets_visited += expansion.facets_visited();
  return result;
}

void polytope_depth(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers,
                    WarmCertificate* warm, PenetrationDepth& out) {
  PolytopeQuery(pair, settings, buffers, warm, out).solve();
}

}  // namespace pd::detail
