/// @file
/// `Bracket::contact` of bodies at rest: the facet that one of them lies on is remembered between frames, or known
/// where it is a polygon, and answers by itself (facets/facet_contact.hpp).
#pragma once

#include "depth/facets/facet_contact.hpp"
#include "depth/pair/polytope_query.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

struct WarmFacets;

/// Two polytopes. Passes on where no facet is at hand or the nearest point of P lies elsewhere. Constant time for
/// facets of bounded size, and a support.
bool answer_from_contact_facet(PolytopeQuery& query, PenetrationDepth& out);

/// After an answer by another way: which facet of A (`of` 0) or B (1) the next frame may try. Time O(facets) up to 32,
/// and the edges that leave a facet seen for the first time.
void learn_contact_facet(int of, const ConvexPolytope& owner, const Pose& pose, const PenetrationDepth& answer,
                         WarmFacets& facets);

/// The remembered facet of A (`of` 0) or B (1), where that is `owner`; else -1.
[[nodiscard]] int known_facet(const WarmFacets& facets, int of, const ConvexPolytope& owner);
/// Frames without a try after several that were of no use.
inline constexpr int kLongestFacetPause = 7;
/// Whether facets were of use lately: they pause for a few frames where not.
[[nodiscard]] bool may_try(WarmFacets& facets);
void count_try(WarmFacets& facets, bool answered, int longest_pause);

/// Class, bracket, normal and witnesses. The contact's bounds are those of the cores.
/// @param body_translation  of the body that lies on the facet.
void set_contact_on_facet(const FacetContact& contact, bool facet_of_a, const Margins& margins,
                          const Vec3& body_translation, PenetrationDepth& out);

}  // namespace pd::detail
