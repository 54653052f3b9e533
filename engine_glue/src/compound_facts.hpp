/// @file
/// What the children of a compound are to each other: which touch, and which facets lie inside, where one other child
/// covers all of them, so that no contact leads out over them.
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

/// One table a thread. What it says follows from the children's shapes and places alone, with a slack of their own, so
/// that it does not matter when or where it was found out; both are compared once a step.
class CompoundFacts {
 public:
  /// To be called for each pair in each step.
  /// @param stamp  of this step, 0: unknown, so that children are compared again
  void begin_pair(std::uint64_t stamp) {
    stamp_ = stamp;
    ++pair_;
  }

  /// Whether another child covers all of a facet, beyond doubt. False where the child is no solid polytope.
  [[nodiscard]] bool sealed(const btCompoundShape& compound, int child, std::size_t facet, SolverCore& core);

  /// The children other than this one whose boxes come within `reach` of its own, and perhaps a few more; nullptr: they
  /// are not known for so large a reach.
  [[nodiscard]] const std::vector<int>* neighbours(const btCompoundShape& compound, int child, double reach,
                                                   SolverCore& core);

  /// What a child was converted to, of this step; null where it is not convex.
  [[nodiscard]] const CachedShape* shape_of(const btCompoundShape& compound, int child, SolverCore& core) {
    return known_of(compound, core).children[static_cast<std::size_t>(child)].shape.get();
  }

 private:
  enum class Seal : std::uint8_t { unknown, open, sealed };
  struct Child {
    const btCollisionShape* source = nullptr;
    btTransform place;
    std::shared_ptr<CachedShape> shape;
    UnionPiece piece;  ///< in the compound's frame
    btVector3 lower;
    btVector3 upper;
    std::vector<Seal> facets;
    double reach = -1;  ///< of `neighbours`; negative: they are not known
    std::vector<int> neighbours;
  };
  struct Known {
    std::uint64_t stamp = 0;
    std::uint64_t pair = 0;
    std::vector<Child> children;
  };

  Known& known_of(const btCompoundShape& compound, SolverCore& core);
  void compare(const btCompoundShape& compound, SolverCore& core, Known& known) const;
  bool find_seal(const Known& known, std::size_t child, std::size_t facet);

  std::unordered_map<const btCompoundShape*, Known> compounds_;
  std::vector<Vec3> corners_;
  std::vector<const Plane*> active_;
  std::uint64_t stamp_ = 0;
  std::uint64_t pair_ = 0;
  Known* recent_ = nullptr;  ///< asked for last, of pair `recent_pair_`
  const btCompoundShape* recent_of_ = nullptr;
  std::uint64_t recent_pair_ = 0;
};

}  // namespace pd::detail
