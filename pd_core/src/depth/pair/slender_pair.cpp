#include "depth/pair/slender_pair.hpp"

#include "depth/certificate/exact_answer.hpp"
#include "depth/features/nearest_of_segments.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

namespace {

/// The cores of two spheres: as of segments without length, in half of the instructions.
bool answer_points(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket, PenetrationDepth& out) {
  const Vec3 on_a = pair.pose_a->rotation() * pair.a->vertex(0);
  const Vec3 on_b = pair.pose_b->rotation() * pair.b->vertex(0);
  const Vec3 offset = pair.pose_b->translation() - pair.pose_a->translation();
  const double reach = pair.a->radius() + pair.b->radius() + offset.norm();
  const Vec3 between = on_b - on_a + offset;
  const double length = between.norm();
  const double error = kPointError * reach;
  if (!(reach > kLeastReach && reach < kLargestReach) || !(length > 4 * error)) return false;
  const Vec3 unit = between / length;
  const double lower = between.dot(unit) - error, upper = length + error;
  const bool for_contact = bracket == Bracket::contact;
  const double limit = width_of(settings, for_contact).limit(between.cwiseAbs().maxCoeff());
  if (!(lower > 0 && upper - lower <= limit)) return false;
  const double margin = pair.margins.both();
  if (margin > 0 && !for_contact && sign_is_unclear(lower, upper, margin)) return false;
  out.method = Method::expansion;
  ++out.statistics.support_calls;
  out.normal = -unit;
  out.witness_a = on_a + pair.pose_a->translation() + pair.margins.a * unit;
  const Vec3 witness_b = on_b + pair.pose_b->translation() - pair.margins.b * unit;
  out.witness_b = witness_b;
  out.feature_a = out.feature_b = {Feature::Kind::vertex, 0, -1};
  set_signed_distance(margin, lower, upper, out);
  // Not A's, moved: that would depend on which body is A.
  out.witness_b = witness_b;
  return true;
}

}  // namespace

bool answer_cores_apart(const PolytopePair& pair, NearestOfSegments& cores, bool mirrored,
                        const DepthSettings& settings, Bracket bracket, PenetrationDepth& out) {
  const bool for_contact = bracket == Bracket::contact;
  if (!cores.bracket_distance(width_of(settings, for_contact))) return false;
  const double margin = pair.margins.both();
  if (margin > 0 && !for_contact && sign_is_unclear(cores.lower, cores.upper, margin)) return false;
  out.method = Method::expansion;
  ++out.statistics.support_calls;
  out.normal = mirrored ? Vec3(-cores.normal) : cores.normal;
  const Vec3 on_a = mirrored ? cores.point_b() : cores.point_a();
  const Vec3 on_b = mirrored ? cores.point_a() : cores.point_b();
  out.witness_a = on_a + pair.pose_a->translation() - pair.margins.a * out.normal;
  out.witness_b = on_b + pair.pose_b->translation() + pair.margins.b * out.normal;
  out.feature_a = mirrored ? cores.feature_b() : cores.feature_a();
  out.feature_b = mirrored ? cores.feature_a() : cores.feature_b();
  set_signed_distance(margin, cores.lower, cores.upper, out);
  return true;
}

bool answer_spheres(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, PenetrationDepth& out) {
  const ConvexPolytope *const core_a = a.shape->polytope(), *const core_b = b.shape->polytope();
  if (core_a == nullptr || core_a->num_vertices() != 1 || core_b == nullptr || core_b->num_vertices() != 1)
    return false;
  const Bracket bracket = PolytopeQuery::bracket_of(settings);
  if (settings.method != Method::automatic || bracket == Bracket::tightest) return false;
  const Margins margins{a.shape->margin(), b.shape->margin()};
  return answer_points({a.shape->polytope(), b.shape->polytope(), &a.pose, &b.pose, margins}, settings, bracket, out);
}

bool answer_slender_pair(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                         PenetrationDepth& out) {
  if (pair.a->num_vertices() > 2 || pair.b->num_vertices() > 2) return false;
  if (pair.a->num_vertices() == 1 && pair.b->num_vertices() == 1) return answer_points(pair, settings, bracket, out);
  const Vec3 offset = pair.pose_b->translation() - pair.pose_a->translation();
  NearestOfSegments cores({*pair.a, pair.pose_a->rotation()}, {*pair.b, pair.pose_b->rotation()}, offset,
                          pair.a->radius() + pair.b->radius() + offset.norm());
  return answer_cores_apart(pair, cores, false, settings, bracket, out);
}

}  // namespace pd::detail
