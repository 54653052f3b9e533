#include "shape/hull/polytope_storage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <new>
#include <numeric>
#include <tuple>
#include <type_traits>

#include "numeric/length.hpp"
#include "shape/hull/second_moments.hpp"
#include "shape/small_gauss_map.hpp"
#include "shape/support/direction_table.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {
namespace {

using Storage = ConvexPolytope::Storage;

constexpr std::size_t kAlignment = 64;

/// Hands out consecutive aligned arrays; without memory it only measures.
class MemoryBlock {
 public:
  explicit MemoryBlock(std::byte* memory) : memory_(memory) {}

  template <class T>
  T* take(int count) {
    static_assert(std::is_trivially_destructible_v<T>);
    const std::size_t alignment = std::is_floating_point_v<T> ? kAlignment : alignof(T);
    used_ = (used_ + alignment - 1) / alignment * alignment;
    T* place = nullptr;
    if (memory_ != nullptr) {
      place = reinterpret_cast<T*>(memory_ + used_);
      std::uninitialized_default_construct_n(place, count);
    }
    used_ += sizeof(T) * static_cast<std::size_t>(count);
    return place;
  }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  std::byte* memory_;
  std::size_t used_ = 0;
};

/// A list of indices that is being written.
struct List {
  std::byte* bytes;
  IndexWidth width;

  void set(std::int32_t i, std::int32_t index) const { width.write(bytes, static_cast<std::size_t>(i), index); }
  [[nodiscard]] std::int32_t operator[](std::int32_t i) const { return width.read(bytes, static_cast<std::size_t>(i)); }
  void set_all(std::initializer_list<std::int32_t> indices) const {
    std::int32_t i = 0;
    for (const std::int32_t index : indices) set(i++, index);
  }
};

struct Arrays {
  Storage* storage;
  double* x;
  double* y;
  double* z;
  Vec3* facet_normals;
  List caller_ids;
  List neighbour_offsets;
  List neighbours;
  List twins;
  List left_facets;
  List facet_offsets;
  List facet_vertices;
  List facet_half_edges;
};

struct Counts {
  int vertices;
  int padded;
  int half_edges;
  int facet_vertices;
  int facets;
  bool has_gauss_map;
  IndexWidth width;
  IndexWidth caller_width;
};

int padded(int n) { return (n + ConvexPolytope::kPadding - 1) / ConvexPolytope::kPadding * ConvexPolytope::kPadding; }

Arrays take_arrays(MemoryBlock& block, const Counts& n) {
  Arrays a{};
  a.storage = n.has_gauss_map ? block.take<SmallBodyStorage>(1) : block.take<Storage>(1);
  a.x = block.take<double>(n.padded);
  a.y = block.take<double>(n.padded);
  a.z = block.take<double>(n.padded);
  a.facet_normals = block.take<Vec3>(n.facets);
  const auto list = [&](int count, IndexWidth width) {
    return List{block.take<std::byte>(count * static_cast<int>(width.bytes())), width};
  };
  a.caller_ids = list(n.vertices, n.caller_width);
  a.neighbour_offsets = list(n.vertices + 1, n.width);
  a.neighbours = list(n.half_edges, n.width);
  a.twins = list(n.half_edges, n.width);
  a.left_facets = list(n.half_edges, n.width);
  a.facet_offsets = list(n.facets + 1, n.width);
  a.facet_vertices = list(n.facet_vertices, n.width);
  a.facet_half_edges = list(n.facets, n.width);
  std::byte* const behind = block.take<std::byte>(static_cast<int>(IndexWidth::kReadableBehind));
  if (behind != nullptr) std::fill_n(behind, IndexWidth::kReadableBehind, std::byte{0});
  return a;
}

/// Half-edges in the order of the loops, before they are numbered by origin.
struct LoopEdges {
  std::vector<std::int32_t> origin;
  std::vector<std::int32_t> next;
  std::vector<std::int32_t> previous;
  std::vector<std::int32_t> twin;
  std::vector<std::int32_t> by_origin;  ///< edges of vertex v: by_origin[first[v]] .. by_origin[first[v + 1] - 1]
  std::vector<std::int32_t> first;

