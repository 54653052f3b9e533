/// @file
/// The least way straight out: the least t over all directions d with y + t' d outside R for every t' >= t.
///
/// Along d the way is f(d) = sup {t : y + t d in R}, R open: the far envelope of the boundary seen from y. f is lower
/// semicontinuous, and between directions in which the envelope changes from one edge to another it is the distance to
/// one line. So its least value is at the foot of a perpendicular, or in the direction of an end of a stretch or of a
/// point where an arc is touched by a line from y. All of these are tried, those that a crossing farther out than the
/// best one rules out by doubles, the others exactly ([D] section 6, complete separation). Such a crossing is looked
/// for first from the best one's distance on, down the tree of turned boxes: nearly every direction has one close to
/// there.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "planar/boundary/boundary_query.hpp"
#include "planar/polygon_answer.hpp"

namespace pd::detail {

class StraightEscape {
 public:
  StraightEscape(const SumBoundary& boundary, const BoundaryQuery& query, const Point2& y)
      : boundary_(boundary), tree_(query.stretch_tree()), rays_(query.ray_tree()), y_(y) {}

  struct Way {
    ExactVector move;
    std::optional<BoundaryPoint> exit;  ///< nothing where the ray meets R nowhere: the move is 0
  };
  /// Among equal ones that of the least place by its coordinates. Time O(N (log N + k)) for a boundary of N edges and k
  /// pieces looked at in a direction.
  [[nodiscard]] Way run();

 private:
  /// A direction: to a place on an edge, or the edge's right normal.
  struct Candidate {
    Span span;
    Place place;
    bool foot;
    double low;  ///< a bound of the way along it
  };
  /// An edge part that the line along a direction may meet.
  struct Piece {
    std::int32_t stretch;
    int edge;
  };
  struct Hit {
    Piece piece;
    Dyadic numerator, denominator;  ///< of t along the direction; the denominator is positive
    int right, left;                ///< 1 leaving R, -1 entering it, 0 not there: beside the ray, clockwise and not
  };

  void collect();
  void collect_edge(std::int32_t stretch, int edge, int& side_before);
  void attempt(const Candidate& candidate);
  template <class N>
  [[nodiscard]] Vector2<N> direction(const Candidate& candidate) const;
  [[nodiscard]] std::optional<Point2> rounded_direction(const Candidate& candidate) const;
  /// A crossing of the ray with an edge part is certain, and not nearer than this; 0: none is.
  [[nodiscard]] double certain_crossing(const EdgePart& part, const Vector2<Estimate>& d, const Point2& rounded) const;
  /// A crossing beyond the best way is certain, with an edge that stands alone.
  [[nodiscard]] bool blocked(const Vector2<Estimate>& d, const Point2& rounded) const;
  /// False where a crossing beyond the best way is certain.
  [[nodiscard]] bool gather(const Vector2<Estimate>& d, const Point2& rounded, std::vector<Piece>& pieces) const;
  [[nodiscard]] std::optional<Hit> meet(const Piece& piece, const Vector2<Dyadic>& d) const;
  void finish(std::vector<Hit>& hits, const Vector2<Dyadic>& d);
  void offer(const ExactVector& move, const std::optional<BoundaryPoint>& exit);
  template <class N>
  [[nodiscard]] N beside(const Vector2<N>& d, const Span& span, const Place& place) const;

  const SumBoundary& boundary_;
  const BoxTree& tree_;
  const TurnedBoxes& rays_;
  Point2 y_;
  std::vector<Candidate> feet_, corners_;
  std::optional<Way> best_;
  Dyadic best_squared_, best_weight_;                       ///< of the best one's length, as a fraction
  double limit_ = std::numeric_limits<double>::infinity();  ///< not below the best one's length
};

}  // namespace pd::detail
