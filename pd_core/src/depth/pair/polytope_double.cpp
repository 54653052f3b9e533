#include "depth/pair/polytope_double.hpp"

#include <algorithm>
#include <cmath>

#include "depth/difference/barycentric.hpp"
#include "depth/difference/foot_weights.hpp"
#include "depth/distance/closest_of_few.hpp"
#include "depth/facets/box_sat.hpp"
#include "depth/facets/gauss_sat.hpp"
#include "depth/facets/near_facets.hpp"
#include "depth/facets/remembered_pieces.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_exact.hpp"
#include "depth/pair/polytope_warm_start.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// A support towards P's centre shows bodies apart only if that is no nearer to the origin than this share of the
/// reach: measured on boxes, prisms, needles and round hulls.
constexpr double kLeastWayShown = 0.3;

/// Whether the upper bound comes from the side of the nearest face: two facets on opposite sides of the origin may be
/// as far from it to within the bracket.
bool bound_is_of_face(const InnerSurface& surface, const ExpansionResult& result) {
  const Vec3 normal = surface.normal(result.face);
  return normal.dot(result.normal) > 0.9 * normal.norm();
}

/// Coplanar faces share a facet of P: steps from f across the edge that the projection lies beyond, while the
/// neighbour is as near, until the projection lies inside. Gives the last face's corners and where it lies on them.
void face_below_origin(const PolytopeQuery& query, int f, const Vec3& normal, DifferenceVertex (&corners)[3],
                       double (&weights)[3]) {
  const InnerSurface& surface = query.buffers.surface;
  const double key = std::max(0.0, surface.key(f));
  for (int step = 0; step < surface.size(); ++step) {
    face_corners(surface, f, corners);
    project_origin(corners, normal, weights);
    const int least = static_cast<int>(std::min_element(weights, weights + 3) - weights);
    if (weights[least] >= 0) return;
    // weights[i] belongs to vertex i, whose opposite edge runs from vertex i + 1.
    const int next = surface.face(f).adj[(least + 1) % 3] >> 2;
    const double level = std::sqrt(key) + 64 * kUnitRoundoff * query.difference.reach();
    if (std::sqrt(std::max(0.0, surface.key(next))) > level) return;
    f = next;
  }
}

