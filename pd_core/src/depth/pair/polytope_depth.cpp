#include "depth/pair/polytope_depth.hpp"

#include <algorithm>

#include "depth/expansion/cached_surface.hpp"
#include "depth/pair/contact_facets.hpp"
#include "depth/pair/polytope_contact.hpp"
#include "depth/pair/polytope_double.hpp"
#include "depth/pair/polytope_exact.hpp"
#include "depth/pair/polytope_rescaled.hpp"
#include "depth/pair/polytope_warm_start.hpp"
#include "depth/pair/slender_near_box.hpp"
#include "depth/pair/slender_on_box.hpp"
#include "depth/pair/slender_pair.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

/// Bracket::contact: pairs of more vertices do not try all their near facets: nearly equal hulls of 256 take 2 ms for
/// it, of 128 40 us.
constexpr int kMostVerticesTried = 256;

bool answer_by_chosen_overlay(PolytopeQuery& query, PenetrationDepth& out) {
  return query.settings.method == Method::overlay && answer_by_overlay(query, out);
}

/// An expansion that stopped early, its upper bound lowered by supports along the normals of its nearest faces.
ExpansionResult bounded(PolytopeQuery& query, ExpansionResult surface, Statistics& statistics) {
  if (!(surface.lower > 0)) return surface;
  ScratchBuffers& buffers = query.buffers;
  const HeightOfFace least =
      upper_bound_of_nearest_faces(query.with_supports(), buffers.surface, buffers.stack, statistics.support_calls);
  surface.upper = std::min(surface.upper, least.upper);
  return surface;
}

bool answer_by_chosen_decomposition(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  return query.settings.method == Method::decomposition && surface.status != ExpansionStatus::separated &&
         answer_by_decomposition(query, bounded(query, surface, out.statistics), out);
}

/// Where the expansion stopped because too many facets are nearly as near: among those alone, else in the way of [A].
bool answer_among_many_facets(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  if (surface.status != ExpansionStatus::over_budget || !(surface.lower > 0)) return false;
  const ExpansionResult found = bounded(query, surface, out.statistics);
  // A contact that may be left as it is, or whose facets are too many to try them all, has had its share.
  const bool enough = query.vertices() > kMostVerticesTried || found.upper <= (1 + kContactClose) * found.lower;
  if (query.for_contact() && enough) return false;
  if (answer_among_near_facets(query, found, out)) return true;
  return !query.for_contact() && answer_by_decomposition(query, found, out);
}

// The order of methods. Each stage looks for itself whether it applies, and answers or passes on.

using StageBeforeSearch = bool (*)(PolytopeQuery&, PenetrationDepth&);
// With a warm certificate:
constexpr StageBeforeSearch kFromMemory[] = {
    answer_from_remembered_pieces,     // two small solids by the facets that were near
    answer_from_cached_faces,          // a few planes of the last surface
    answer_apart_from_cached_simplex,  // from the last closest point
};
constexpr StageBeforeSearch kBeforeSearch[] = {
    answer_boxes,               // two boxes by their fifteen axes
    prove_boxes,                // the same on the stored numbers: the tightest bracket
    answer_few_vertices_apart,  // a support shows bodies of few vertices apart: their closest points
    answer_by_gauss_maps,       // two solids of few facets by all facets of P
};

// Then the expansion (EPA) grows a surface inside P, from the last one where that serves (`grow_surface`).

using StageAfterSearch = bool (*)(PolytopeQuery&, const ExpansionResult&, PenetrationDepth&);
constexpr StageAfterSearch kAfterSearch[] = {
    answer_by_chosen_decomposition,  // [A] section 2, where `Method::decomposition` is asked for
    answer_from_surface,             // the nearest face, in doubles
    answer_among_many_facets,        // too many nearly equal facets for the expansion
    answer_contact,                  // `Bracket::contact`: whatever is left, without exact numbers
    prove_surface,                   // the nearest face proved in double-double: the tightest bracket
    answer_by_exact_expansion,       // the same facet by exact arithmetic
    answer_by_closest_point,         // apart, touching or in doubt: GJK in doubles, then exactly
};

void answer(PolytopeQuery& query, PenetrationDepth& out) {
  if (answer_by_chosen_overlay(query, out)) return;  // all facets of P, where `Method::overlay` is asked for
  if (query.warm != nullptr) {
    for (const StageBeforeSearch stage : kFromMemory) {
      if (stage(query, out)) return;
    }
  }
  for (const StageBeforeSearch stage : kBeforeSearch) {
    if (stage(query, out)) return;
  }
  const ExpansionResult surface = grow_surface(query, out);
  for (const StageAfterSearch stage : kAfterSearch) {
    if (stage(query, surface, out)) return;
  }
}

/// Spheres and capsules, where a closed form is at hand.
bool answer_slender(const PolytopePair& pair, const DepthSettings& settings, PenetrationDepth& out) {
  const Bracket bracket = PolytopeQuery::bracket_of(settings);
  const bool certified = settings.method == Method::automatic && bracket != Bracket::tightest;
  if (certified && answer_slender_pair(pair, settings, bracket, out)) return true;
  if (bracket == Bracket::tightest || (!certified && bracket == Bracket::certified)) return false;
  if (answer_slender_on_box(pair, settings, bracket, out)) return true;
  return bracket == Bracket::certified && answer_slender_near_box(pair, settings, out);
}

}  // namespace

void polytope_depth(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers,
                    WarmCertificate* warm, PenetrationDepth& out) {
  if (std::min(pair.a->num_vertices(), pair.b->num_vertices()) <= 2 && answer_slender(pair, settings, out)) return;
  PolytopeQuery query(pair, settings, buffers, warm);
  if (!query.within_range() && answer_at_size_one(query, out)) return;
  if (answer_from_contact_facet(query, out)) return;
  answer(query, out);
  // What the next frame may try, where it will try.
  if (warm != nullptr && query.for_contact() && warm->state().facets.pause == 0) {
    learn_contact_facet(0, *pair.a, *pair.pose_a, out, warm->state().facets);
    learn_contact_facet(1, *pair.b, *pair.pose_b, out, warm->state().facets);
  }
  out.statistics.exact_signs += query.exact_signs();
}

}  // namespace pd::detail
