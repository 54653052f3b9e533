#include "shape/support/direction_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "numeric/instruction_sets.hpp"
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

typedef double Lanes __attribute__((vector_size(32)));

/// The corners of a cell, coordinate by coordinate.
struct Corners {
  Lanes x, y, z;
};

struct Rises {
  bool everywhere;  ///< by more than rounding in all four corners
  bool somewhere;   ///< not less than 0 in one of them
};

/// A rise of less than this, in units of the radius, may be rounding.
constexpr double kLevel = 0x1p-40;

/// How an edge rises in the directions of the corners.
PD_INLINE Rises rises_of(double x, double y, double z, const Corners& corners, double level_rise) {
  const Lanes rise = x * corners.x + (y * corners.y + z * corners.z);
  // The lanes' masks folded in halves: without extracting each of them.
  const auto up = rise > level_rise, level = rise >= 0.0;
  const auto up2 = up & __builtin_shufflevector(up, up, 2, 3, 0, 1);
  const auto level2 = level | __builtin_shufflevector(level, level, 2, 3, 0, 1);
  return {(up2[0] & up2[1]) != 0, (level2[0] | level2[1]) != 0};
}

/// The vertices that may be farthest somewhere in the cell `corners`, as they are met from `first` on, which is
/// farthest in one of its directions. `open` and `list` have room for all vertices and one. @return how many
PD_CLONES std::int32_t list_vertices(const Storage& p, const Corners& corners, std::int32_t first, std::int32_t cell,
                                     std::int32_t* seen, std::int32_t* open, std::int32_t* list) {
  const double level = kLevel * p.radius;
  std::int32_t opened = 1, listed = 0;
  open[0] = first;
  seen[first] = cell;
  for (std::int32_t k = 0; k < opened; ++k) {
    const std::int32_t v = open[k];
    const double x = p.x[v], y = p.y[v], z = p.z[v];
    bool beaten = false;
    // Its neighbours are written behind the others, and stay where it is not beaten.
    std::int32_t next = opened;
    for (std::int32_t i = p.first_half_edge(v), end = p.first_half_edge(v + 1); i < end; ++i) {
      const std::int32_t w = p.target(i);
      const Rises rises = rises_of(p.x[w] - x, p.y[w] - y, p.z[w] - z, corners, level);
      beaten = rises.everywhere;
      if (beaten) break;
      open[next] = w;
      next += static_cast<std::int32_t>(rises.somewhere && seen[w] != cell);
    }
    if (beaten) continue;
    list[listed++] = v;
    for (; opened < next; ++opened) seen[open[opened]] = cell;
  }
  return listed;
}

class TableBuilder {
 public:
  explicit TableBuilder(const Storage& polytope)
      : p_(polytope),
        seen_(static_cast<std::size_t>(polytope.num_vertices), -1),
        open_(seen_.size() + 1),
        list_(seen_.size()),
        scaled_(seen_.size()) {
    int exponent = 0;
    std::frexp(p_.radius, &exponent);
    // In two steps, neither of which is out of range.
    const double first = std::ldexp(1.0, -exponent / 2), second = std::ldexp(1.0, -exponent - -exponent / 2);
    const auto scaled = [&](double value) { return static_cast<float>(value * first * second); };
    for (int v = 0; v < p_.num_vertices; ++v) {
      scaled_[static_cast<std::size_t>(v)] = {scaled(p_.x[v]), scaled(p_.y[v]), scaled(p_.z[v])};
    }
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
      Corners corners;
      for (int k = 0; k < 4; ++k) {
        const Vec3 corner = direction(side, u[k / 2], v[k % 2]);
        corners.x[k] = corner.x();
        corners.y[k] = corner.y();
        corners.z[k] = corner.z();
      }
      listed_ = list_vertices(p_, corners, first, cell, seen_.data(), open_.data(), list_.data());
      // Rounding must not leave a cell without any.
      if (listed_ == 0) list_[static_cast<std::size_t>(listed_++)] = first;
      std::sort(list_.begin(), list_.begin() + listed_);
      append(cell, table);
      if (table.blocks.size() > most_blocks(p_)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] Vec3 vertex(std::int32_t v) const { return {p_.x[v], p_.y[v], p_.z[v]}; }

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
      for (std::int32_t i = p_.first_half_edge(from), end = p_.first_half_edge(from + 1); i < end; ++i) {
        const double other = vertex(p_.target(i)).dot(d);
        if (other <= value) continue;
        value = other;
        v = p_.target(i);
      }
      if (v == from) return v;
    }
  }

  void append(std::int32_t cell, DirectionTable& table) const {
    const auto listed = static_cast<std::size_t>(listed_);
    for (std::size_t k = 0; k < listed; k += kBlock) {
      VertexBlock block;
      for (std::size_t i = 0; i < kBlock; ++i) {
        const std::int32_t v = k + i < listed ? list_[k + i] : list_[0];
        const std::array<float, 3>& point = scaled_[static_cast<std::size_t>(v)];
        block.x[i] = point[0];
        block.y[i] = point[1];
        block.z[i] = point[2];
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
  std::vector<std::int32_t> seen_;  ///< the cell in which a vertex was visited last
  std::vector<std::int32_t> open_;
  std::vector<std::int32_t> list_;
  std::int32_t listed_ = 0;  ///< of list_
  std::vector<std::array<float, 3>> scaled_;
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