/// Witnesses and features of a parallelogram of two edges.
void set_contact_of_edges(const PolytopeQuery& query, const NearFacets& found, PenetrationDepth& out) {
  const auto [a, b] = std::pair(found.edge_a, found.edge_b);
  const double s = found.along_a, t = found.along_b;
  const PolytopeDifference& difference = query.difference;
  const DifferenceVertex corners[4] = {difference.vertex(a[0], b[0]), difference.vertex(a[1], b[0]),
                                       difference.vertex(a[0], b[1]), difference.vertex(a[1], b[1])};
  const double weights[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  set_witnesses_of_depth(query.pair, corners, weights, 4, out);
  out.feature_a = {Feature::Kind::edge, std::min(a[0], a[1]), std::max(a[0], a[1])};
  out.feature_b = {Feature::Kind::edge, std::min(b[0], b[1]), std::max(b[0], b[1])};
}

/// The same of a facet of one body and a vertex of the other.
void set_contact_of_facet(const PolytopePair& pair, const NearFacets& found, PenetrationDepth& out) {
  const Feature facet{Feature::Kind::facet, found.facet, -1};
  const Feature vertex{Feature::Kind::vertex, found.vertex, -1};
  if (found.kind == NearFacetsBuffers::Kind::facet_of_a) {
    out.feature_a = facet;
    out.feature_b = vertex;
    out.witness_b = pair.pose_b->apply(pair.b->vertex(found.vertex)) + pair.margins.b * out.normal;
    out.witness_a = out.witness_b - out.translation;
  } else {
    out.feature_a = vertex;
    out.feature_b = facet;
    out.witness_a = pair.pose_a->apply(pair.a->vertex(found.vertex)) - pair.margins.a * out.normal;
    out.witness_b = out.witness_a + out.translation;
  }
}

/// Class, bracket and contact of the certified piece.
void set_answer(const PolytopeQuery& query, const NearFacets& found, PenetrationDepth& out) {
  set_depth(query.pair, found.lower, found.upper, found.normal, out);
  if (found.kind == NearFacetsBuffers::Kind::edges) {
    set_contact_of_edges(query, found, out);
  } else {
    set_contact_of_facet(query.pair, found, out);
  }
}

/// Up to four corners of a facet of P.
std::size_t corners_of_piece(const PolytopeQuery& query, const NearFacets& piece, DifferenceVertex (&corners)[4]) {
  const PolytopeDifference& difference = query.difference;
  if (piece.kind == NearFacetsBuffers::Kind::edges) {
    for (std::size_t i = 0; i < 4; ++i) corners[i] = difference.vertex(piece.edge_a[i % 2], piece.edge_b[i / 2]);
    return 4;
  }
  const bool of_a = piece.kind == NearFacetsBuffers::Kind::facet_of_a;
  const auto loop = (of_a ? query.pair.a : query.pair.b)->facet_vertices(piece.facet);
  const std::size_t count = std::min<std::size_t>(loop.size(), 4);
  for (std::size_t i = 0; i < count; ++i) {
    corners[i] = of_a ? difference.vertex(loop[i], piece.vertex) : difference.vertex(piece.vertex, loop[i]);
  }
  return count;
}

/// Whether a solid of few vertices has facets across all three of its axes.
bool built_along_axes(const SmallGaussMap& map) {
  bool across_x = false, across_y = false, across_z = false;
  for (int f = 0; f < map.facets; ++f) {
    across_x = across_x || std::abs(map.nx[f]) == 1;
    across_y = across_y || std::abs(map.ny[f]) == 1;
    across_z = across_z || std::abs(map.nz[f]) == 1;
  }
  return across_x && across_y && across_z;
}

/// Whether the axes of one body run along those of the other, about.
bool along_same_axes(const Mat3& a, const Mat3& b) {
  const auto along = [&](int i, int j) {
    const double cosine = std::abs(a.col(i).dot(b.col(j)));
    return std::min(cosine, std::abs(1 - cosine)) < 0x1p-20;
  };
  return along(0, 0) && along(1, 1) && along(0, 1) && along(1, 0);
}

bool have_same_normals(const SmallGaussMap& a, const SmallGaussMap& b) {
  const auto same = [&](const double* x, const double* y) { return std::equal(x, x + a.facets, y); };
  return a.facets == b.facets && same(a.nx, b.nx) && same(a.ny, b.ny) && same(a.nz, b.nz);
}

/// True if many facets of two solids meet in common planes, which leaves them to the surface: it meets few faces where
/// the Gauss maps leave many arcs in doubt. So do what was built along axes that both share, copies of one shape that
/// are turned alike, and solids of many facets whose frames share axes.
bool many_flush_facets(const PolytopePair& pair, const PolytopeDifference& difference) {
  if (!along_same_axes(difference.rotation_a(), difference.rotation_b())) return false;
  if (!has_small_gauss_map(*pair.a) || !has_small_gauss_map(*pair.b)) return true;
  const SmallGaussMap &a = small_gauss_map(*pair.a), &b = small_gauss_map(*pair.b);
  return (built_along_axes(a) && built_along_axes(b)) || have_same_normals(a, b);
}

/// Whether one support tells that the bodies are apart, along the line between their frames' origins. Their distance is
/// found from where a surface ends.
bool apart_between_places(const PolytopeDifference& difference) {
  const Vec3 back = -difference.offset();
  return difference.support(back, nullptr).x.dot(back) < 0;
}

bool answer_boxes_for_contact(PolytopeQuery& query, const BoxFrame& box_a, const BoxFrame& box_b,
                              PenetrationDepth& out) {
  const PolytopePair& pair = query.pair;
  const BoxPairContact boxes =
      box_pair_contact(*pair.a, box_a, *pair.pose_a, *pair.b, box_b, *pair.pose_b, query.width());
  out.method = Method::overlay;
  out.statistics.facets_visited += kBoxAxes;
  if (!boxes.certified && boxes.lower > 0) {
    const DifferenceVertex first = query.with_supports().support(boxes.normal, nullptr);
    return answer_apart(query, closest_point(query, {&first, 1}, out.statistics), out);
  }
  if (!boxes.certified) return false;
  const Vec3& origin = pair.pose_a->translation();
  out.normal = boxes.normal;
  out.witness_a = boxes.point_a + origin - pair.margins.a * boxes.normal;
  out.witness_b = boxes.point_b + origin + pair.margins.b * boxes.normal;
  out.feature_a = boxes.feature_a;
  out.feature_b = boxes.feature_b;
  set_signed_distance(pair.margins.both(), boxes.lower, boxes.upper, out);
  return true;
}

}  // namespace

