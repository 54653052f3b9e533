/// @file
/// How deep two polygons are inside each other, along a direction and over all directions, and how one of them gets
/// away.
///
/// P is fixed, Q placed at y (every point of Q plus y) and Q MOVES. The forbidden placements are R = P + (-Q),
/// regularised: the interior of the closure of {y : int P meets int (Q + y)}. A place of zero area where Q fits exactly
/// (a seat: a point, or a slot of zero width) is no way out. Then
///   sigma_d(y) = min {t >= 0 : y + t d/|d| not in R},     sigma(y) = min over d: the distance from y to the boundary
///   of R.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993, sections 2 and 4.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/planar/contact.hpp"
#include "pd/planar/polygon.hpp"

namespace pd {

enum class PolygonMethod {
  automatic,      ///< implicit where P or Q is convex, else explicit_sums
  implicit,       ///< [D] Theorem 4.4: arcs of -Q as index ranges; needs a convex P or Q
  explicit_sums,  ///< the union of all sums of two convex parts, edge by edge
};

/// The budget of explicit sums, in comparisons of an edge with a convex sum; an exact intersection counts as 16. Two
/// jagged polygons of 500 vertices take 5 to 25 million, some 200 nanoseconds each. The default ends within five
/// seconds.
inline constexpr std::int64_t kPolygonComparisons = std::int64_t{24} << 20;

/// The feature of P and Q that holds the answer: a vertex or an edge (from that vertex on), as the caller numbered it.
struct PlanarFeature {
  Polygon::VertexId p, q;
  bool p_edge = false, q_edge = false;
};

/// Radii of discs that sweep P and Q. A single point swept is a disc.
struct PlanarMargins {
  double p = 0, q = 0;
};

struct PolygonDepth {
  PlanarContact contact = PlanarContact::separated;
  /// lower <= exact depth <= upper, which are neighbouring doubles or equal. `depth` is `upper`. 0 unless overlapping.
  double depth = 0, lower = 0, upper = 0;
  Point2 translation = {0, 0};  ///< of Q, rounded; its length is the depth up to 4 ulp
  /// Unit vector along the translation. When touching it is a direction in which Q leaves P. It is {0, 0} when
  /// separated and when no boundary is in the way.
  Point2 normal = {0, 0};
  std::optional<PlanarFeature> feature;
};

/// How far to go along a direction.
enum class Leave {
  first_exit,  ///< sigma_d: until the interiors are disjoint
  straight,    ///< from where Q can go on along the direction for ever
  escape,      ///< until some motion leads from there to infinity: the unbounded face of the complement of R is reached
};

class SweptDifference;

/// The boundary of R, prepared for any number of placements.
class PolygonDifference {
 public:
  /// @return ErrorCode::unsupported for the implicit method where neither is convex; ErrorCode::limit_exceeded where
  /// explicit sums take more than `max_comparisons`.
  /// Time O((n + k) log^2 m) for the implicit method. k counts the pairs of a part of P's boundary and a triangle of
  /// P that Q, slid along the part, meets. O(s^2) at worst for s sums of the explicit one. Space O(n + m), and O(s).
  static Expected<PolygonDifference> of(const Polygon& p, const Polygon& q,
                                        PolygonMethod method = PolygonMethod::automatic,
                                        std::int64_t max_comparisons = kPolygonComparisons);

  [[nodiscard]] PlanarContact contact(const Point2& placement) const;
  /// sigma. Requires a finite placement.
  [[nodiscard]] PolygonDepth depth(const Point2& placement) const;
  /// sigma_d, or how far to leave for good. Requires finite numbers and a direction that is not 0. `boxes` counts the
  /// boxes that the ray from the placement looks into.
  [[nodiscard]] PolygonDepth depth_along(const Point2& placement, const Point2& direction,
                                         Leave leave = Leave::first_exit, std::int64_t* boxes = nullptr) const;
  /// The least translation in any direction that brings Q into the unbounded face.
  [[nodiscard]] PolygonDepth escape_depth(const Point2& placement) const;