  [[nodiscard]] std::int32_t target(std::int32_t e) const {
    return origin[static_cast<std::size_t>(next[static_cast<std::size_t>(e)])];
  }
};

/// @param rank  canonical number of each vertex position.
LoopEdges connect(const FacetLoops& loops, const std::vector<std::int32_t>& rank) {
  const std::size_t n = loops.vertices.size();
  LoopEdges e;
  e.origin.resize(n);
  e.next.resize(n);
  e.previous.resize(n);
  e.twin.assign(n, -1);
  e.by_origin.resize(n);
  e.first.assign(rank.size() + 1, 0);
  for (int f = 0; f < loops.size(); ++f) {
    const std::int32_t begin = loops.offsets[static_cast<std::size_t>(f)];
    const std::int32_t end = loops.offsets[static_cast<std::size_t>(f) + 1];
    for (std::int32_t i = begin; i < end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      e.origin[k] = rank[static_cast<std::size_t>(loops.vertices[k])];
      e.next[k] = i + 1 < end ? i + 1 : begin;
      e.previous[k] = i > begin ? i - 1 : end - 1;
      ++e.first[static_cast<std::size_t>(e.origin[k]) + 1];
    }
  }
  std::partial_sum(e.first.begin(), e.first.end(), e.first.begin());
  std::vector<std::int32_t> place(e.first.begin(), e.first.end() - 1);
  for (std::size_t k = 0; k < n; ++k) {
    e.by_origin[static_cast<std::size_t>(place[static_cast<std::size_t>(e.origin[k])]++)] =
        static_cast<std::int32_t>(k);
  }
  // The twin is searched from the end of lower degree: the sum of min(degree, degree) over the edges of a planar graph
  // is O(n) (Chiba, Nishizeki, "Arboricity and subgraph listing algorithms", 1985).
  const auto degree = [&](std::int32_t v) {
    return e.first[static_cast<std::size_t>(v) + 1] - e.first[static_cast<std::size_t>(v)];
  };
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t from = e.origin[k];
    const std::int32_t to = e.target(static_cast<std::int32_t>(k));
    if (e.twin[k] >= 0 || degree(to) > degree(from)) continue;
    std::int32_t i = e.first[static_cast<std::size_t>(to)];
    while (e.target(e.by_origin[static_cast<std::size_t>(i)]) != from) ++i;
    e.twin[k] = e.by_origin[static_cast<std::size_t>(i)];
    e.twin[static_cast<std::size_t>(e.twin[k])] = static_cast<std::int32_t>(k);
  }
  return e;
}

/// Numbers the half-edges by origin, counter-clockwise from the lowest neighbour, and the facets by first half-edge.
void write_surface(const LoopEdges& e, const Arrays& out, const Counts& n) {
  std::vector<std::int32_t> number(e.origin.size());
  std::vector<std::int32_t> ordered(e.origin.size());
  std::int32_t h = 0;
  for (int v = 0; v < n.vertices; ++v) {
    out.neighbour_offsets.set(v, h);
    std::int32_t lowest = e.by_origin[static_cast<std::size_t>(e.first[static_cast<std::size_t>(v)])];
    for (std::int32_t i = e.first[static_cast<std::size_t>(v)]; i < e.first[static_cast<std::size_t>(v) + 1]; ++i) {
      const std::int32_t candidate = e.by_origin[static_cast<std::size_t>(i)];
      if (e.target(candidate) < e.target(lowest)) lowest = candidate;
    }
    std::int32_t k = lowest;
    do {  // the facet lies to the left of k, and beyond it the reverse of the edge that enters v
      out.neighbours.set(h, e.target(k));
      ordered[static_cast<std::size_t>(h)] = k;
      number[static_cast<std::size_t>(k)] = h++;
      k = e.twin[static_cast<std::size_t>(e.previous[static_cast<std::size_t>(k)])];
    } while (k != lowest);
  }
  out.neighbour_offsets.set(n.vertices, h);

  std::vector<bool> has_facet(e.origin.size(), false);
  std::int32_t facet = 0;
  std::int32_t filled = 0;
  for (std::int32_t i = 0; i < n.half_edges; ++i) {
    const auto k = static_cast<std::size_t>(ordered[static_cast<std::size_t>(i)]);
    out.twins.set(i, number[static_cast<std::size_t>(e.twin[k])]);
    if (has_facet[k]) continue;
    out.facet_offsets.set(facet, filled);
    out.facet_half_edges.set(facet, i);
    std::size_t walk = k;
    do {
      has_facet[walk] = true;
      out.left_facets.set(number[walk], facet);
      out.facet_vertices.set(filled++, e.origin[walk]);
      walk = static_cast<std::size_t>(e.next[walk]);
    } while (walk != k);
    ++facet;
  }
  out.facet_offsets.set(facet, filled);
}

