#include "depth/pair/polytope_depth.hpp"

#include <algorithm>

#include "depth/expansion/cached_surface.hpp"
#include "depth/pair/contact_facets.hpp"
#include "depth/pair/polytope_contact.hpp"
#include "depth/pair/polytope_double.hpp"
#include "depth/pair/polytope_exact.hpp"
#include "depth/pair/polytope_rescaled.hpp"
#include "depth/pair/slender_near_box.hpp"
#include "depth/pair/slender_pair.hpp"
#include "depth/pair/stages.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

/// Spheres and capsules, where a closed form is at hand. Out of line: other pairs need none of its registers.
[[gnu::noinline]] bool answer_slender(const PolytopePair& pair, const DepthSettings& settings, PenetrationDepth& out) {
  const Bracket bracket = PolytopeQuery::bracket_of(settings);
  return settings.method == Method::automatic && bracket != Bracket::tightest &&
         (answer_slender_pair(pair, settings, bracket, out) || answer_slender_near_box(pair, settings, bracket, out));
}

/// Answers by [A] section 2 below the bounds of a surface. Bodies that the surface shows apart end at their closest
/// points.
void answer_as_decomposed(PolytopeQuery& query, PenetrationDepth& out) {
  query.surface = grow_surface(query, out);
  if (query.surface.status == ExpansionStatus::separated) {
    answer_by_closest_point(query, out);
  } else {
    answer_by_decomposition(query, bounded(query, query.surface, out.statistics), out);
  }
}

/// Answers for sizes that doubles cannot square, and that no power of two brings to size 1.
void answer_beyond_doubles(PolytopeQuery& query, PenetrationDepth& out) {
  out.method = Method::expansion;
  if (!answer_at_one_place(query, out)) answer_by_closest_point(query, out);
}

}  // namespace

void polytope_depth(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers,
                    WarmCertificate* warm, PenetrationDepth& out) {
  if (std::min(pair.a->num_vertices(), pair.b->num_vertices()) <= 2 && answer_slender(pair, settings, out)) return;
  PolytopeQuery query(pair, settings, buffers, warm);
  const bool in_range = query.within_range();
  if (!in_range && answer_at_size_one(query, out)) return;
  if (settings.method == Method::overlay) {
    answer_by_overlay(query, out);
  } else if (!in_range && settings.method != Method::decomposition) {
    answer_beyond_doubles(query, out);
  } else if (settings.method == Method::decomposition) {
    answer_as_decomposed(query, out);
  } else if (answer_by_stages(query, out).answer != answer_from_contact_facet && warm != nullptr &&
             query.for_contact() && warm->state().facets.pause == 0) {
    // The next frame may try these facets, if its pause is over.
    learn_contact_facet(0, *pair.a, *pair.pose_a, out, warm->state().facets);
    learn_contact_facet(1, *pair.b, *pair.pose_b, out, warm->state().facets);
  }
  out.statistics.exact_signs += query.exact_signs();
}

}  // namespace pd::detail
