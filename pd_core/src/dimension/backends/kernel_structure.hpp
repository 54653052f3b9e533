/// @file
/// The kernel backend of directional width queries: vertices of a small polytope, its graph, and a table of directions.
///
/// Points: the vertices of the kernel's hull. Halfspaces: the vertices of the intersection of the few halfspaces that
/// an epsilon-kernel of the polar body keeps, drawn towards the centre until they lie in the body ([M] Lemma 16). A
/// query starts at the vertex that is extreme in the middle of its direction's cell, and climbs the graph.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "dimension/backends/width_structure.hpp"
#include "dimension/direction_cells.hpp"
#include "dimension/kernel_builder.hpp"

namespace pd::dimension::detail {

class KernelStructure : public WidthStructure {
 public:
  /// `epsilon` below `kLeastEpsilon` is taken as that.
  static std::shared_ptr<const KernelStructure> build(const AnyBody& body, double epsilon);
  /// The vertices of the hull that a builder has grown.
  static std::shared_ptr<const KernelStructure> of_kernel(const KernelBuilder& builder);

  [[nodiscard]] AnySupport support(const AnyVector& direction, QueryCounters& counters) const override;
  [[nodiscard]] StructureSize size() const override;

  struct Node {
    AnyVector unit;   ///< in the frame in which the body is fat; of points, where the hull has it
    AnyVector point;  ///< in the body's own
    std::int64_t index;
  };
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// A node that no neighbour is beyond, for a direction of the frame.
  std::int32_t extreme_node(const AnyVector& unit_direction, QueryCounters& counters) const {
    return climb(starts_[static_cast<std::size_t>(cells_.cell(unit_direction))], unit_direction, counters);
  }

 private:
  std::int32_t climb(std::int32_t start, const AnyVector& unit_direction, QueryCounters& counters) const;

  KernelStructure(const AnyMap& to_unit, std::vector<Node> nodes,
                  const std::vector<std::array<std::int32_t, 2>>& links);
  void store_links(const std::vector<std::array<std::int32_t, 2>>& links);

  AnyMap from_unit_;
  std::vector<Node> nodes_;
  std::vector<Node> loose_;  ///< kernel points that rounding keeps out of the hull: scanned
  std::vector<std::int32_t> first_link_;
  /// A neighbour with its place, so that a step reads one run of memory and not a node here and a node there.
  struct Link {
    AnyVector unit;
    std::int32_t node;
  };
  std::vector<Link> links_;
  DirectionCells cells_;
  std::vector<std::int32_t> starts_;
};

}  // namespace pd::dimension::detail
