/// @file
/// The polyhedral hierarchies of Dobkin and Kirkpatrick ([D] section 5.1): a convex polytope as a sequence of coarser
/// ones, each by a constant factor smaller.
///
/// Inner: from one level to the next an independent set of vertices of small degree is taken out, and the level is the
/// hull of the rest. Outer: the same with facets, whose neighbours' planes close the gaps; it is the inner hierarchy of
/// the polar body. Heights are O(log n), sizes O(n), because at least a fixed fraction of a planar graph's vertices is
/// independent and of a degree below 9 ([D] Fact 5.1).
///
/// What both consist of is called an element here: a vertex of an inner hierarchy, a facet of an outer one. Every
/// level is a triangulated surface over its elements. A triangle is a face of an inner level (coplanar ones stand
/// side by side), and a vertex of an outer one, where its three planes meet.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd {

enum class HierarchyKind : std::uint8_t { inner, outer };

/// Immutable, cheap to copy. Moving copies, so that every hierarchy holds its levels.
class PolyhedralHierarchy {
 public:
  PolyhedralHierarchy(const PolyhedralHierarchy&) = default;
  PolyhedralHierarchy& operator=(const PolyhedralHierarchy&) = default;
  ~PolyhedralHierarchy() = default;

  /// Elements of a higher degree stay.
  static constexpr int kMaxDegree = 8;

  struct Level {
    std::int32_t vertices = 0;
    std::int32_t facets = 0;
    std::int32_t max_degree = 0;  ///< of what the step to the next level takes out; 0 at the last level
  };

  /// A neighbour of an element, and the triangle between it and the next neighbour counter-clockwise.
  struct Star {
    std::int32_t neighbour;
    std::int32_t face;
  };

  /// Level 0 is the polytope itself. The last one is where nothing can go any more: a tetrahedron, as a rule; a box has
  /// no coarser outer level, because no five of its six planes bound a body.
  /// @return ErrorCode::not_full_dimensional for flat bodies.
  /// Decisions by exact signs. Time and space O(n): each level is O(its size).
  static Expected<PolyhedralHierarchy> build(const ConvexPolytope& polytope, HierarchyKind kind);

  [[nodiscard]] HierarchyKind kind() const;
  [[nodiscard]] const ConvexPolytope& polytope() const;
  [[nodiscard]] std::span<const Level> levels() const;

  /// The coarsest level that has the element.
  [[nodiscard]] int last_level(int element) const;
  /// Its star in that level, counter-clockwise: O(1) neighbours, but at the coarsest level.
  [[nodiscard]] std::span<const Star> star(int element) const;
  /// The elements of the coarsest level, ascending.
  [[nodiscard]] std::span<const std::int32_t> coarsest() const;
  /// Triangles of all levels, O(n) in all, those of level 0 first.
  [[nodiscard]] int num_faces() const;
  /// Its three elements, counter-clockwise.
  [[nodiscard]] const std::array<std::int32_t, 3>& face(int f) const;
  /// The pointer of [D] section 5.1: the element whose removal created the triangle, -1 for those of level 0. A
  /// triangle is there from level last_level(creator) + 1 on, until one of its corners goes.
  [[nodiscard]] int creator(int f) const;
  /// Bytes held by the shared storage, the polytope's own not counted.
  [[nodiscard]] std::size_t memory_bytes() const;

  /// The vertex of a level that maximises <v, direction>, up to rounding ([D] Lemma 5.4, the first contact of a
  /// translating plane). Requires an inner hierarchy. Time O(log n), for any degrees. From level to level two edges
  /// of the best vertex are kept, its neighbours in the shadow along a fixed second direction. A better vertex of
  /// the finer level must have created one of the four triangles at them (Edelsbrunner and Maurer, "Finding extreme
  /// points in three dimensions and solving the post-office problem in the plane", 1985).
  /// @param dot_products  counted up, when given.
  [[nodiscard]] int support(const Vec3& direction, std::int64_t* dot_products = nullptr, int level = 0) const;

 private:
  struct Storage;
  template <class Space>
  static void coarsen(const Space& space, Storage& data);
  explicit PolyhedralHierarchy(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}
  std::shared_ptr<const Storage> data_;
};

}  // namespace pd