  /// The least translation over all directions from whose end Q can go on along the same direction for ever: the least
  /// of depth_along(placement, d, Leave::straight). It may slide along P; 0 where some direction is free at once.
  /// Time O(N (log N + k)) for N edges of the boundary, k of them looked at for one direction.
  [[nodiscard]] PolygonDepth straight_escape_depth(const Point2& placement) const;

  /// depth() or, for another `leave`, escape_depth() and straight_escape_depth() of P and Q, each swept by the disc of
  /// its margin. The class is exact. For convex P and Q so is the depth, as above. Else the depth is upper, and upper -
  /// lower <= 1e-6 upper unless 20,000 boxes of placements do not suffice: the bracket is certified either way.
  /// For another `leave`, and one convex polygon, the answer lies between those of two regular polygons of 8,192
  /// corners in place of the disc. This bracket is certified and some 1e-6 of the margins wide. It is wider where a
  /// passage is as wide as Q within that. The first such question makes two differences, which are kept.
  /// @return bad_value or non_finite for margins that are negative or not finite, out_of_range for one above 1e300.
  /// Another `leave` refuses margins that take the swept polygons beyond 1e300, too. non_finite or out_of_range
  /// ("placement"). unsupported for another `leave` than first_exit where neither P nor Q is convex.
  [[nodiscard]] Expected<PolygonDepth> swept_depth(const Point2& placement, const PlanarMargins& margins,
                                                   Leave leave = Leave::first_exit) const;
  /// depth_along() in the same way. The bracket is certified, some 1e-10 of the depth wide, and wider where Q grazes P.
  /// Leave::escape is bracketed as above.
  /// @return errors as above, and zero_direction, non_finite or out_of_range ("direction"); Leave::straight is answered
  /// for all polygons.
  [[nodiscard]] Expected<PolygonDepth> swept_depth_along(const Point2& placement, const Point2& direction,
                                                         const PlanarMargins& margins,
                                                         Leave leave = Leave::first_exit) const;

  struct Statistics {
    std::int64_t sums;           ///< convex sums whose union R is
    std::int64_t stretches;      ///< implicit pieces of the boundary: displaced edges and arcs
    std::int64_t arcs;           ///< stretches that are arcs of Q or P
    std::int64_t reflex_points;  ///< of the boundary
    std::int64_t reflex_bound;   ///< 6 sums - 12 for 3 or more of them ([D] Fact 4.2), implicit method
    std::int64_t crossings;      ///< of pieces of the boundary with sums of other triangles, implicit method
    /// Of one sum's pieces with the boundary of one other sum: at most 2 ([D] Fact 4.1), implicit method.
    std::int64_t most_crossings;
    std::int64_t loops;      ///< closed curves of the boundary: 1 + holes of R
    std::int64_t pairs;      ///< pieces and sums that were intersected
    std::int64_t locations;  ///< points located in a convex sum for it
    std::int64_t memory_bytes;
    bool implicit;
    /// Facts 4.1 and 4.2 held, as they must: checked while an implicit boundary is made. If not, it was given up for
    /// explicit sums, and the four counts above are those that contradicted them.
    bool facts_hold;
  };
  [[nodiscard]] Statistics statistics() const;

  /// A curve of the boundary for drawing, rounded; loop 0 is the outer one. They come loop after loop, each beginning
  /// where the one before it ends.
  struct Curve {
    int loop;
    bool arc;
    std::vector<Point2> points;
  };
  [[nodiscard]] std::vector<Curve> boundary_curves() const;
  /// The interiors of P and Q do not meet at the placement, and yet it is no way out: Q fits exactly, and every small
  /// move but along a slot makes the two overlap.
  [[nodiscard]] bool seat(const Point2& placement) const;
  /// All such placements, rounded.
  struct Seats {
    std::vector<Point2> points;                ///< single ones, in lexicographic order
    std::vector<std::array<Point2, 2>> slots;  ///< segments that Q can slide along, each once, the lesser end first
  };
  /// Time O(that of making the difference).
  [[nodiscard]] Seats seats() const;

 private:
  friend class DirectionSet;
  friend class SweptDifference;
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace pd
