/// @file
/// The facets inside of a compound: those that one other child covers whole, so that no contact leads out over them.
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "cached_shape.hpp"
#include "union_piece.hpp"

namespace pd::detail {

class SolverCore;

/// What is known of the facets of compounds, one table a thread. It follows from the children's shapes and places
/// alone, with a slack of their own, so that it does not matter when or where it was found out; both are compared once
/// a step.
class SealedFacets {
 public:
  /// To be called for each pair in each step.
  /// @param stamp  of this step, 0: unknown, so that children are compared again
  void begin_pair(std::uint64_t stamp) {
    stamp_ = stamp;
    ++pair_;
  }

  /// Whether another child covers all of a facet, beyond doubt. False where the child is no solid polytope.
  [[nodiscard]] bool sealed(const btCompoundShape& compound, int child, std::size_t facet, SolverCore& core);

 private:
  enum class Seal : std::uint8_t { unknown, open, sealed };
  struct Child {
    const btCollisionShape* source = nullptr;
    btTransform place;
    std::shared_ptr<CachedShape> shape;
    UnionPiece piece;  ///< in the compound's frame
    Vec3 lower = Vec3::Zero();
    Vec3 upper = Vec3::Zero();
    std::vector<Seal> facets;
  };
  struct Known {
    std::uint64_t stamp = 0;
    std::uint64_t pair = 0;
    std::vector<Child> children;
  };

  void compare(const btCompoundShape& compound, SolverCore& core, Known& known) const;
  bool find_seal(const Known& known, std::size_t child, std::size_t facet);

  std::unordered_map<const btCompoundShape*, Known> compounds_;
  std::vector<Vec3> corners_;
  std::vector<const Plane*> active_;
  std::uint64_t stamp_ = 0;
  std::uint64_t pair_ = 0;
};

}  // namespace pd::detail
