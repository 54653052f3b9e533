#include <cmath>

#include "depth/polytope_query.hpp"
#include "depth/remembered_surface.hpp"

namespace pd::detail {

/// Most frames of a moving pair: the nearest face of the remembered surface is still a supporting plane of P. Computes
/// a few planes and asks the neighbours of that face's vertices. False, and nothing said, otherwise.
bool PolytopeQuery::solve_from_memory() {
  if (!warm_ || !within_range()) return false;
  const WarmCertificate::State& state = warm_->state();
  const WarmCertificate::Reference& since = state.reference;
  if (!since.a || !since.a->same_storage(*pair_.a) || !since.b->same_storage(*pair_.b)) return false;
  RememberedFace near;
  if (!nearest_remembered(state, difference_, near)) return false;
  const double squared = near.normal.squaredNorm();
  if (!(squared > 0)) return false;
  const Vec3 unit = near.normal / std::sqrt(squared);
  DifferenceVertex s;
  if (!difference_.confirm_support(unit, s, near.corners)) return false;
  const double lower = near.distance - face_error(difference_);
  const double upper = s.x.dot(unit) + support_plane_error(difference_);
  if (!reached(goal(), lower, upper, near.largest)) return false;
  out_.method = Method::expansion;
  out_.warm = true;
  out_.statistics.support_calls += 1;
  out_.statistics.facets_visited += near.faces_seen;
  set_depth(lower, upper, unit);
  fill_overlapping(near.corners, near.weights);
  return true;
}

/// Puts the last surface at the present poses. False when there is none for this pair.
bool PolytopeQuery::restore() {
  WarmCertificate::State& state = warm_->state();
  if (state.vertices_a != pair_.a->num_vertices() || state.vertices_b != pair_.b->num_vertices() ||
      state.radius_a != pair_.a->radius() || state.radius_b != pair_.b->radius()) {
    warm_->clear();
  }
  if (state.faces.empty()) return false;
  Surface& surface = buffers_.surface;
  surface.clear();
  for (const auto& v : state.vertices) surface.vertices.push_back(difference_.vertex(v.a, v.b));
  surface.restore(state.faces);
  return true;
}

void PolytopeQuery::remember(const ExpansionResult& result) {
  if (!warm_) return;
  WarmCertificate::State& state = warm_->state();
  state.vertices_a = pair_.a->num_vertices();
  state.vertices_b = pair_.b->num_vertices();
  state.radius_a = pair_.a->radius();
  state.radius_b = pair_.b->radius();
  state.direction = result.normal;
  state.reference.clearance = 0;
  const bool certified = result.status == ExpansionStatus::certified;
  if (!(memory_held_ && certified)) {
    state.vertices.clear();
    state.faces.clear();
    state.vertices.reserve(kMaxRememberedVertices);
    state.faces.reserve(kMaxRememberedFaces);
    state.reference.keys.reserve(kMaxRememberedFaces);
    if (!certified || buffers_.surface.size() > kMaxRememberedFaces) return;
    buffers_.surface.save(state.vertices, state.faces);
  }
  buffers_.surface.save_keys(state.reference.keys);
  set_reference(state, buffers_.surface, difference_);
}

}  // namespace pd::detail