ExpansionGoal expansion_goal(const PolytopeQuery& query) {
  ExpansionGoal goal;
  goal.absolute = query.width().of_size;
  goal.width = query.width().length;
  goal.relative = query.settings.delta;
  goal.vertices = query.vertices();
  goal.max_steps = ExpansionBudget::max_steps(goal.vertices);
  if (!query.for_contact()) return goal;
  goal.close = kContactClose;
  goal.close_after = ContactBudget::kStepsToFull;
  goal.max_steps = std::min(goal.max_steps, ContactBudget::max_steps(goal.vertices));
  return goal;
}

bool answer_boxes(PolytopeQuery& query, PenetrationDepth& out) {
  if (query.bracket == Bracket::tightest || query.settings.method != Method::automatic) return false;
  const PolytopePair& pair = query.pair;
  const std::optional<BoxFrame> box_a = box_frame(*pair.a);
  if (!box_a) return false;
  const std::optional<BoxFrame> box_b = box_frame(*pair.b);
  if (!box_b || !query.within_range()) return false;
  if (query.for_contact()) return answer_boxes_for_contact(query, *box_a, *box_b, out);
  const BoxPairDepth boxes =
      box_pair_depth(*pair.a, *box_a, *pair.pose_a, *pair.b, *box_b, *pair.pose_b, query.width());
  out.method = Method::overlay;
  out.statistics.facets_visited += kBoxAxes;
  if (boxes.status == BoxPairStatus::separated) {
    const PolytopeDifference& difference = query.with_supports();
    DifferenceVertex first[3];
    std::size_t count = 0;
    if (boxes.nearest) {
      for (const VertexPair& corner : boxes.nearest->v) first[count++] = difference.vertex(corner.a, corner.b);
    } else {
      first[count++] = difference.support(boxes.normal, nullptr);
    }
    return answer_apart(query, closest_point(query, std::span(first).first(count), out.statistics), out);
  }
  if (boxes.status == BoxPairStatus::undecided) return false;
  set_depth(pair, boxes.lower, boxes.upper, boxes.normal, out);
  out.witness_a = boxes.point_a + pair.pose_a->translation() - pair.margins.a * boxes.normal;
  out.witness_b = out.witness_a + out.translation;
  out.feature_a = boxes.feature_a;
  out.feature_b = boxes.feature_b;
  return true;
}

bool answer_few_vertices_apart(PolytopeQuery& query, PenetrationDepth& out) {
  if (query.settings.method != Method::automatic || query.bracket == Bracket::tightest) return false;
  if (query.difference.climbs() || !query.within_range() || remembers_overlap(query)) return false;
  const Vec3 back = -query.difference.centre();
  const double reach = query.difference.reach();
  if (!(back.squaredNorm() > kLeastWayShown * kLeastWayShown * reach * reach)) return false;
  const DifferenceVertex first = query.with_supports().support(back, nullptr);
  ++out.statistics.support_calls;
  if (!(first.x.dot(back) < 0)) return false;
  if (!answer_apart(query, closest_point(query, {&first, 1}, out.statistics), out)) return false;
  out.method = Method::expansion;
  return true;
}

