/// @file
/// The extreme vertex of an inner hierarchy's levels in one direction, followed from coarse to fine ([D] Lemma 5.4), by
/// the shadow along a second direction (`shadow_descent.hpp`). Rounding may choose another vertex within rounding of
/// the best; who needs the exact one climbs on from there.
#pragma once

#include <cstdint>

#include "pd/structure/polyhedral_hierarchy.hpp"
#include "structure/hierarchy/shadow_descent.hpp"

namespace pd::detail {

/// Vertices seen across a direction that is up.
class DirectionView {
 public:
  DirectionView(const ConvexPolytope& polytope, const Vec3& direction);

  void stand_at(int vertex) { at_ = polytope_->vertex(vertex); }
  [[nodiscard]] ShadowStep step_to(int vertex) const {
    const Vec3 step = polytope_->vertex(vertex) - at_;
    return {step.dot(sideways_), step.dot(direction_)};
  }
  [[nodiscard]] static bool blocked() { return false; }

 private:
  const ConvexPolytope* polytope_;
  Vec3 direction_;
  Vec3 sideways_;
  Vec3 at_ = Vec3::Zero();
};

class PlaneDescent {
 public:
  /// At the coarsest level.
  PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction);
  /// At the coarsest level that has this vertex, which must be extreme there up to rounding.
  PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction, int vertex);

  [[nodiscard]] int vertex() const { return descent_.element(); }
  /// The coarsest level for which `vertex` is known to be extreme.
  [[nodiscard]] int level() const { return descent_.level(); }
  /// Goes on to the next finer level with another extreme vertex. False when there is none down to `finest`.
  bool next(int finest = 0) { return descent_.next(finest); }

  /// Vertices evaluated.
  [[nodiscard]] std::int64_t evaluations() const { return descent_.evaluations(); }

 private:
  ShadowDescent<DirectionView> descent_;
};

/// Across `direction`, in no simple ratio to the edges of most bodies.
[[nodiscard]] Vec3 sideways_of(const Vec3& direction);

}  // namespace pd::detail
