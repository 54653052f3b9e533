#include <algorithm>
#include <cmath>
#include <utility>

#include "depth/expansion/cached_surface.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

namespace {

/// Frames without a reference after one that was of no use.
constexpr int kLongestPause = 15;

}  // namespace

/// Most frames of a slowly moving pair: the nearest face of the remembered surface is still a supporting plane of P.
/// Computes a few planes and asks the neighbours of that face's vertices. False, and nothing said, otherwise.
bool PolytopeQuery::solve_from_memory() {
  if (!warm_ || !(warm_->state().reference.clearance > 0) || !within_range()) return false;
  const WarmCertificate::State& state = warm_->state();
  WarmCertificate::Reference& since = warm_->state().reference;
  if (!since.a->same_storage(*pair_.a) || !since.b->same_storage(*pair_.b)) return false;
  RememberedFace near;
  ExpansionResult result;
  if (!nearest_remembered(state, difference_, near) ||
      !supported(near.corners, near.normal, near.distance, near.largest, result)) {
    since.pause = since.uses > 0 ? 0 : std::min(2 * since.pause_length + 1, kLongestPause);
    since.pause_length = since.pause;
    return false;
  }
  ++since.uses;
  out_.method = Method::expansion;
  out_.warm = true;
  out_.statistics.support_calls += 1;
  out_.statistics.facets_visited += near.faces_seen;
  set_depth(result.lower, result.upper, result.normal);
  fill_overlapping(near.corners, near.weights);
  return true;
}

/// Whether the nearest face lies in a supporting plane of P, which its corners' neighbours tell: the depth.
bool PolytopeQuery::supported(const DifferenceVertex (&corners)[3], const Vec3& normal, double distance, double largest,
                              ExpansionResult& result) const {
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return false;
  const Vec3 unit = normal / std::sqrt(squared);
  DifferenceVertex s;
  if (!difference_.confirm_support(unit, s, corners)) return false;
  result.lower = distance - face_error(difference_);
  result.upper = s.x.dot(unit) + support_plane_error(difference_);
  if (!reached(goal(), result.lower, result.upper, largest)) return false;
  result.status = ExpansionStatus::certified;
  result.normal = unit;
  return true;
}

/// The restored surface answers as it stands.
bool PolytopeQuery::hold(ExpansionResult& result) {
  const Surface& surface = buffers_.surface;
  const int f = surface.nearest();
  if (!(surface.key(f) > 0)) return false;
  double largest = 0;
  for (const DifferenceVertex& v : surface.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
  DifferenceVertex corners[3];
  corners_of(f, corners);
  if (!supported(corners, surface.normal(f), std::sqrt(surface.key(f)), largest, result)) return false;
  result.face = f;
  out_.statistics.support_calls += 1;
  out_.statistics.facets_visited += surface.size();
  return true;
}

/// Bodies that were apart: the nearest point of P is looked for from the vertices round the last one. False, and
/// nothing said, where they overlap or doubles cannot tell.
bool PolytopeQuery::solve_apart_from_memory() {
  if (!warm_ || warm_->state().apart_count == 0 || !within_range()) return false;
  WarmCertificate::State& state = warm_->state();
  const int count = std::exchange(state.apart_count, 0);
  if (!is_memory_of_this_pair()) return false;
  DifferenceVertex start[3];
  difference_.turned_vertices(state.apart, count, start);
  difference_.turn(buffers_.posed);
  if (!fill_separated(std::span(start).first(static_cast<std::size_t>(count)))) {
    start_count_ = 0;
    return false;
  }
  out_.method = Method::expansion;
  out_.warm = true;
  state.direction = out_.normal;
  return true;
}

void PolytopeQuery::remember_apart(std::span<const VertexPair> simplex) {
  if (!warm_) return;
  own_memory();
  WarmCertificate::State& state = warm_->state();
  state.apart_count = static_cast<int>(simplex.size());
  for (std::size_t i = 0; i < simplex.size(); ++i) state.apart[i] = {simplex[i].a, simplex[i].b};
}

/// As far as numbers tell: ids are in range, and whatever they lead to is computed from the present poses.
bool PolytopeQuery::is_memory_of_this_pair() const {
  const WarmCertificate::State& state = warm_->state();
  return state.vertices_a == pair_.a->num_vertices() && state.vertices_b == pair_.b->num_vertices() &&
         state.radius_a == pair_.a->radius() && state.radius_b == pair_.b->radius();
}

void PolytopeQuery::own_memory() {
  if (!is_memory_of_this_pair()) warm_->clear();
  WarmCertificate::State& state = warm_->state();
  state.vertices_a = pair_.a->num_vertices();
  state.vertices_b = pair_.b->num_vertices();
  state.radius_a = pair_.a->radius();
  state.radius_b = pair_.b->radius();
}

/// Puts the last surface at the present poses. False when there is none for this pair.
bool PolytopeQuery::restore() {
  WarmCertificate::State& state = warm_->state();
  if (!is_memory_of_this_pair()) warm_->clear();
  if (state.faces.empty()) return false;
  Surface& surface = buffers_.surface;
  surface.clear();
  surface.vertices.resize(state.vertices.size());
  difference_.turned_vertices(state.vertices.data(), static_cast<int>(state.vertices.size()), surface.vertices.data());
  surface.restore(state.faces);
  return true;
}

void PolytopeQuery::remember(const ExpansionResult& result) {
  if (!warm_) return;
  WarmCertificate::State& state = warm_->state();
  own_memory();
  state.direction = result.normal;
  state.reference.clearance = 0;
  const bool certified = result.status == ExpansionStatus::certified;
  if (memory_held_ && certified) {
    // Where frames differ so much that the surface grew or the last reference was of no use, the next one would not be,
    // either.
    if (state.reference.pause > 0) {
      --state.reference.pause;
    } else {
      set_reference(state, buffers_.surface, difference_);
    }
    return;
  }
  state.vertices.clear();
  state.faces.clear();
  state.vertices.reserve(kMaxRememberedVertices);
  state.faces.reserve(kMaxRememberedFaces);
  state.reference.distances.reserve(kMaxRememberedFaces);
  state.reference.spreads.reserve(kMaxRememberedFaces);
  if (certified && buffers_.surface.size() <= kMaxRememberedFaces) buffers_.surface.save(state.vertices, state.faces);
}

}  // namespace pd::detail
