/// @file
/// The pieces of a union that come near a contact of one of them.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <cstdint>
#include <deque>
#include <vector>

#include "union_piece.hpp"

class btConvexShape;

namespace pd::detail {

class SolverCore;

/// The half-space of what covers against n: what does not reach into it has no way that leads on along n.
struct Beyond {
  Vec3 n;
  double level;
};

/// Finds pieces, and keeps the children of a pair's compounds in place once they were looked at: the contacts of one
/// pair ask for the same few, again and again.
class NearPieces {
 public:
  /// Forgets the children: bodies have moved, or are others. To be called for each pair in each step.
  void begin_pair() {
    num_compounds_ = 0;
    ++pair_;
  }

  /// The other pieces of the union that come within `reach` of a point, in world coordinates. Compounds in compounds
  /// and meshes in compounds included; curved parts are left out, since contacts inside of them do not arise from
  /// seams.
  /// @param beyond  null, or: pieces whose surface does not come beyond it are left out
  /// @return how many; they are read by [], until the next search
  int find(const btCollisionObjectWrapper& piece, const Vec3& point, double reach, const Beyond* beyond,
           std::uint64_t stamp, SolverCore& core);
  [[nodiscard]] const UnionPiece& operator[](int i) const { return *found_[static_cast<std::size_t>(i)]; }

 private:
  struct Search;
  class TrianglesOf;
  struct Child {
    std::uint64_t posed = 0;  ///< the pair for which this was posed
    std::uint64_t made = 0;   ///< the pair for which `piece` was made
    btTransform pose;
    btVector3 lower;
    btVector3 upper;
    UnionPiece piece;
  };
  struct PosedCompound {
    const btCollisionObject* body;
    std::vector<Child> children;
  };

  void collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
               Search& search);
  /// @param body  of which the compound is the whole, or null
  void collect_children(const btCompoundShape& compound, const btTransform& pose, int except,
                        const btCollisionObject* body, Search& search);
  void collect_convex(const btConvexShape& shape, Child& child, Search& search);
  std::vector<Child>& children_of(const btCollisionObject& body, int count);
  /// Not taken before `num_made_` grows.
  Child& next_made();

  std::vector<const UnionPiece*> found_;
  std::deque<Child> made_;  ///< for pieces that are no children of a whole body
  std::size_t num_made_ = 0;
  std::deque<PosedCompound> compounds_;
  std::size_t num_compounds_ = 0;
  std::uint64_t pair_ = 1;
};

}  // namespace pd::detail