/// What `write_surface` writes of a doubly covered triangle, whichever way round it was given.
void write_triangle(const Arrays& out) {
  out.neighbour_offsets.set_all({0, 2, 4, 6});
  out.neighbours.set_all({1, 2, 0, 2, 0, 1});
  out.twins.set_all({2, 4, 0, 5, 1, 3});
  out.left_facets.set_all({0, 1, 1, 0, 0, 1});
  out.facet_offsets.set_all({0, 3, 6});
  out.facet_vertices.set_all({0, 1, 2, 0, 2, 1});
  out.facet_half_edges.set_all({0, 1});
}

/// Copies all but coordinates, normals and caller ids from a body of the same faces and the same widths of indices. The
/// lists from `neighbour_offsets` to `facet_half_edges` lie one after the other (`take_arrays`).
void copy_surface(const Storage& body, const Counts& n, const Arrays& out) {
  const std::byte* const end = body.facet_half_edges + n.facets * static_cast<int>(n.width.bytes());
  std::copy(body.neighbour_offsets, end, out.neighbour_offsets.bytes);
}

IndexWidth width_of_callers(std::span<const HullVertex> vertices) {
  std::int32_t most = 0;
  for (const HullVertex& v : vertices) most = std::max(most, v.caller_id);
  return IndexWidth::up_to(most);
}

/// Requires all counts but the width itself.
IndexWidth width_of_indices(const Counts& n) {
  // A segment's half-edges have facet -1.
  return n.facets == 0 ? IndexWidth() : IndexWidth::up_to(std::max(n.half_edges, n.vertices));
}

Counts counts_of(const Storage& body) {
  return {body.num_vertices,   body.padded_size,
          body.num_half_edges, body.facet_offset(body.num_facets),
          body.num_facets,     has_small_gauss_map(body.affine_dimension, body.num_vertices),
          body.width,          body.caller_width};
}

/// Adds a table of directions, in memory of its own: its size shows only when it is made.
void add_table(std::span<const ConvexPolytope::VertexBlock> blocks, std::span<const std::int32_t> more, int cells,
               const float* frame, Storage& s) {
  const std::size_t bytes = sizeof(ConvexPolytope::VertexBlock) + blocks.size_bytes() + more.size_bytes();
  auto* const memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{kAlignment}));
  auto* const first = new (memory) ConvexPolytope::VertexBlock{};
  std::copy_n(frame, 6, first->x);
  std::byte* const lists = memory + sizeof(ConvexPolytope::VertexBlock) + blocks.size_bytes();
  std::memcpy(memory + sizeof(ConvexPolytope::VertexBlock), blocks.data(), blocks.size_bytes());
  std::memcpy(lists, more.data(), more.size_bytes());
  s.table_blocks = first + 1;
  s.table_more = reinterpret_cast<const std::int32_t*>(lists);
  s.table_cells = cells;
  s.memory_bytes += bytes;
}

void release(const Storage* storage) {
  if (storage->table_blocks != nullptr) {
    ::operator delete (const_cast<ConvexPolytope::VertexBlock*>(storage->table_blocks - 1),
                       std::align_val_t{kAlignment});
  }
  ::operator delete (const_cast<Storage*>(storage), std::align_val_t{kAlignment});
}

struct Allocated {
  Arrays arrays;
  std::shared_ptr<const Storage> shared;
  std::size_t bytes;
};

Allocated allocate(const Counts& n) {
  MemoryBlock measure(nullptr);
  take_arrays(measure, n);
  auto* memory = static_cast<std::byte*>(::operator new (measure.used(), std::align_val_t{kAlignment}));
  MemoryBlock block(memory);
  const Arrays arrays = take_arrays(block, n);
  return {arrays, {arrays.storage, release}, block.used()};
}

/// After the vertices and the largest coordinate of each axis.
void pad(const Arrays& out, const Counts& n) {
  out.storage->max_abs_coordinate = out.storage->max_abs_coordinates.maxCoeff();
  std::fill(out.x + n.vertices, out.x + n.padded, out.x[0]);
  std::fill(out.y + n.vertices, out.y + n.padded, out.y[0]);
  std::fill(out.z + n.vertices, out.z + n.padded, out.z[0]);
}

