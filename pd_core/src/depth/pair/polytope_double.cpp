#include "depth/pair/polytope_double.hpp"

#include <algorithm>
#include <cmath>

#include "depth/difference/barycentric.hpp"
#include "depth/difference/foot_weights.hpp"
#include "depth/distance/closest_of_few.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/facets/gauss_sat_boxes.hpp"
#include "depth/facets/near_facets.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_exact.hpp"
#include "depth/pair/polytope_warm_start.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// Bracket::contact: pairs of more vertices do not try all their near facets: nearly equal hulls of 256 take 2 ms for
/// it, of 128 40 us.
constexpr int kMostVerticesTried = 256;

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

/// Sets the features that make a piece of P's boundary.
void set_features_of(const NearFacets& found, PenetrationDepth& out) {
  const auto [a, b] = std::pair(found.edge_a, found.edge_b);
  const Feature facet{Feature::Kind::facet, found.facet, -1};
  const Feature vertex{Feature::Kind::vertex, found.vertex, -1};
  switch (found.kind) {
    case NearFacetsBuffers::Kind::edges:
      out.feature_a = {Feature::Kind::edge, std::min(a[0], a[1]), std::max(a[0], a[1])};
      out.feature_b = {Feature::Kind::edge, std::min(b[0], b[1]), std::max(b[0], b[1])};
      break;
    case NearFacetsBuffers::Kind::facet_of_a:
      out.feature_a = facet;
      out.feature_b = vertex;
      break;
    case NearFacetsBuffers::Kind::facet_of_b:
      out.feature_a = vertex;
      out.feature_b = facet;
      break;
  }
}

/// Sets the witnesses of the point below the origin on a piece that holds it. Requires: depth and normal are set.
void set_witnesses_on(const PolytopePair& pair, const NearFacets& found, PenetrationDepth& out) {
  if (found.kind == NearFacetsBuffers::Kind::facet_of_a) {
    out.witness_b = pair.pose_b->apply(pair.b->vertex(found.vertex)) + pair.margins.b * out.normal;
    out.witness_a = out.witness_b - out.translation;
  } else if (found.kind == NearFacetsBuffers::Kind::facet_of_b) {
    out.witness_a = pair.pose_a->apply(pair.a->vertex(found.vertex)) - pair.margins.a * out.normal;
    out.witness_b = out.witness_a + out.translation;
  } else {
    const std::int32_t *const a = found.edge_a, *const b = found.edge_b;
    const double s = found.along_a, t = found.along_b;
    // Witnesses are made of the bodies' own vertices.
    const auto corner = [&](int i, int k) { return DifferenceVertex{Vec3::Zero(), a[i], b[k]}; };
    const DifferenceVertex corners[4] = {corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)};
    const double weights[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    set_witnesses_of_depth(pair, corners, weights, 4, out);
  }
}

/// Sets class, bracket and contact of a certified piece that holds the point below the origin.
void set_answer(const PolytopeQuery& query, const NearFacets& found, PenetrationDepth& out) {
  set_depth(query.pair, found.lower, found.upper, found.normal, out);
  set_features_of(found, out);
  set_witnesses_on(query.pair, found, out);
}

