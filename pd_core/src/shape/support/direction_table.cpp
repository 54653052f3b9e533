#include "shape/support/direction_table.hpp"

#include <algorithm>
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

/// A body's vertices in the frame of its table.
struct Placed {
  const Storage& body;
  std::vector<double> x, y, z;
  double radius = 0;
};

/// Room of the search through the vertices of a cell.
struct CellSearch {
  std::int32_t* seen;  ///< by vertex: the last cell that has opened it
  std::int32_t* open;  ///< room for all vertices and one
  std::int32_t* list;  ///< room for all vertices: those found
};

/// The vertices that may be farthest somewhere in the cell `corners`, as they are met from `first` on, which is
/// farthest in one of its directions. @return how many
PD_CLONES std::int32_t list_vertices(const Placed& at, const Corners& corners, std::int32_t first, std::int32_t cell,
                                     const CellSearch& search) {
  const Storage& p = at.body;
  std::int32_t *const seen = search.seen, *const open = search.open, *const list = search.list;
  const double level = kLevel * at.radius;
  std::int32_t opened = 1, listed = 0;
  open[0] = first;
  seen[first] = cell;
  for (std::int32_t k = 0; k < opened; ++k) {
    const std::int32_t v = open[k];
    const double x = at.x[static_cast<std::size_t>(v)], y = at.y[static_cast<std::size_t>(v)],
                 z = at.z[static_cast<std::size_t>(v)];
    bool beaten = false;
    // Its neighbours are written behind the others, and stay where it is not beaten.
    std::int32_t next = opened;
    for (std::int32_t i = p.first_half_edge(v), end = p.first_half_edge(v + 1); i < end; ++i) {
      const std::int32_t w = p.target(i);
      const Rises rises = rises_of(at.x[static_cast<std::size_t>(w)] - x, at.y[static_cast<std::size_t>(w)] - y,
                                   at.z[static_cast<std::size_t>(w)] - z, corners, level);
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

/// The transpose of L with L L^T the moments, scaled; 1 where rounding leaves none. Bodies flatter than a thousandth of
/// their length are taken for that thick.
void take_frame(const Mat3& moments, double first, double second, float (&frame)[6]) {
  constexpr double kLeast = 0x1p-20;
  const Mat3 m = first * (first * moments * second) * second;
  const double least = kLeast * m.trace();
  const double l00 = std::sqrt(m(0, 0) + least), l10 = m(1, 0) / l00, l20 = m(2, 0) / l00;
  const double l11 = std::sqrt(m(1, 1) + least - l10 * l10), l21 = (m(2, 1) - l20 * l10) / l11;
  const double l22 = std::sqrt(m(2, 2) + least - l20 * l20 - l21 * l21);
  // Each root that is 0 or not a number leaves the last one no number.
  const bool good = l22 > 0 && std::isfinite(l22);
  const double rows[6] = {l00, l10, l20, l11, l21, l22}, none[6] = {1, 0, 0, 1, 0, 1};
  for (int i = 0; i < 6; ++i) frame[i] = static_cast<float>(good ? rows[i] : none[i]);
}

class TableBuilder {
 public:
  explicit TableBuilder(const Storage& polytope, float (&frame)[6])
      : p_(polytope),
        seen_(static_cast<std::size_t>(polytope.num_vertices), -1),
        open_(seen_.size() + 1),
        list_(seen_.size()),
        placed_{polytope, std::vector<double>(seen_.size()), std::vector<double>(seen_.size()),
                std::vector<double>(seen_.size())} {
    int exponent = 0;
    std::frexp(p_.radius, &exponent);
    // In two steps, neither of which is out of range.
    const double first = std::ldexp(1.0, -exponent / 2), second = std::ldexp(1.0, -exponent - -exponent / 2);
    take_frame(p_.second_moments, first, second, frame);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const Vec3 x = first * (Vec3(p_.x[i], p_.y[i], p_.z[i]) - p_.centre) * second;
      placed_.x[i] = x.x() / frame[0];
      placed_.y[i] = (x.y() - frame[1] * placed_.x[i]) / frame[3];
      placed_.z[i] = (x.z() - frame[2] * placed_.x[i] - frame[4] * placed_.y[i]) / frame[5];
      placed_.radius = std::max(placed_.radius, vertex(static_cast<std::int32_t>(i)).norm());
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
      listed_ = list_vertices(placed_, corners, first, cell, {seen_.data(), open_.data(), list_.data()});
      // Rounding must not leave a cell without any.
      if (listed_ == 0) list_[static_cast<std::size_t>(listed_++)] = first;
      std::sort(list_.begin(), list_.begin() + listed_);
      append(cell, table);
      if (table.blocks.size() > most_blocks(p_)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] Vec3 vertex(std::int32_t v) const {
    const auto i = static_cast<std::size_t>(v);
    return {placed_.x[i], placed_.y[i], placed_.z[i]};
  }

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
        block.x[i] = static_cast<float>(vertex(v).x());
        block.y[i] = static_cast<float>(vertex(v).y());
        block.z[i] = static_cast<float>(vertex(v).z());
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
  Placed placed_;
};

}  // namespace

DirectionTable direction_table(const Storage& polytope) {
  DirectionTable table;
  TableBuilder builder(polytope, table.frame);
  // About four vertices for every three cells.
  auto cells = static_cast<std::int32_t>(std::lround(std::sqrt(polytope.num_vertices / 8.0)));
  cells = std::clamp(cells, 1, kMostCells);
  while (!builder.build(cells, table) && cells > 1) cells = (cells + 1) / 2;
  return table;
}

int farthest_in_table(const Storage& p, float x, float y, float z) {
  into_frame(p.table_frame(), x, y, z);
  const std::int32_t cell = cell_of(x, y, z, p.table_cells);
  return farthest_of_blocks(p.table_blocks[cell], p.table_blocks + p.table_more[cell],
                            p.table_more[cell + 1] - p.table_more[cell], x, y, z);
}

}  // namespace pd::detail
