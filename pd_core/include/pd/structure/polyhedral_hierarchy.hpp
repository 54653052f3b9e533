/// @file
/// The polyhedral hierarchies of Dobkin and Kirkpatrick ([D] section 5.1): a convex polytope as a sequence of coarser
/// ones, each by a constant factor smaller.
///
/// Inner: from one level to the next an independent set of vertices of small degree is taken out, and the level is the
/// hull of the rest. Outer: the same with facets, whose neighbours' planes close the gaps; it is the inner hierarchy of
/// the polar body. Heights are O(log n), sizes O(n), because at least a fixed fraction of a planar graph's vertices is
/// independent and of a degree below 9 ([D] Fact 5.1).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd {

enum class HierarchyKind : std::uint8_t { inner, outer };

/// Immutable, cheap to copy.
class PolyhedralHierarchy {
 public:
  /// Vertices (facets) of a higher degree stay.
  static constexpr int kMaxDegree = 8;

  struct Level {
    std::int32_t vertices = 0;
    std::int32_t facets = 0;
    std::int32_t max_degree = 0;  ///< of what the step to the next level takes out; 0 at the last level
  };

  /// Level 0 is the polytope itself. The last one is where nothing can go any more: a tetrahedron, as a rule; a box has
  /// no coarser outer level, because no five of its six planes bound a body.
  /// @return ErrorCode::not_full_dimensional for flat bodies.
  /// Decisions by exact signs. Time and space O(n): each level is O(its size).
  static Expected<PolyhedralHierarchy> build(const ConvexPolytope& polytope, HierarchyKind kind);

  [[nodiscard]] HierarchyKind kind() const;
  [[nodiscard]] std::span<const Level> levels() const;

  /// The vertex that maximises <v, direction>, up to rounding ([D] Lemma 5.4, the first contact of a translating
  /// plane): from the last level's best vertex down; where a level's best vertex has a better neighbour among those
  /// that were taken out there, that one is the finer level's best. Requires an inner hierarchy. Time O(log n) where
  /// vertices lose few neighbours a level; one of high degree loses a fraction of them each time.
  /// @param dot_products  counted up, when given.
  [[nodiscard]] int support(const Vec3& direction, std::int64_t* dot_products = nullptr) const;

 private:
  struct Storage;
  explicit PolyhedralHierarchy(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}
  std::shared_ptr<const Storage> data_;
};

}  // namespace pd