bool answer_by_gauss_maps(PolytopeQuery& query, PenetrationDepth& out) {
  if (query.settings.method != Method::automatic || !query.within_range()) return false;
  const PolytopePair& pair = query.pair;
  if (!gauss_sat_applies(*pair.a, *pair.b) || !gauss_sat_pays(query.difference)) return false;
  // The surface has a memory of any pair; what the Gauss maps tell is remembered of small solids, of doubles.
  const bool remembers = query.warm && has_small_gauss_map(*pair.a) && has_small_gauss_map(*pair.b);
  if (query.warm && !(remembers && query.doubles_suffice())) return false;
  if (many_flush_facets(pair, query.difference) || (remembers && pauses_small_solids(query))) return false;
  const bool tightest = query.bracket == Bracket::tightest;
  if (tightest && apart_between_places(query.with_supports())) return false;
  NearGaussPieces near;
  if (remembers) near.band = remembered_band(query.difference);
  const GaussSatDepth found =
      gauss_sat_depth(*pair.pose_a, *pair.pose_b, query.with_supports(), query.width(), remembers ? &near : nullptr);
  out.method = Method::overlay;
  out.statistics.facets_visited += found.nearest.facets;
  out.statistics.support_calls += found.nearest.support_calls;
  if (tightest) {
    return found.status == GaussSatStatus::certified && !found.meeting && prove_near_facet(query, found.nearest, out);
  }
  if (found.status == GaussSatStatus::separated) {
    DifferenceVertex corners[4];
    const std::size_t count = corners_of_piece(query, found.nearest, corners);
    return answer_apart(query, closest_point(query, std::span(corners).first(count), out.statistics), out);
  }
  if (remembers) save_pieces(query, found, near);
  if (found.status == GaussSatStatus::undecided) return false;
  set_answer(query, found.nearest, out);
  if (found.meeting) {
    out.witness_b = *found.meeting + pair.pose_b->translation() + pair.margins.b * out.normal;
    out.witness_a = out.witness_b - out.translation;
  }
  return true;
}

bool answer_from_remembered_pieces(PolytopeQuery& query, PenetrationDepth& out) {
  if (!remembers_pieces(query) || !query.doubles_suffice() || !query.within_range()) return false;
  int looked_at = 0;
  const NearFacets found =
      certify_remembered_pieces(query.warm->state().small.pieces[0], *query.pair.pose_a, *query.pair.pose_b,
                                query.with_supports(), query.width(), looked_at);
  out.statistics.facets_visited += looked_at;
  if (!found.certified) return false;
  out.method = Method::overlay;
  out.warm = true;
  ++out.statistics.support_calls;
  set_answer(query, found, out);
  return true;
}

ExpansionResult grow_surface(PolytopeQuery& query, PenetrationDepth& out) {
  ExpansionResult result;
  out.method = Method::expansion;
  if (!query.within_range()) return result;
  const bool restored = query.warm && restore_surface(query);
  if (restored && query.doubles_suffice() && certify_restored_surface(query, result, out.statistics)) {
    out.warm = true;
    save_reference(query, result);
    return result;
  }
  ScratchBuffers& buffers = query.buffers;
  ExpandingPolytope<PolytopeDifference> expansion(query.with_supports(), buffers.surface, buffers.stack);
  if (restored) {
    result = expansion.resume(expansion_goal(query));
    out.warm = result.status == ExpansionStatus::certified || result.status == ExpansionStatus::separated;
  }
  if (!out.warm) {
    // The tightest bracket's facet is promised, also where several are equally near.
    const auto first = query.bracket == Bracket::tightest ? FirstDirections::plain : FirstDirections::by_shape;
    result = expansion.run(warm_direction(query), expansion_goal(query), first);
    // Long thin faces without an area, or a surface that folds: of one pair in some hundred on ridges. Exact numbers
    // would take twenty times as long as another try.
    if (result.status == ExpansionStatus::undecided && expansion.began_by_shape()) {
      result = expansion.run(warm_direction(query), expansion_goal(query), FirstDirections::plain);
    }
  }
  out.statistics.support_calls += expansion.support_calls();
  out.statistics.facets_visited += expansion.facets_visited();
  save_surface(query, result);
  return result;
}

bool answer_from_surface(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  if (surface.status != ExpansionStatus::certified || query.bracket == Bracket::tightest) return false;
  if (!bound_is_of_face(query.buffers.surface, surface)) return false;
  set_depth(query.pair, surface.lower, surface.upper, surface.normal, out);
  set_contact_of_face(query, surface.face, surface.normal, out);
  if (query.for_contact()) out.bracket_reached = narrow_enough(query, surface);
  return true;
}

