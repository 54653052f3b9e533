/// @file
/// Kernels by a growing radial hull (`pd/dimension/epsilon_kernel.hpp`), over points that come in chunks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dimension/cell_reach.hpp"
#include "dimension/direction_cells.hpp"
#include "dimension/radial_hull.hpp"
#include "pd/dimension/affine_map.hpp"

namespace pd::dimension::detail {

/// Below, rounding in fattened frames of bodies of aspect 1e6 is no longer far below epsilon.
inline constexpr double kLeastEpsilon = 1e-7;

class KernelBuilder {
 public:
  struct Point {
    AnyVector point;  ///< as given
    AnyVector unit;   ///< in the frame
    std::int64_t index;
  };

  /// @param to_unit  maps the body to a set that holds the unit ball about the origin (up to 1e-9).
  KernelBuilder(const AnyMap& to_unit, double epsilon);

  /// Points index, index + 1, ... of the body.
  void add(Points chunk, std::int64_t index);

  /// In the order of their choice; those that later ones buried are among them.
  [[nodiscard]] const std::vector<Point>& kernel() const { return kernel_; }
  [[nodiscard]] const RadialHull& hull() const { return hull_; }
  /// Kernel points without a place in the hull.
  [[nodiscard]] const std::vector<std::int32_t>& unplaced() const { return unplaced_; }
  /// The kernel: the vertices of the hull and the unplaced points, in the order of their indices.
  [[nodiscard]] std::vector<Point> chosen() const;
  /// Kernel point of a hull's vertex, -1 for those of the start.
  [[nodiscard]] std::int32_t kernel_of_vertex(std::int32_t v) const {
    return v < hull_.start_vertices() ? -1 : vertex_owner_[v - hull_.start_vertices()];
  }
  [[nodiscard]] const AnyMap& to_unit() const { return to_unit_; }
  /// K lies in this times the hull.
  [[nodiscard]] double limit() const { return limit_; }
  [[nodiscard]] std::int64_t cones_visited() const { return cones_visited_; }

 private:
  struct Waiting {
    double gauge;
    std::int32_t facet;
    friend bool operator<(const Waiting& a, const Waiting& b) {
      return a.gauge != b.gauge ? a.gauge < b.gauge : a.facet > b.facet;
    }
  };
  void add_block(const Points& block, std::int64_t index);
  void sort_candidates();
  void prepare_block(std::size_t size);
  void assign(std::int32_t i, std::int32_t start);
  void drain();
  bool enter(const Point& p, std::int32_t f);

  AnyMap to_unit_;
  AnyVector centre_;
  double limit_;
  RadialHull hull_;
  DirectionCells cells_;
  std::vector<std::int32_t> hints_;  ///< per cell: the facet of the last point located from there
  CellReach reach_;
  double near_squared_ = 0;   ///< points this near to the origin are inside whatever their direction
  std::int64_t located_ = 0;  ///< points whose cone was searched since the last survey of `reach_`
  std::int64_t spared_ = 0;   ///< and those whose search it spared
  std::int64_t patience_ = 1;
  std::vector<Point> kernel_;
  std::vector<std::int32_t> vertex_owner_;
  std::vector<std::int32_t> unplaced_;
  std::int64_t cones_visited_ = 0;
  std::size_t next_block_;
  // Points of the block whose cone is to be searched, and their order by cells of directions:
  struct Candidate {
    AnyVector unit;
    std::int64_t cell;
    std::int32_t place;  ///< in the block
  };
  std::vector<Candidate> candidates_;
  std::vector<std::int32_t> order_, cell_begin_;
  // Points of the block beyond the limit, in a list per facet:
  struct List {
    std::int32_t head = -1;
    std::int32_t farthest = -1;
    double gauge = 0;
  };
  std::vector<Point> waiting_;
  std::vector<std::int32_t> next_;
  std::vector<List> lists_;
  std::vector<Waiting> heap_;
};

}  // namespace pd::dimension::detail
