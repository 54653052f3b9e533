#include "depth/pair/contact_facets.hpp"

#include <algorithm>
#include <cmath>

#include "depth/expansion/cached_surface.hpp"
#include "depth/facets/facet_contact.hpp"
#include "depth/pair/double_answer.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

/// Two boxes have another way, at twice the cost of a try (gauss_sat_boxes.hpp).
constexpr int kLongestPauseOfBoxes = 63;
constexpr int kBoxVertices = 8;
/// Polytopes of more facets are not searched for the one that faces the contact: only answers name it.
constexpr int kMaxFacetsSearched = 32;
/// cos 3 degrees: a facet turned farther from the normal is not what the bodies rest on.
constexpr double kRestingCosine = 0.9986;

/// One of the two bodies as the owner of the facet, the other as what lies on it.
struct Roles {
  const ConvexPolytope& owner;
  const ConvexPolytope& body;
  const Pose& pose_owner;
  const Pose& pose_body;

  Roles(const PolytopePair& pair, int of)
      : owner(of == 0 ? *pair.a : *pair.b),
        body(of == 0 ? *pair.b : *pair.a),
        pose_owner(of == 0 ? *pair.pose_a : *pair.pose_b),
        pose_body(of == 0 ? *pair.pose_b : *pair.pose_a) {}
};

FacetContact contact_with(PolytopeQuery& query, const Roles& roles, int facet, int near) {
  const Mat3& rotation = roles.pose_body.rotation();
  const Vec3 offset = roles.pose_body.translation() - roles.pose_owner.translation();
  return facet_contact(roles.owner, roles.pose_owner.rotation(), facet, offset, rotation * roles.body.centre(),
                       support_plane_error(query.difference), [&](const Vec3& unit) {
                         const Vec3 direction = rotation.transpose() * unit;
                         int v = support_vertex(roles.body, direction, near);
                         if (roles.body.num_vertices() > kScanLimit) {
                           v = certified_support_vertex(roles.body, direction, v, query.buffers.stack);
                         }
                         return BodyPoint{rotation * roles.body.vertex(v), v};
                       });
}

/// The answer where the contact holds and is as narrow as asked.
bool answer(PolytopeQuery& query, int of, int facet, int near, PenetrationDepth& out, std::int32_t& vertex) {
  const Roles roles(query.pair, of);
  const FacetContact contact = contact_with(query, roles, facet, near);
  if (!contact.certified || contact.upper - contact.lower > query.widest_bracket()) return false;
  vertex = contact.body.id;
  set_contact_on_facet(contact, of == 0, query.pair.margins, roles.pose_body.translation(), out);
  const Feature of_owner{Feature::Kind::facet, facet, -1};
  const Feature of_body{Feature::Kind::vertex, contact.body.id, -1};
  out.feature_a = of == 0 ? of_owner : of_body;
  out.feature_b = of == 0 ? of_body : of_owner;
  return true;
}

/// A polygon has two facets: the one that the other body's centre lies over.
bool answer_on_polygon(PolytopeQuery& query, PenetrationDepth& out) {
  for (const int of : {1, 0}) {
    const Roles roles(query.pair, of);
    if (roles.owner.affine_dimension() != 2) continue;
    const Vec3 corner = roles.pose_owner.apply(roles.owner.vertex(roles.owner.facet_vertices(0)[0]));
    const Vec3 normal = roles.pose_owner.rotation() * roles.owner.facet_normal(0);
    const int facet = (roles.pose_body.apply(roles.body.centre()) - corner).dot(normal) >= 0 ? 0 : 1;
    std::int32_t vertex = -1;
    if (answer(query, of, facet, -1, out, vertex)) return true;
  }
  return false;
}

/// The facet that faces along a direction of the polytope's own frame, -1 where none does.
int facet_towards(const ConvexPolytope& polytope, const Feature& feature, const Vec3& direction) {
  if (feature.kind == Feature::Kind::facet) return feature.first;
  if (polytope.num_facets() > kMaxFacetsSearched) return -1;
  int best = -1;
  double cosine = kRestingCosine;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const double along = polytope.facet_normal(f).dot(direction);
    if (along > cosine) {
      cosine = along;
      best = f;
    }
  }
  return best;
}

}  // namespace

void set_contact_on_facet(const FacetContact& contact, bool facet_of_a, const Margins& margins,
                          const Vec3& body_translation, PenetrationDepth& out) {
  out.method = Method::expansion;
  ++out.statistics.support_calls;
  ++out.statistics.facets_visited;
  out.normal = facet_of_a ? Vec3(-contact.normal) : contact.normal;
  const Vec3 on_body = contact.body.x + body_translation;
  const Vec3 on_facet = on_body - contact.gap * contact.normal;
  out.witness_a = (facet_of_a ? on_facet : on_body) - margins.a * out.normal;
  out.witness_b = (facet_of_a ? on_body : on_facet) + margins.b * out.normal;
  set_signed_distance(margins.a + margins.b, contact.lower, contact.upper, out);
}

int known_facet(const WarmFacets& facets, int of, const ConvexPolytope& owner) {
  const WarmFacets::OfBody& known = facets.bodies[of];
  return known.facet >= 0 && known.owner->same_storage(owner) ? known.facet : -1;
}

bool may_try(WarmFacets& facets) {
  if (facets.pause == 0) return true;
  --facets.pause;
  return false;
}

void count_try(WarmFacets& facets, bool answered, int longest_pause) {
  facets.pause_length = answered ? 0 : std::min(2 * facets.pause_length + 1, longest_pause);
  facets.pause = answered ? 0 : facets.pause_length - 1;
}

bool answer_from_contact_facet(PolytopeQuery& query, PenetrationDepth& out) {
  if (!query.warm) return answer_on_polygon(query, out);
  WarmFacets& facets = query.warm->state().facets;
  if (!may_try(facets)) return false;
  bool tried = false;
  for (const int of : {facets.first, 1 - facets.first}) {
    const int facet = known_facet(facets, of, Roles(query.pair, of).owner);
    if (facet < 0) continue;
    tried = true;
    WarmFacets::OfBody& known = facets.bodies[of];
    if (!answer(query, of, facet, known.near, out, known.near)) continue;
    out.warm = true;
    facets.first = of;
    count_try(facets, true, kLongestFacetPause);
    return true;
  }
  const bool boxes = query.vertices() == 2 * kBoxVertices;
  if (tried) count_try(facets, false, boxes ? kLongestPauseOfBoxes : kLongestFacetPause);
  return !tried && answer_on_polygon(query, out);
}

void learn_contact_facet(int of, const ConvexPolytope& owner, const Pose& pose, const PenetrationDepth& answer,
                         WarmFacets& facets) {
  const Vec3 outward = of == 0 ? Vec3(-answer.normal) : answer.normal;
  const Feature& feature = of == 0 ? answer.feature_a : answer.feature_b;
  const int facet = facet_towards(owner, feature, pose.rotation().transpose() * outward);
  WarmFacets::OfBody& known = facets.bodies[of];
  if (facet < 0 || (known.facet == facet && known.owner->same_storage(owner))) return;
  known.facet = -1;
  if (!is_supporting_facet(owner, facet)) return;
  if (!known.owner || !known.owner->same_storage(owner)) known.owner = owner;
  known.facet = facet;
  known.near = -1;
}

}  // namespace pd::detail
