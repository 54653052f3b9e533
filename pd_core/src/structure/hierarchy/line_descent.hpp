/// @file
/// The facet of an outer hierarchy's finest level by which a line enters, followed from coarse to fine ([D] Lemma 5.2).
///
/// In a fixed plane through the line every level is a convex polygon; the line enters it by the edge that lies in a
/// facet F, whose two ends are F's crossings with two neighbours. A facet u that comes in at the next finer level and
/// cuts off the point of entry cuts off one of the two ends, hence a corner of F at that end: u's removal created it
/// (`shadow_descent.hpp`, by polarity: facets as elements, corners as triangles). Where u is a facet by which the line
/// leaves, the line misses this level and all finer ones: in u's cap it enters and leaves without meeting the rest.
#pragma once

#include <cstdint>

#include "pd/structure/polyhedral_hierarchy.hpp"
#include "structure/hierarchy/shadow_descent.hpp"

namespace pd::detail {

/// Facets of a polytope where they cross a plane through a line: <n, x - point> = slope s + across u <= offset for x at
/// point + s direction + u sideways. All in doubles.
class LineView {
 public:
  struct Row {
    double slope, across, offset;
  };

  LineView(const ConvexPolytope& polytope, const Vec3& point, const Vec3& direction);

  [[nodiscard]] Row row(int facet) const;
  void stand_at(int facet) {
    at_ = row(facet);
    time_ = at_.offset / at_.slope;
    blocker_ = -1;
  }
  /// `up` > 0: cuts off the point of entry. Remembers a facet that does so and lets nothing in.
  [[nodiscard]] ShadowStep step_to(int facet) {
    const Row other = row(facet);
    const double beyond = other.slope * time_ - other.offset;
    if (beyond > 0 && other.slope >= 0) blocker_ = facet;
    return {other.across * at_.slope - other.slope * at_.across, beyond};
  }
  /// How far the point of entry lies behind a facet.
  [[nodiscard]] double room(int facet) const {
    const Row other = row(facet);
    return other.offset - other.slope * time_;
  }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double slope() const { return at_.slope; }
  [[nodiscard]] bool blocked() const { return blocker_ >= 0; }
  [[nodiscard]] int blocker() const { return blocker_; }

 private:
  const ConvexPolytope* polytope_;
  Vec3 point_, direction_, sideways_;
  Row at_{-1, 0, 0};
  double time_ = 0;
  int blocker_ = -1;
};

/// What doubles found; rounding may be wrong about either.
struct LineEntry {
  int facet = -1;    ///< by which the line enters the finest level, -1: found none that faces the line
  int blocker = -1;  ///< a facet by which the line has left before it enters; -1: it meets the finest level
  std::int64_t evaluations = 0;
};

/// Requires an outer hierarchy. Time O(log n).
[[nodiscard]] LineEntry enter_outer_hierarchy(const PolyhedralHierarchy& hierarchy, const Vec3& point,
                                              const Vec3& direction);

}  // namespace pd::detail
