/// @file
/// The convex hull of finitely many points, exact: a vertex, edge or facet is there exactly when it is one of the hull
/// of the stored doubles.
///
/// Bodies of every affine dimension are bodies: a point (dimension 0), a segment (1), a polygon (2), a solid (3).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/index_list.hpp"

namespace pd {

/// One direction of an edge. Facets lie to the left when seen from outside; `twin` runs the other way.
struct HalfEdge {
  std::int32_t origin;  ///< vertex
  std::int32_t twin;    ///< half-edge
  std::int32_t next;    ///< half-edge, counter-clockwise round `facet`
  std::int32_t facet;   ///< -1 for the two half-edges of a segment

  bool operator==(const HalfEdge&) const = default;
};

/// Immutable and cheap to copy (shared storage), in a frame of its own.
///
/// Vertices are stored in canonical order (lexicographic by x, y, z), so that every result is independent of the
/// caller's order; `caller_id` leads back. Indices take as few bytes as the body needs (index_list.hpp). A polygon in
/// space is stored doubly covered: two facets with opposite normals. A segment has two vertices, one edge and no facet;
/// a point has one vertex.
class ConvexPolytope {
 public:
  struct Storage;
  /// Vertex coordinates are padded to a multiple of this (with copies of vertex 0) for vector kernels.
  static constexpr int kPadding = 8;

  /// Hull of the points; interior points, duplicates and points inside facets or edges are dropped.
  /// @param points  [n x 3], 1 <= n <= 3e8, finite, |coordinate| <= kMaxCoordinate.
  /// @return ErrorCode::too_few_points, limit_exceeded, non_finite ("vertices[i]") or out_of_range ("vertices[i]").
  /// Decisions by exact predicates. Quickhull: time O(n log n) where insertions split the rest evenly, O(n^2) at worst;
  /// measured by `bench_hull`.
  static Expected<ConvexPolytope> from_points(std::span<const Vec3> points);

  /// A closed convex surface, checked and not trusted: face f is a loop of indices into `points`, which stand in
  /// `face_vertices` from `face_offsets[f]` up to, and without, `face_offsets[f + 1]`; counter-clockwise from outside.
  /// Coplanar neighbours are merged, equal points count as one, and points that no face uses are no part of the body.
  /// The result is that of `from_points` for the points used. Time as there, and O(f log f) for f face corners.
  /// @return as `from_points`, and bad_faces (index, repeated vertex, fewer than 3, orientation), not_closed,
  /// not_convex, not_full_dimensional; `where` names the face ("faces[3]").
  static Expected<ConvexPolytope> from_faces(std::span<const Vec3> points, std::span<const std::int32_t> face_offsets,
                                             std::span<const std::int32_t> face_vertices);

  /// The box [-hx, hx] x [-hy, hy] x [-hz, hz]; caller ids are the bits of (x, y, z) > 0, x lowest.
  /// @return ErrorCode::non_finite, bad_value (not positive) or out_of_range, at "half_extents[i]".
  static Expected<ConvexPolytope> box(const Vec3& half_extents);

  [[nodiscard]] int affine_dimension() const { return data_->affine_dimension; }
  [[nodiscard]] int num_vertices() const { return data_->num_vertices; }
  [[nodiscard]] int num_edges() const { return data_->num_half_edges / 2; }
  [[nodiscard]] int num_half_edges() const { return data_->num_half_edges; }
  /// Facets with coplanar triangles merged; 2 for a polygon in space, 0 for a segment or a point.
  [[nodiscard]] int num_facets() const { return data_->num_facets; }

  [[nodiscard]] Vec3 vertex(int v) const { return {data_->x[v], data_->y[v], data_->z[v]}; }
  /// Coordinates as arrays of `padded_size()` doubles, 64-byte aligned.
  [[nodiscard]] const double* x() const { return data_->x; }
  [[nodiscard]] const double* y() const { return data_->y; }
  [[nodiscard]] const double* z() const { return data_->z; }
  [[nodiscard]] int padded_size() const { return data_->padded_size; }
  /// The caller's index of a vertex, the lowest of duplicates.
  [[nodiscard]] int caller_id(int v) const {
    return data_->caller_width.read(data_->caller_ids, static_cast<std::size_t>(v));
  }

  /// Vertices joined to v by an edge, counter-clockwise from outside for solids.
  [[nodiscard]] IndexList neighbours(int v) const {
    return {data_->neighbours, data_->first_half_edge(v), data_->first_half_edge(v + 1), data_->width};
  }
  /// The half-edge from v to `neighbours(v)[k]` has index `first_half_edge(v) + k`: half-edges are stored by origin.
  [[nodiscard]] int first_half_edge(int v) const { return data_->first_half_edge(v); }
  [[nodiscard]] HalfEdge half_edge(int h) const { return data_->half_edge(h); }
  [[nodiscard]] int target(int h) const { return data_->target(h); }