/// Up to four corners of a facet of P.
std::size_t corners_of_piece(PolytopeQuery& query, const NearFacets& piece, DifferenceVertex (&corners)[4]) {
  const PolytopeDifference& difference = query.with_supports();
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

/// For a proof, facets are listed that are farther than the nearest one by this many reaches: more than rounding.
constexpr double kTieBand = 0x1p-44;

/// Answers from what the Gauss maps have found, in doubles.
bool answer_from_gauss_maps(PolytopeQuery& query, const GaussSatDepth& found, PenetrationDepth& out) {
  const PolytopePair& pair = query.pair;
  const NearFacets& nearest = found.nearest;
  if (found.status == GaussSatStatus::separated) {
    DifferenceVertex corners[4];
    std::size_t count = 1;
    if (nearest.facet >= 0 || nearest.kind == NearFacetsBuffers::Kind::edges) {
      count = corners_of_piece(query, nearest, corners);
    } else {
      corners[0] = query.with_supports().vertex(found.corner.a, found.corner.b);
    }
    return answer_apart(query, closest_point(query, std::span(corners).first(count), out.statistics), out);
  }
  if (found.status == GaussSatStatus::undecided) return false;
  if (!found.foot) {
    set_answer(query, nearest, out);
    return true;
  }
  const Vec3& origin = pair.pose_a->translation();
  out.normal = nearest.normal;
  out.witness_a = found.foot->point_a + origin - pair.margins.a * out.normal;
  out.witness_b = found.foot->point_b + origin + pair.margins.b * out.normal;
  set_features_of(nearest, out);
  if (nearest.lower > 0) {
    set_depth(pair, nearest.lower, nearest.upper, nearest.normal, out);
    out.witness_b = out.witness_a + out.translation;
  } else {
    set_signed_distance(pair.margins.both(), -nearest.upper, -nearest.lower, out);
  }
  return true;
}

/// Answers for two boxes by the kernel for boxes.
bool answer_boxes(PolytopeQuery& query, PenetrationDepth& out) {
  const PolytopePair& pair = query.pair;
  const BoxQuestion question = query.for_contact()                  ? BoxQuestion::signed_depth
                               : query.bracket == Bracket::tightest ? BoxQuestion::near_pieces
                                                                    : BoxQuestion::depth;
  NearGaussPieces near;
  const GaussSatDepth found =
      gauss_sat_of_boxes({*pair.a, query.frame_a(), *pair.pose_a}, {*pair.b, query.frame_b(), *pair.pose_b},
                         query.width(), question, &near);
  out.method = Method::overlay;
  out.statistics.facets_visited += found.nearest.facets;
  if (question != BoxQuestion::near_pieces) return answer_from_gauss_maps(query, found, out);
  return prove_gauss_maps(query, found, near, out);
}

/// Answers by the nearest of the facets of P between the bounds of a surface (facets/near_facets.hpp). For the tightest
/// bracket it is proved.
bool answer_among_near_facets(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
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

}  // namespace

ExpansionGoal expansion_goal(const PolytopeQuery& query) {
  ExpansionGoal goal;
  goal.width = query.widest_bracket();
  goal.relative = query.settings.delta;
  goal.vertices = query.vertices();
  goal.max_steps = ExpansionBudget::max_steps(goal.vertices);
  if (!query.for_contact()) return goal;
  goal.close = kContactClose;
  goal.close_after = ContactBudget::kStepsToFull;
  goal.max_steps = std::min(goal.max_steps, ContactBudget::max_steps(goal.vertices));
  return goal;
}

bool answer_few_apart(PolytopeQuery& query, PenetrationDepth& out) {
  if (remembers_overlap(query)) return false;
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
  const PolytopePair& pair = query.pair;
  if (query.boxes()) {
    // Faces across a common axis tie on the stored numbers, which the surface proves sooner.
    if (query.bracket == Bracket::tightest && query.exact().has_an_own_coordinate()) return false;
    if (answer_boxes(query, out)) return true;
  }
  if (!gauss_sat_pays(query.difference)) return false;
  // The surface has a memory of the pair.
  if (query.warm || many_flush_facets(pair, query.difference)) return false;
  const bool tightest = query.bracket == Bracket::tightest;
  if (tightest && apart_between_places(query.with_supports())) return false;
  NearGaussPieces near;
  near.band = kTieBand * query.difference.reach();
  const GaussSatDepth found =
      gauss_sat_depth(*pair.pose_a, *pair.pose_b, query.with_supports(), query.width(), tightest ? &near : nullptr);
  out.method = Method::overlay;
  out.statistics.facets_visited += found.nearest.facets;
  out.statistics.support_calls += found.nearest.support_calls;
  if (tightest) {
    // The list reaches up to the nearest facet of either body; where edges are nearer, most of it is no tie.
    double least = near.radius * near.radius;
    for (int i = 0; i < near.count; ++i) least = near.pieces[i].key > 0 ? std::min(least, near.pieces[i].key) : least;
    near.keep_within(std::sqrt(least) + near.band, kGaussLowerError * query.difference.reach());
    return prove_gauss_maps(query, found, near, out);
  }
  return answer_from_gauss_maps(query, found, out);
}

ExpansionResult grow_surface(PolytopeQuery& query, PenetrationDepth& out) {
  ExpansionResult result;
  out.method = Method::expansion;
  const bool restored = query.warm && restore_surface(query);
  if (restored && query.doubles_suffice() && certify_restored_surface(query, result, out.statistics)) {
    out.warm = true;
    query.warm->state().direction = result.normal;
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

bool answer_from_surface(PolytopeQuery& query, PenetrationDepth& out) {
  const ExpansionResult& surface = query.surface;
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
  return found.upper - found.lower <= query.widest_bracket() || found.upper <= (1 + query.settings.delta) * found.lower;
}

ExpansionResult bounded(PolytopeQuery& query, ExpansionResult surface, Statistics& statistics) {
  if (!(surface.lower > 0)) return surface;
  ScratchBuffers& buffers = query.buffers;
  const HeightOfFace least =
      upper_bound_of_nearest_faces(query.with_supports(), buffers.surface, buffers.stack, statistics.support_calls);
  surface.upper = std::min(surface.upper, least.upper);
  return surface;
}

bool answer_among_many_facets(PolytopeQuery& query, PenetrationDepth& out) {
  const ExpansionResult found = bounded(query, query.surface, out.statistics);
  // A contact that may be left as it is, or whose facets are too many to try them all, has had its share.
  const bool enough = query.vertices() > kMostVerticesTried || found.upper <= (1 + kContactClose) * found.lower;
  if (query.for_contact() && enough) return false;
  if (answer_among_near_facets(query, found, out)) return true;
  return !query.for_contact() && answer_by_decomposition(query, found, out);
}

double relative_of_distance(const PolytopeQuery& query) {
  return query.pair.margins.both() > 0 ? 0.0 : query.settings.delta;
}

ClosestPoint closest_point(PolytopeQuery& query, std::span<const DifferenceVertex> start, Statistics& statistics) {
  // The tightest bracket's bits are those of the simplex, so that its search stays what it was.
  if (query.bracket != Bracket::tightest && !query.difference.climbs()) {
    const ClosestPoint found = closest_of_few(query.with_supports(), start, relative_of_distance(query), query.width(),
                                              statistics.support_calls);
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
