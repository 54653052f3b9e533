/// @file
/// Rays, nearest points and classes of placements over the boundary of R, every comparison decided exactly.
#pragma once

#include <optional>
#include <vector>

#include "pd/planar/polygon_depth.hpp"
#include "planar/boundary/box_tree.hpp"
#include "planar/boundary/sum_boundary.hpp"
#include "planar/boundary/turned_boxes.hpp"

namespace pd::detail {

/// A point of the boundary: where a ray meets an edge of it, or its point nearest to a placement.
struct BoundaryPoint {
  std::int32_t stretch = -1;
  int edge = 0;
  Place at;  ///< on the edge
};

/// A number that is not negative, as a root: sqrt(numerator / denominator).
struct SquaredLength {
  Dyadic numerator = 0;
  Dyadic denominator = 1.0;
};

class RaySearch;

class BoundaryQuery {
 public:
  explicit BoundaryQuery(const SumBoundary& boundary);

  /// A placement as a point of R's plane.
  [[nodiscard]] static SumPoint point(const Point2& placement) { return {placement, {0, 0}}; }

  /// `touched`: where it lies on the boundary. Found by the first crossing of a ray; where that is in doubt, by the
  /// convex sums themselves.
  [[nodiscard]] PlanarContact contact(const Point2& y, std::optional<BoundaryPoint>* touched = nullptr) const;
  /// Class and first point of the boundary on the ray from y along d, in one search. `boxes` counts those looked into.
  [[nodiscard]] PlanarContact contact_and_hit(const Point2& y, const Point2& d, std::optional<BoundaryPoint>& touched,
                                              std::optional<BoundaryPoint>& hit, std::int64_t* boxes = nullptr) const;
  /// The nearest point of the boundary (of loop 0 alone); among equals the one that is least by its coordinates.
  [[nodiscard]] std::optional<BoundaryPoint> nearest(const Point2& y, bool outer_only) const;
  /// The first point of the boundary (of loop 0 alone) on the ray from y.
  [[nodiscard]] std::optional<BoundaryPoint> first_on_ray(const Point2& y, const Point2& d, bool outer_only) const;
  /// Where the ray from y leaves R for good, as a place on the ray; nothing where it never is in R.
  [[nodiscard]] std::optional<Place> last_exit(const Point2& y, const Point2& d) const;
  /// For a placement outside R: does it lie in the unbounded face, or on its boundary?
  [[nodiscard]] bool in_unbounded_face(const Point2& y) const;

  /// For a placement in R: do the interiors of P and Q not meet there?
  [[nodiscard]] bool is_seat(const Point2& y) const;

  [[nodiscard]] const SumBoundary& boundary() const { return boundary_; }
  [[nodiscard]] const BoxTree& stretch_tree() const { return stretch_tree_; }
  [[nodiscard]] const BoxTree& sum_tree() const { return sum_tree_; }
  [[nodiscard]] const BoxTree& slot_tree() const { return slot_tree_; }
  [[nodiscard]] const TurnedBoxes& ray_tree() const { return ray_tree_; }
  [[nodiscard]] Span span_of(const BoundaryPoint& x) const;
  [[nodiscard]] std::size_t memory_bytes() const {
    return stretch_tree_.memory_bytes() + sum_tree_.memory_bytes() + slot_tree_.memory_bytes() +
           ray_tree_.memory_bytes() + ends_.capacity() * sizeof(EdgeEnds);
  }

 private:
  struct NearestSearch;
  /// A stretch of one edge by its ends, within 2^-51 `size`.
  struct EdgeEnds {
    Point2 a, b;
    double size;
    std::int32_t stretch;
    std::int32_t edge;                         ///< or one of these:
    static constexpr std::int32_t kOpen = -1;  ///< at least one end is the edge's, beyond the stretch's
    static constexpr std::int32_t kArc = -2;   ///< more than one edge; no ends
  };

  /// The class of y by the first stretch that the ray along d crosses: R lies on the left of it. Nothing where the ray
  /// begins on the boundary, or its first meeting with it is no crossing inside one edge.
  [[nodiscard]] std::optional<PlanarContact> contact_by_ray(const Point2& y, const Point2& d,
                                                            std::optional<BoundaryPoint>& hit,
                                                            std::int64_t* boxes = nullptr) const;
  void add_ray_items();
  void search_ray(RaySearch& search, const Point2& d, bool outer_only) const;
  [[nodiscard]] PlanarContact contact_by_sums(const Point2& y, std::optional<BoundaryPoint>* touched) const;
  [[nodiscard]] std::optional<BoundaryPoint> touch(const Point2& y, bool outer_only) const;

  const SumBoundary& boundary_;
  BoxTree stretch_tree_, sum_tree_, slot_tree_;
  std::vector<EdgeEnds> ends_;  ///< of every stretch, in the order of the tree of rays
  TurnedBoxes ray_tree_;
};

}  // namespace pd::detail
