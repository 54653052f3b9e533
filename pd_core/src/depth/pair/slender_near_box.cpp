#include "depth/pair/slender_near_box.hpp"

#include <optional>

#include "depth/facets/gauss_boxes.hpp"
#include "depth/features/nearest_of_segments.hpp"
#include "depth/features/segment_beside_box.hpp"
#include "depth/pair/contact_facets.hpp"
#include "depth/pair/slender_pair.hpp"

namespace pd::detail {

namespace {

/// A segment and a box at their poses, relative to the segment's translation but for the box.
struct SegmentAndBox {
  const PolytopePair& pair;
  bool a_is_box;
  const ConvexPolytope& owner;  ///< the box
  PosedSegment segment;
  PosedBox box;
  Vec3 offset;   ///< from the segment's translation to the box's
  double reach;  ///< >= |b - a| for all points of both bodies
};

/// By the face across axis k. Any plane bounds the distance from below and any point of the box from above, so that
/// what rounding does to plane and foot makes the bracket wide at worst.
bool answer_over_face(const SegmentAndBox& of, const SegmentBesideBox& beside, int k, int side,
                      const DepthSettings& settings, Bracket bracket, PenetrationDepth& out) {
  if (!(of.reach > kLeastReach && of.reach < kLargestReach)) return false;
  const Mat3& turn = (of.a_is_box ? of.pair.pose_a : of.pair.pose_b)->rotation();
  const Vec3& halves = beside.halves();
  FacetContact contact;
  contact.normal = (side * turn.col((k + 1) % 3).cross(turn.col((k + 2) % 3))).normalized();
  const Vec3& n = contact.normal;
  const Vec3 centre = of.offset + of.box.centre;
  const Vec3 first = of.segment.at(0) - centre, last = of.segment.at(1) - centre;
  const bool at_last = last.dot(n) < first.dot(n);
  const Vec3& place = at_last ? last : first;
  contact.body = {of.segment.at(at_last ? 1 : 0), at_last ? of.segment.second : of.segment.first};
  contact.gap = place.dot(n) - (of.box.halves.transpose() * n).cwiseAbs().sum();
  Vec3 foot = beside.at(at_last ? 1 : 0).cwiseMax(-halves).cwiseMin(halves);
  foot[k] = side * halves[k];
  contact.lower = contact.gap - kBoxPointError * of.reach;
  contact.upper = (place - turn * foot).norm() + kPointError * of.reach;
  const Vec3& along = of.segment.along;
  contact.largest = of.box.farthest(Vec3::Zero(), of.offset - of.segment.start - 0.5 * along, along);
  const bool for_contact = bracket == Bracket::contact;
  const double limit = width_of(settings, for_contact).limit(contact.largest);
  if (!(contact.lower > 0 && contact.upper - contact.lower <= limit)) return false;
  const Margins& margins = of.pair.margins;
  if (margins.both() > 0 && !for_contact && sign_is_unclear(contact.lower, contact.upper, margins.both())) return false;
  set_contact_on_facet(contact, of.a_is_box, margins, (of.a_is_box ? of.pair.pose_b : of.pair.pose_a)->translation(),
                       out);
  const Feature facet{Feature::Kind::facet, facet_of_box(of.owner, k, side > 0), -1};
  const Feature vertex{Feature::Kind::vertex, contact.body.id, -1};
  out.feature_a = of.a_is_box ? facet : vertex;
  out.feature_b = of.a_is_box ? vertex : facet;
  return true;
}

}  // namespace

bool answer_slender_near_box(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                             PenetrationDepth& out) {
  const bool a_is_box = pair.a->num_vertices() > 2;
  const ConvexPolytope& body = a_is_box ? *pair.b : *pair.a;
  const ConvexPolytope& owner = a_is_box ? *pair.a : *pair.b;
  if (body.num_vertices() > 2 || owner.num_vertices() != 8) return false;
  const std::optional<BoxFrame> frame = box_frame(owner);
  if (!frame) return false;
  const Pose& pose_body = a_is_box ? *pair.pose_b : *pair.pose_a;
  const Pose& pose_box = a_is_box ? *pair.pose_a : *pair.pose_b;
  const Mat3& turn = pose_box.rotation();
  const Vec3 offset = pose_box.translation() - pose_body.translation();
  const SegmentAndBox of{pair,
                         a_is_box,
                         owner,
                         {body, pose_body.rotation()},
                         {turn * frame->centre, turn * frame->half_extents.asDiagonal()},
                         offset,
                         body.radius() + owner.radius() + offset.norm()};
  const SegmentBesideBox beside(turn.transpose() * (of.segment.start - (offset + of.box.centre)),
                                turn.transpose() * of.segment.along, frame->half_extents);
  const SidesOfBox sides = beside.nearest();
  if (sides.outside() == 0) return false;
  if (sides.outside() == 1) {
    const int k = sides.of[0] != 0 ? 0 : sides.of[1] != 0 ? 1 : 2;
    return answer_over_face(of, beside, k, sides.of[k], settings, bracket, out);
  }
  // Vertices are in lexicographic order: z changes fastest.
  std::int32_t from = 0, to = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t place = 4 >> k;
    from += sides.of[k] > 0 ? place : 0;
    to += sides.of[k] >= 0 ? place : 0;
  }
  NearestOfSegments cores(of.segment, {owner, turn, from, to}, offset, of.reach);
  cores.set_box(of.box);
  return answer_cores_apart(pair, cores, a_is_box, settings, bracket, out);
}

}  // namespace pd::detail
