/// @file
/// How far points may lie in each cell of directions without a look at the cones there: for kernels over many points,
/// most of which lie well inside the hull that the first ones have built.
///
/// In the cone over a facet with plane <n, x> = 1 the gauge of p is <n, p>. Over all facets whose cones meet a cell it
/// is at most max |n| |p|, tight on curved bodies; and with p = s q, q on the face of the cube where the cell is a box
/// about m of half-width h, at most s max (<n, m> + h sum |n_k|), tight on flat ones. Either bound below the limit
/// proves what the search for p's cone would. A surface only grows, so bounds stay valid while it does.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "dimension/direction_cells.hpp"
#include "dimension/radial_hull.hpp"

namespace pd::dimension::detail {

class CellReach {
 public:
  explicit CellReach(const DirectionCells& cells) : cells_(cells) {}

  /// Whether a point that falls into this place has a gauge of at most the limit. False before the first survey.
  [[nodiscard]] bool holds(const DirectionCells::Place& place, const AnyVector& p) const {
    if (reaches_.empty()) return false;
    const Reach& reach = reaches_[static_cast<std::size_t>(place.cell)];
    return p.squaredNorm() <= reach.radius_squared || std::abs(p[place.axis]) <= reach.height;
  }

  /// Bounds for the surface as it is. `hints` holds a facet near each cell. Time: cells and the facets that meet each.
  void survey(const RadialHull& hull, double limit, std::vector<std::int32_t>& hints, std::int64_t& cones_visited) {
    reaches_.resize(static_cast<std::size_t>(cells_.size()));
    seen_.assign(hull.facets().size(), -1);
    for (std::int64_t c = 0; c < cells_.size(); ++c) {
      const auto slot = static_cast<std::size_t>(c);
      const AnyVector middle = cells_.middle(c);
      hints[slot] = hull.locate(middle, hints[slot], cones_visited);
      reaches_[slot] = reach_of(hull, c, middle, hints[slot], limit * (1 - kRoom));
    }
  }

 private:
  struct Reach {
    double radius_squared;  ///< bounds |p|^2
    double height;          ///< bounds the coordinate along the cell's axis
  };
  static constexpr double kRoom = 1e-9;  ///< for the roundings of both bounds

  /// Floods the facets whose cones can meet the cell, from the one that holds its middle.
  Reach reach_of(const RadialHull& hull, std::int64_t cell, const AnyVector& middle, std::int32_t start, double limit) {
    AnyVector sides = AnyVector::Constant(middle.size(), cells_.half_width());
    sides[cells_.axis(cell)] = 0;
    double longest = 0, highest = 0;
    const auto stamp = static_cast<std::int32_t>(cell);
    flood_.assign(1, start);
    seen_[static_cast<std::size_t>(start)] = stamp;
    while (!flood_.empty()) {
      const std::int32_t f = flood_.back();
      flood_.pop_back();
      const auto normal = hull.normal(f);
      longest = std::max(longest, normal.squaredNorm());
      highest = std::max(highest, normal.dot(middle) + normal.cwiseAbs().dot(sides));
      for (const std::int32_t next : hull.neighbours_of(f)) {
        if (seen_[static_cast<std::size_t>(next)] == stamp || !meets(hull, next, middle, sides)) continue;
        seen_[static_cast<std::size_t>(next)] = stamp;
        flood_.push_back(next);
      }
    }
    return {limit * limit / longest, limit / highest};
  }

  /// Whether the cone over facet f may meet the cell; never false where it does.
  static bool meets(const RadialHull& hull, std::int32_t f, const AnyVector& middle, const AnyVector& sides) {
    // The largest lambda over the cell; below zero, the cell lies beyond that ridge altogether.
    const AnyVector most = hull.inverse(f) * middle + hull.inverse(f).cwiseAbs() * sides;
    return most.minCoeff() >= -kRoom;
  }

  DirectionCells cells_;
  std::vector<Reach> reaches_;
  std::vector<std::int32_t> seen_;  ///< per facet: the last cell whose flood came by
  std::vector<std::int32_t> flood_;
};

}  // namespace pd::dimension::detail