/// The vertices in the order of their coordinates, padded with the first. @return each one's place in that order
std::vector<std::int32_t> place_vertices(std::span<const HullVertex> vertices, const Arrays& out, const Counts& n) {
  std::vector<std::int32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    const HullVertex& p = vertices[static_cast<std::size_t>(i)];
    const HullVertex& q = vertices[static_cast<std::size_t>(j)];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  });
  std::vector<std::int32_t> rank(vertices.size());
  for (int i = 0; i < n.vertices; ++i) {
    const std::int32_t position = order[static_cast<std::size_t>(i)];
    const HullVertex& p = vertices[static_cast<std::size_t>(position)];
    rank[static_cast<std::size_t>(position)] = i;
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.z[i] = p.z;
    out.caller_ids.set(i, p.caller_id);
    out.storage->max_abs_coordinates = out.storage->max_abs_coordinates.cwiseMax(Vec3(p.x, p.y, p.z).cwiseAbs());
  }
  pad(out, n);
  return rank;
}

/// Facets, edges and neighbours of a body of this dimension.
void place_facets(const FacetLoops& loops, const std::vector<std::int32_t>& rank, int affine_dimension,
                  const Arrays& out, const Counts& n) {
  if (affine_dimension >= 2) {
    if (n.vertices == 3) {
      write_triangle(out);
    } else {
      write_surface(connect(loops, rank), out, n);
    }
    for (int f = 0; f < n.facets; ++f) {
      const std::int32_t first = out.facet_offsets[f];
      const auto corner = [&](int i) {
        const std::int32_t v = out.facet_vertices[first + i];
        return Vec3(out.x[v], out.y[v], out.z[v]);
      };
      out.facet_normals[f] = plane_normal(corner(0), corner(1), corner(2));
    }
  } else {
    out.facet_offsets.set_all({0});
    out.neighbour_offsets.set_all({0, affine_dimension});
    if (affine_dimension == 1) {
      out.neighbour_offsets.set(2, 2);
      out.neighbours.set_all({1, 0});
      out.twins.set_all({1, 0});
      out.left_facets.set_all({-1, -1});
    }
  }
}

/// What readers of the storage see.
void publish(const Arrays& out, const Counts& n, int affine_dimension) {
  Storage& s = *out.storage;
  s.affine_dimension = affine_dimension;
  s.num_vertices = n.vertices;
  s.num_half_edges = n.half_edges;
  s.num_facets = n.facets;
  s.padded_size = n.padded;
  for (int v = 0; v < n.vertices; ++v) {
    const Vec3 point(out.x[v], out.y[v], out.z[v]);
    s.centre += point / n.vertices;  // divided first: a sum could overflow
    s.radius = std::max(s.radius, length(point) * (1 + 0x1p-48));
  }
  s.x = out.x;
  s.y = out.y;
  s.z = out.z;
  s.caller_ids = out.caller_ids.bytes;
  s.neighbour_offsets = out.neighbour_offsets.bytes;
  s.neighbours = out.neighbours.bytes;
  s.twins = out.twins.bytes;
  s.left_facets = out.left_facets.bytes;
  s.facet_offsets = out.facet_offsets.bytes;
  s.facet_vertices = out.facet_vertices.bytes;
  s.facet_half_edges = out.facet_half_edges.bytes;
  s.facet_normals = out.facet_normals;
  s.width = n.width;
  s.caller_width = n.caller_width;
}

/// The rest, of a body whose vertices and facets are written, but for a table of directions.
void complete(const Allocated& made, const Counts& n, int affine_dimension) {
  publish(made.arrays, n, affine_dimension);
  Storage& s = *made.arrays.storage;
  s.second_moments = second_moments(s);
  s.elongated = is_elongated(s.second_moments);
  s.memory_bytes = made.bytes;
  if (n.has_gauss_map) fill_small_gauss_map(s, static_cast<SmallBodyStorage&>(s).gauss_map);
}

/// The loops of a box, whose corner i is on the upper side of axis k where bit k of i is set.
FacetLoops sides_of_box() {
  FacetLoops loops;
  loops.vertices = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
  loops.offsets = {0, 4, 8, 12, 16, 20, 24};
  return loops;
}

}  // namespace

