#include "shape/support/direction_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

namespace {

using Storage = ConvexPolytope::Storage;
using VertexBlock = ConvexPolytope::VertexBlock;

constexpr int kBlock = VertexBlock::kVertices;
/// More squares than this along an edge of the cube would only cost memory.
constexpr std::int32_t kMostCells = 64;

/// 192 bytes a vertex at most, as much as the rest of a hull takes; round bodies need 110.
std::size_t most_blocks(const Storage& p) { return 64 + static_cast<std::size_t>(p.num_vertices) * 3 / 2; }

class TableBuilder {
 public:
  explicit TableBuilder(const Storage& polytope)
      : p_(polytope), seen_(static_cast<std::size_t>(polytope.num_vertices), -1) {
    std::frexp(p_.radius, &exponent_);
  }

  /// False when the lists take too much memory.
  bool build(std::int32_t cells, DirectionTable& table) {
    const std::int32_t count = 6 * cells * cells;
    table.cells = cells;
    table.more.assign(1, count);
    table.blocks.resize(static_cast<std::size_t>(count));
    std::fill(seen_.begin(), seen_.end(), -1);
    std::int32_t first = 0;
    for (std::int32_t cell = 0; cell < count; ++cell) {
      const std::int32_t side = cell / (cells * cells);
      const std::int32_t row = cell / cells % cells;
      const std::int32_t column = cell % cells;
      first = climb(direction(side, (row + 0.5) / cells, (column + 0.5) / cells), first);
      const double u[2] = {static_cast<double>(row) / cells, (row + 1.0) / cells};
      const double v[2] = {static_cast<double>(column) / cells, (column + 1.0) / cells};
      const Vec3 corners[4] = {direction(side, u[0], v[0]), direction(side, u[0], v[1]), direction(side, u[1], v[0]),
                               direction(side, u[1], v[1])};
      list_vertices(corners, first, cell);
      append(cell, table);
      if (table.blocks.size() > most_blocks(p_)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] Vec3 vertex(std::int32_t v) const { return {p_.x[v], p_.y[v], p_.z[v]}; }
  [[nodiscard]] float scaled(double value) const { return static_cast<float>(std::ldexp(value, -exponent_)); }

  /// @param u, v  in [0, 1].
  static Vec3 direction(std::int32_t side, double u, double v) {
    Vec3 d;
    const int axis = side / 2;
    d[axis] = side % 2 == 0 ? 1 : -1;
    d[(axis + 1) % 3] = 2 * u - 1;
    d[(axis + 2) % 3] = 2 * v - 1;
    return d;
  }

  [[nodiscard]] std::int32_t climb(const Vec3& d, std::int32_t v) const {
    double value = vertex(v).dot(d);
    for (;;) {
      const std::int32_t from = v;
      for (std::int32_t i = p_.neighbour_offsets[from]; i < p_.neighbour_offsets[from + 1]; ++i) {
        const double other = vertex(p_.neighbours[i]).dot(d);
        if (other <= value) continue;
        value = other;
        v = p_.neighbours[i];
      }
      if (v == from) return v;
    }
  }

  void list_vertices(const Vec3 (&corners)[4], std::int32_t first, std::int32_t cell) {
    list_.clear();
    open_.assign(1, first);
    seen_[static_cast<std::size_t>(first)] = cell;
    for (std::size_t k = 0; k < open_.size(); ++k) {
      const std::int32_t v = open_[k];
      const Vec3 from = vertex(v);
      bool beaten = false;
      for (std::int32_t i = p_.neighbour_offsets[v]; i < p_.neighbour_offsets[v + 1]; ++i) {
        const std::int32_t w = p_.neighbours[i];
        const Vec3 edge = vertex(w) - from;
        const double rises[4] = {edge.dot(corners[0]), edge.dot(corners[1]), edge.dot(corners[2]),
                                 edge.dot(corners[3])};
        beaten |= (rises[0] > 0) & (rises[1] > 0) & (rises[2] > 0) & (rises[3] > 0);
        const bool reaches = (rises[0] >= 0) | (rises[1] >= 0) | (rises[2] >= 0) | (rises[3] >= 0);
        if (!reaches || seen_[static_cast<std::size_t>(w)] == cell) continue;
        seen_[static_cast<std::size_t>(w)] = cell;
        open_.push_back(w);
      }
      if (!beaten) list_.push_back(v);
    }
    // Rounding must not leave a cell without any.
    if (list_.empty()) list_.push_back(first);
    std::sort(list_.begin(), list_.end());
  }

  void append(std::int32_t cell, DirectionTable& table) const {
    for (std::size_t k = 0; k < list_.size(); k += kBlock) {
      VertexBlock block;
      for (std::size_t i = 0; i < kBlock; ++i) {
        const std::int32_t v = k + i < list_.size() ? list_[k + i] : list_[0];
        block.x[i] = scaled(p_.x[v]);
        block.y[i] = scaled(p_.y[v]);
        block.z[i] = scaled(p_.z[v]);
        block.id[i] = v;
      }
      if (k == 0) {
        table.blocks[static_cast<std::size_t>(cell)] = block;
      } else {
        table.blocks.push_back(block);
      }
    }
    table.more.push_back(static_cast<std::int32_t>(table.blocks.size()));
  }

  const Storage& p_;
  int exponent_ = 0;
  std::vector<std::int32_t> seen_;  ///< the cell in which a vertex was visited last
  std::vector<std::int32_t> open_;
  std::vector<std::int32_t> list_;
};

}  // namespace

DirectionTable direction_table(const Storage& polytope) {
  TableBuilder builder(polytope);
  DirectionTable table;
  // About four vertices for every three cells.
  auto cells = static_cast<std::int32_t>(std::lround(std::sqrt(polytope.num_vertices / 8.0)));
  cells = std::clamp(cells, 1, kMostCells);
  while (!builder.build(cells, table) && cells > 1) cells = (cells + 1) / 2;
  return table;
}

int farthest_in_table(const Storage& p, float x, float y, float z) {
  const std::int32_t cell = cell_of(x, y, z, p.table_cells);
  return farthest_of_blocks(p.table_blocks[cell], p.table_blocks + p.table_more[cell],
                            p.table_more[cell + 1] - p.table_more[cell], x, y, z);
}

}  // namespace pd::detail
