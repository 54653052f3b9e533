/// @file
/// The twin hierarchies of [D] section 5.1: the inner hierarchy P_0 = P, P_1, ... of a polytope, and for every P_i an
/// outer hierarchy of its own, with pointers between them both ways. Vertices of all levels sum to O(n) ([D] Fact 5.1),
/// and so do the outer hierarchies.
///
/// Queries of any level in O(log n): a plane by `inner().support(direction, count, level)` (Lemma 5.4), a line by
/// `crossing_of_level(twin, level, point, direction)` (Lemma 5.2; `depth/level_queries.hpp`), a translating segment or
/// any small body by `crossing_of_level(twin.inner(), ...)` (Lemma 5.3, Corollary 5.5).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd {

/// Immutable, cheap to copy. Moving copies, so that every hierarchy holds its levels.
class TwinHierarchy {
 public:
  TwinHierarchy(const TwinHierarchy&) = default;
  TwinHierarchy& operator=(const TwinHierarchy&) = default;
  ~TwinHierarchy() = default;

  /// @return ErrorCode::not_full_dimensional for flat bodies.
  /// Decisions by exact signs. Space O(n), time that of the hulls of all levels, whose sizes sum to O(n).
  static Expected<TwinHierarchy> build(const ConvexPolytope& polytope);

  [[nodiscard]] const PolyhedralHierarchy& inner() const;
  [[nodiscard]] int num_levels() const;
  /// The outer hierarchy of P_i; its `polytope()` is P_i, with vertices and coplanar triangles merged to facets.
  [[nodiscard]] const PolyhedralHierarchy& outer(int level) const;

  /// The vertex of P that is vertex v of P_i.
  [[nodiscard]] int vertex_of_whole(int level, int v) const;
  /// Back: its number in P_i; -1 where it is gone.
  [[nodiscard]] int vertex_of_level(int level, int v) const;

  /// The facet of P_i, which is an element of `outer(level)`, that holds triangle f of `inner()`; -1 where f is no
  /// triangle of this level.
  [[nodiscard]] int facet_of_triangle(int level, int f) const;
  /// Back: the triangles of `inner()` whose union is a facet of P_i.
  [[nodiscard]] std::span<const std::int32_t> triangles_of_facet(int level, int facet) const;

  /// Bytes of the inner hierarchy, of the outer ones with their polytopes, and of the pointers; P itself not counted.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Storage;
  explicit TwinHierarchy(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}
  std::shared_ptr<const Storage> data_;
};

}  // namespace pd
