#include "depth/pair/polytope_warm_start.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "depth/distance/closest_of_few.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_double.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

/// As far as numbers tell: ids are in range, and whatever they lead to is computed from the present poses.
bool is_of_pair(const WarmState& state, const PolytopePair& pair) {
  return state.vertices_a == pair.a->num_vertices() && state.vertices_b == pair.b->num_vertices() &&
         state.radius_a == pair.a->radius() && state.radius_b == pair.b->radius();
}

/// Cleared, unless it is this pair's already.
WarmState& bind_to_pair(WarmCertificate& warm, const PolytopePair& pair) {
  if (!is_of_pair(warm.state(), pair)) warm.clear();
  WarmState& state = warm.state();
  state.vertices_a = pair.a->num_vertices();
  state.vertices_b = pair.b->num_vertices();
  state.radius_a = pair.a->radius();
  state.radius_b = pair.b->radius();
  return state;
}

/// Whether the nearest face lies in a supporting plane of P, which its corners' neighbours tell: the depth.
bool certify_face(const PolytopeQuery& query, const DifferenceVertex (&corners)[3], const Vec3& normal, double distance,
                  ExpansionResult& result) {
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return false;
  const Vec3 unit = normal / std::sqrt(squared);
  DifferenceVertex s;
  if (!query.difference.confirm_support(unit, s, corners)) return false;
  result.lower = distance - face_error(query.difference);
  result.upper = s.x.dot(unit) + support_plane_error(query.difference);
  if (!reached(expansion_goal(query), result.lower, result.upper, query.difference.reach())) return false;
  result.status = ExpansionStatus::certified;
  result.normal = unit;
  return true;
}

}  // namespace

bool answer_from_memory(PolytopeQuery& query, PenetrationDepth& out) {
  WarmState& state = query.warm->state();
  if (state.apart_count == 0) return false;
  const int count = std::exchange(state.apart_count, 0);
  if (!is_of_pair(state, query.pair)) return false;
  out.statistics.support_calls += 1;
  const auto ids = std::span(state.apart).first(static_cast<std::size_t>(count));
  ClosestPoint nearest = confirm_closest_point(query.difference, ids, relative_of_distance(query), query.width());
  if (!nearest.certified) {
    DifferenceVertex vertices[3];
    query.difference.posed_vertices(ids.data(), count, vertices);
    nearest = closest_point(query, std::span(vertices).first(ids.size()), out.statistics);
  }
  if (!answer_apart(query, nearest, out)) return false;
  out.method = Method::expansion;
  out.warm = true;
  return true;
}

bool remembers_overlap(const PolytopeQuery& query) { return query.warm && !query.warm->state().faces.empty(); }

bool restore_surface(PolytopeQuery& query) {
  if (!is_of_pair(query.warm->state(), query.pair)) query.warm->clear();
  const WarmState& state = query.warm->state();
  if (state.faces.empty()) return false;
  InnerSurface& surface = query.buffers.surface;
  surface.clear();
  surface.vertices.resize(state.vertices.size());
  query.difference.posed_vertices(state.vertices.data(), static_cast<int>(state.vertices.size()),
                                  surface.vertices.data());
  surface.restore(state.faces);
  return true;
}

bool certify_restored_surface(PolytopeQuery& query, ExpansionResult& result, Statistics& statistics) {
  const InnerSurface& surface = query.buffers.surface;
  const int f = surface.nearest();
  if (!(surface.key(f) > 0)) return false;
  DifferenceVertex corners[3];
  face_corners(surface, f, corners);
  if (!certify_face(query, corners, surface.normal(f), std::sqrt(surface.key(f)), result)) return false;
  result.face = f;
  statistics.support_calls += 1;
  statistics.facets_visited += surface.size();
  return true;
}

Vec3 warm_direction(const PolytopeQuery& query) {
  return query.warm ? query.warm->state().direction : Vec3(Vec3::Zero());
}

void save_surface(PolytopeQuery& query, const ExpansionResult& result) {
  if (!query.warm) return;
  WarmState& state = bind_to_pair(*query.warm, query.pair);
  state.direction = result.normal;
  state.vertices.clear();
  state.faces.clear();
  state.vertices.reserve(kMaxRememberedVertices);
  state.faces.reserve(kMaxRememberedFaces);
  InnerSurface& surface = query.buffers.surface;
  const bool certified = result.status == ExpansionStatus::certified;
  if (certified && surface.size() <= kMaxRememberedFaces) surface.save(state.vertices, state.faces);
}

void save_simplex(PolytopeQuery& query, const ClosestPoint& nearest) {
  if (!query.warm) return;
  WarmState& state = bind_to_pair(*query.warm, query.pair);
  state.direction = nearest.normal;
  state.apart_count = nearest.count;
  for (int i = 0; i < nearest.count; ++i) state.apart[i] = {nearest.simplex[i].a, nearest.simplex[i].b};
}

}  // namespace pd::detail
