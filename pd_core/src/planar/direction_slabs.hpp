/// @file
/// The trapezoids between the pieces of a boundary, cut along one direction d: which piece lies ahead of a point, in
/// O(log n) ([D] section 6, fixed sets of directions).
///
/// A line along d sweeps over the pieces. None crosses another, so that "behind, along d" is a partial order; numbered
/// in such an order, the pieces that the line meets are a set of numbers, sorted along d. The set is kept in a tree
/// over all numbers, of which every event copies one path: all its states stay, in O(n log n) space.
#pragma once

#include <array>
#include <vector>

#include "planar/monotone_boundary.hpp"

namespace pd::detail {

class DirectionSlabs {
 public:
  explicit DirectionSlabs(MonotoneBoundary boundary);

  /// The line along d through y: on an event (an end of a piece), or between two. -1: before the first one.
  struct Column {
    std::int32_t event;
    bool on_event;
  };
  [[nodiscard]] Column column(const Point2& y, std::int64_t& probes) const;

  /// Neighbours of y along d among the pieces that stand over the column: `ahead` is the first one that y is not
  /// strictly past, `behind` the last one that it is; -1 for none.
  struct Neighbours {
    std::int32_t behind = -1, ahead = -1;
    bool on = false;  ///< y lies on the line of `ahead`
  };
  /// `closed`: with the pieces that end on the column; otherwise those just beyond it, as u grows.
  [[nodiscard]] Neighbours neighbours(const Point2& y, const Column& column, bool closed, std::int64_t& probes) const;
  /// The piece after that one, among those on the closed column; -1 for none.
  [[nodiscard]] std::int32_t next(std::int32_t piece, const Column& column) const;

  [[nodiscard]] const MonotoneBoundary& boundary() const { return boundary_; }
  [[nodiscard]] const MonotonePiece& piece(std::int32_t i) const {
    return boundary_.pieces()[static_cast<std::size_t>(i)];
  }
  /// Does the piece start (or end) on the column?
  [[nodiscard]] bool starts_at(std::int32_t piece, const Column& column) const;
  [[nodiscard]] bool ends_at(std::int32_t piece, const Column& column) const;
  /// The edge along d that holds y, ends included, as an index into boundary().along(); -1 for none.
  [[nodiscard]] std::int32_t along_at(const Point2& y, const Column& column, std::int64_t& probes) const;

  [[nodiscard]] std::int64_t num_events() const { return static_cast<std::int64_t>(event_.size()); }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  friend class SlabSweep;
  struct End {
    Homogeneous<Estimate> x;
    std::int32_t piece;  ///< below 0: of the edge along d with number -1 - piece
    bool end;
  };
  struct Extent {
    std::int32_t low, high;  ///< events
  };
  struct Node {
    std::int32_t left, right;
    std::int32_t last;  ///< the greatest number below it
  };

  template <class N>
  [[nodiscard]] Homogeneous<N> point(const End& e) const;
  [[nodiscard]] const MonotonePiece& piece_of(const End& e) const;
  /// Sign of u(a) - u(b).
  [[nodiscard]] int compare(const End& a, const End& b) const;
  /// Sign of u(y) - u(e).
  [[nodiscard]] int compare(const Point2& y, const End& e) const;
  /// 1 where x is past the piece along d, -1 where the piece is ahead of it, 0 on its line.
  [[nodiscard]] int past(const Point2& y, std::int32_t piece) const;
  [[nodiscard]] int past(const End& e, std::int32_t piece) const;

  void find_events();
  std::int32_t with(std::int32_t root, std::int32_t number, bool present);

  MonotoneBoundary boundary_;
  std::vector<End> event_;      ///< one end each, as u grows
  std::vector<Extent> extent_;  ///< of every piece
  std::vector<Line2<Estimate>> line_;
  std::vector<std::int32_t> number_, piece_numbered_;
  std::vector<Node> node_;
  std::vector<std::array<std::int32_t, 2>> root_;  ///< per event: on it, beyond it
  std::vector<std::int32_t> along_begin_, along_;  ///< per event: edges along d, sorted
  std::int32_t width_ = 1;                         ///< of the tree: a power of two
};

}  // namespace pd::detail