std::shared_ptr<const Storage> lay_out(std::span<const HullVertex> vertices, const FacetLoops& loops,
                                       int affine_dimension) {
  Counts n{};
  n.vertices = static_cast<int>(vertices.size());
  n.padded = padded(n.vertices);
  n.facet_vertices = static_cast<int>(loops.vertices.size());
  n.half_edges = affine_dimension == 1 ? 2 : n.facet_vertices;
  n.facets = loops.size();
  n.has_gauss_map = has_small_gauss_map(affine_dimension, n.vertices);
  n.width = width_of_indices(n);
  n.caller_width = width_of_callers(vertices);

  const Allocated made = allocate(n);
  const Arrays& out = made.arrays;
  place_facets(loops, place_vertices(vertices, out, n), affine_dimension, out, n);
  complete(made, n, affine_dimension);
  if (n.vertices > kScanLimit) {
    const DirectionTable table = direction_table(*out.storage);
    add_table(table.blocks, table.more, table.cells, table.frame, *out.storage);
  }
  return made.shared;
}

std::shared_ptr<const Storage> scaled_exactly(const Storage& body, int exponent) {
  const Counts n = counts_of(body);
  const Allocated made = allocate(n);
  const Arrays& out = made.arrays;
  const auto scale = [&](const double* from, double* to) {
    for (int i = 0; i < n.padded; ++i) {
      to[i] = std::ldexp(from[i], exponent);
      if (std::ldexp(to[i], -exponent) != from[i]) return false;
    }
    return true;
  };
  if (!scale(body.x, out.x) || !scale(body.y, out.y) || !scale(body.z, out.z)) return nullptr;
  out.storage->max_abs_coordinates =
      body.max_abs_coordinates.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
  out.storage->max_abs_coordinate = std::ldexp(body.max_abs_coordinate, exponent);
  std::copy_n(body.facet_normals, n.facets, out.facet_normals);
  std::copy_n(body.caller_ids, static_cast<std::size_t>(n.vertices) * n.caller_width.bytes(), out.caller_ids.bytes);
  copy_surface(body, n, out);
  publish(out, n, body.affine_dimension);
  const double spread = body.second_moments.trace();
  if (spread > 0 && std::isfinite(spread)) {
    out.storage->second_moments = body.second_moments.unaryExpr([&](double x) { return std::ldexp(x, 2 * exponent); });
    out.storage->elongated = body.elongated;
  } else {  // no squares of lengths at the body's size
    out.storage->second_moments = second_moments(*out.storage);
    out.storage->elongated = is_elongated(out.storage->second_moments);
  }
  out.storage->memory_bytes = made.bytes;
  if (n.has_gauss_map) fill_small_gauss_map(*out.storage, static_cast<SmallBodyStorage*>(out.storage)->gauss_map);
  if (body.table_cells > 0) {
    // Its points are divided by the size of the body.
    const int lists = 6 * body.table_cells * body.table_cells;
    add_table({body.table_blocks, static_cast<std::size_t>(body.table_more[lists])},
              {body.table_more, static_cast<std::size_t>(lists) + 1}, body.table_cells, body.table_frame(),
              *out.storage);
  }
  return made.shared;
}

std::shared_ptr<const Storage> lay_out_box(std::span<const HullVertex, 8> corners) {
  // Every box has the faces and normals of this one.
  static const std::shared_ptr<const Storage> cube = [] {
    HullVertex vertices[8];
    for (std::int32_t i = 0; i < 8; ++i) {
      const auto side = [&](int axis) { return (i >> axis & 1) != 0 ? 1.0 : -1.0; };
      vertices[i] = {side(0), side(1), side(2), i};
    }
    return lay_out(vertices, sides_of_box(), 3);
  }();
  Counts n = counts_of(*cube);
  n.caller_width = width_of_callers(corners);
  const Allocated made = allocate(n);
  const Arrays& out = made.arrays;
  const IndexList corner_of_cube(cube->caller_ids, 0, 8, cube->caller_width);
  for (std::size_t v = 0; v < 8; ++v) {
    // In the order of coordinates x changes last.
    const HullVertex& corner = corners[static_cast<std::size_t>(corner_of_cube[v])];
    out.x[v] = corner.x;
    out.y[v] = corner.y;
    out.z[v] = corner.z;
    out.caller_ids.set(static_cast<std::int32_t>(v), corner.caller_id);
  }
  const HullVertex &low = corners[0], &high = corners[7];
  out.storage->max_abs_coordinates =
      Vec3(low.x, low.y, low.z).cwiseAbs().cwiseMax(Vec3(high.x, high.y, high.z).cwiseAbs());
  pad(out, n);
  std::copy_n(cube->facet_normals, n.facets, out.facet_normals);
  copy_surface(*cube, n, out);
  complete(made, n, 3);
  return made.shared;
}

}  // namespace pd::detail