  /// Vertex loop of a facet, counter-clockwise from outside; no three are collinear, so the first three give the plane
  /// exactly.
  [[nodiscard]] IndexList facet_vertices(int f) const {
    return {data_->facet_vertices, data_->facet_offset(f), data_->facet_offset(f + 1), data_->width};
  }
  /// Outward unit normal, rounded (relative error a few ulp; not for decisions).
  [[nodiscard]] const Vec3& facet_normal(int f) const { return data_->facet_normals[f]; }
  /// A half-edge of facet f, the one that leaves `facet_vertices(f)[0]`.
  [[nodiscard]] int facet_half_edge(int f) const { return data_->index(data_->facet_half_edges, f); }

  /// Largest |coordinate|.
  [[nodiscard]] double max_abs_coordinate() const { return data_->max_abs_coordinate; }
  /// One value for each axis.
  [[nodiscard]] const Vec3& max_abs_coordinates() const { return data_->max_abs_coordinates; }
  /// Mean of the vertices, rounded: a point well inside, for choosing directions.
  [[nodiscard]] const Vec3& centre() const { return data_->centre; }
  /// Largest |vertex|, rounded up.
  [[nodiscard]] double radius() const { return data_->radius; }
  /// Bytes held by the shared storage.
  [[nodiscard]] std::size_t memory_bytes() const { return data_->memory_bytes; }
  /// For the support mapping.
  [[nodiscard]] const Storage& storage() const { return *data_; }
  /// Same storage (not: same point set).
  [[nodiscard]] bool same_storage(const ConvexPolytope& other) const { return data_ == other.data_; }

  /// Eight vertices in single precision.
  struct alignas(32) VertexBlock {
    static constexpr int kVertices = 8;
    float x[kVertices];
    float y[kVertices];
    float z[kVertices];
    std::int32_t id[kVertices];
  };

  /// Filled once by the hull builder (`src/shape/`).
  struct Storage {
    std::int32_t affine_dimension = 0;
    std::int32_t num_vertices = 0;
    std::int32_t num_half_edges = 0;
    std::int32_t num_facets = 0;
    std::int32_t padded_size = 0;
    double max_abs_coordinate = 0;
    Vec3 max_abs_coordinates = Vec3::Zero();
    double radius = 0;           ///< >= every |vertex|
    Vec3 centre = Vec3::Zero();  ///< mean of the vertices
    /// How the solid is spread about its centroid, per volume, and whether it is far from round
    /// (src/shape/hull/second_moments.hpp).
    Mat3 second_moments = Mat3::Zero();
    bool elongated = false;
    std::size_t memory_bytes = 0;
    const double* x = nullptr;
    const double* y = nullptr;
    const double* z = nullptr;
    const std::byte* caller_ids = nullptr;         ///< [num_vertices], of `caller_width`
    const std::byte* neighbour_offsets = nullptr;  ///< [num_vertices + 1], as all that follow of `width`
    const std::byte* neighbours = nullptr;         ///< [num_half_edges]: the half-edges' targets
    const std::byte* twins = nullptr;              ///< [num_half_edges]
    const std::byte* left_facets = nullptr;        ///< [num_half_edges]
    const std::byte* facet_offsets = nullptr;      ///< [num_facets + 1]
    const std::byte* facet_vertices = nullptr;
    const std::byte* facet_half_edges = nullptr;  ///< [num_facets]
    IndexWidth width;
    IndexWidth caller_width;
    const Vec3* facet_normals = nullptr;  ///< [num_facets]
    /// Where the search for a support begins (src/shape/support/direction_table.hpp): lists of vertices by cells of
    /// directions, divided by a power of two above `radius`. Empty for small bodies.
    const VertexBlock* table_blocks = nullptr;
    const std::int32_t* table_more = nullptr;  ///< [6 table_cells^2 + 1], in blocks
    std::int32_t table_cells = 0;

    /// An upper triangle, row by row, that takes a direction into the frame of the table. It stands in the block before
    /// the first one.
    [[nodiscard]] const float* table_frame() const { return table_blocks[-1].x; }
    [[nodiscard, gnu::always_inline]] std::int32_t index(const std::byte* list, std::int32_t i) const {
      return width.read(list, static_cast<std::size_t>(i));
    }
    [[nodiscard, gnu::always_inline]] std::int32_t first_half_edge(std::int32_t v) const {
      return index(neighbour_offsets, v);
    }
    [[nodiscard, gnu::always_inline]] std::int32_t target(std::int32_t h) const { return index(neighbours, h); }
    [[nodiscard, gnu::always_inline]] std::int32_t facet_offset(std::int32_t f) const {
      return index(facet_offsets, f);
    }
    [[nodiscard, gnu::always_inline]] std::int32_t first_corner(std::int32_t f) const {
      return index(facet_vertices, facet_offset(f));
    }
    /// The edge that follows h round its facet leaves h's target clockwise from h's twin.
    [[nodiscard, gnu::always_inline]] HalfEdge half_edge(std::int32_t h) const {
      const std::int32_t to = target(h), twin = index(twins, h), first = first_half_edge(to);
      return {target(twin), twin, (twin == first ? first_half_edge(to + 1) : twin) - 1, index(left_facets, h)};
    }
  };

  /// For the hull builder.
  explicit ConvexPolytope(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Storage> data_;
};

}  // namespace pd