void set_contact_of_face(const PolytopeQuery& query, int face, const Vec3& unit_normal, PenetrationDepth& out) {
  DifferenceVertex corners[3];
  double weights[3];
  face_below_origin(query, face, unit_normal, corners, weights);
  // Beside a long body a short one leaves slivers whose planes differ by more than rounding: the walk can end at one
  // that does not hold the foot. Another triangle of vertices on the same plane does.
  const double rounding = 64 * kUnitRoundoff * query.difference.reach();
  if (miss_across(corners, unit_normal, weights) > rounding) {
    double least_height = unit_normal.dot(corners[0].x);
    for (const DifferenceVertex& corner : corners) least_height = std::min(least_height, unit_normal.dot(corner.x));
    find_foot(query.buffers.surface.vertices, unit_normal, least_height - rounding, corners, weights);
  }
  set_contact(query.pair, corners, weights, out);
}

void set_contact_of_simplex(const PolytopePair& pair, const ClosestPoint& nearest, PenetrationDepth& out) {
  set_witnesses(pair, nearest.simplex, nearest.weights, nearest.count, out);
  DifferenceVertex corners[3];
  for (int i = 0; i < 3; ++i) corners[i] = nearest.simplex[std::min(i, nearest.count - 1)];
  set_features(pair, corners, out);
}

bool narrow_enough(const PolytopeQuery& query, const ExpansionResult& found) {
  double largest = 0;
  for (const DifferenceVertex& v : query.buffers.surface.vertices) {
    largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
  }
  return found.upper - found.lower <= query.width().limit(largest) ||
         found.upper - found.lower <= query.width().limit(query.difference.coordinate_of_ends()) ||
         found.upper <= (1 + query.settings.delta) * found.lower;
}

bool answer_among_near_facets(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  if (surface.status != ExpansionStatus::over_budget || !(surface.lower > 0)) return false;
  const PolytopePair& pair = query.pair;
  const NearFacets found = nearest_of_near_facets(
      *pair.a, *pair.pose_a, *pair.b, *pair.pose_b, query.with_supports(), query.buffers.surface,
      {surface.lower, surface.upper, kCertifiedWidth}, query.buffers.stack, query.buffers.near_facets);
  out.statistics.support_calls += found.support_calls;
  out.statistics.facets_visited += found.facets;
  out.statistics.pair_evaluations += found.pairs;
  out.method = Method::decomposition;
  if (query.bracket == Bracket::tightest) return prove_near_facets(query, found.beyond, out);
  if (!found.certified) return false;
  set_answer(query, found, out);
  return true;
}

double relative_of_distance(const PolytopeQuery& query) {
  return query.pair.margins.both() > 0 ? 0.0 : query.settings.delta;
}

ClosestPoint closest_point(PolytopeQuery& query, std::span<const DifferenceVertex> start, Statistics& statistics) {
  // The tightest bracket's bits are those of the simplex, so that its search stays what it was.
  if (query.bracket != Bracket::tightest) {
    const double relative = relative_of_distance(query);
    const ClosestPoint found =
        query.difference.climbs()
            ? closest_of_many(query.difference, start, relative, query.width(), query.buffers.stack,
                              statistics.support_calls)
            : closest_of_few(query.with_supports(), start, relative, query.width(), statistics.support_calls);
    if (found.certified) return found;
  }
  return closest_point(query.with_supports(), start, relative_of_distance(query), query.width(), query.buffers.stack,
                       statistics.support_calls);
}

bool answer_apart(PolytopeQuery& query, const ClosestPoint& nearest, PenetrationDepth& out) {
  if (!nearest.certified) return false;
  const double margin = query.pair.margins.both();
  const double round = 4 * kUnitRoundoff * (nearest.upper + margin);
  const bool sign_unclear = nearest.lower - margin <= round && nearest.upper - margin >= -round;
  if (margin > 0 && sign_unclear && !query.for_contact()) return false;
  save_simplex(query, nearest);
  out.normal = nearest.normal;
  set_contact_of_simplex(query.pair, nearest, out);
  set_signed_distance(margin, nearest.lower, nearest.upper, out);
  return true;
}

}  // namespace pd::detail
