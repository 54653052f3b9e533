#include "depth/pair/slender_pair.hpp"

#include "depth/certificate/exact_answer.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/nearest_of_segments.hpp"

namespace pd::detail {

bool answer_cores_apart(const PolytopePair& pair, NearestOfSegments& cores, bool mirrored,
                        const DepthSettings& settings, Bracket bracket, PenetrationDepth& out) {
  const bool for_contact = bracket == Bracket::contact;
  if (!cores.bracket_distance({kCertifiedWidth, for_contact ? settings.contact_tolerance : 0})) return false;
  const double margin = pair.margins.both();
  const double round = 4 * kUnitRoundoff * (cores.upper + margin);
  const bool sign_unclear = cores.lower - margin <= round && cores.upper - margin >= -round;
  if (margin > 0 && sign_unclear && !for_contact) return false;
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

bool answer_slender_pair(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                         PenetrationDepth& out) {
  if (pair.a->num_vertices() > 2 || pair.b->num_vertices() > 2) return false;
  const Vec3 offset = pair.pose_b->translation() - pair.pose_a->translation();
  NearestOfSegments cores({*pair.a, pair.pose_a->rotation()}, {*pair.b, pair.pose_b->rotation()}, offset,
                          pair.a->radius() + pair.b->radius() + offset.norm());
  return answer_cores_apart(pair, cores, false, settings, bracket, out);
}

}  // namespace pd::detail
