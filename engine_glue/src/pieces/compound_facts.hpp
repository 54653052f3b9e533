/// @file
/// What the children of a compound are to each other: which touch, which rise beyond a contact of another one, and
/// which facets lie inside, where one other child covers all of them, so that no contact leads out over them, or
/// outside, where none covers more than a line.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "pd/union_contact/piece_surroundings.hpp"
#include "pieces/piece_wrapper.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/step_shapes.hpp"

namespace pd::detail {

struct ChildOf {
  const btCompoundShape& compound;
  int number;
};

/// One table a thread. What it says follows from the children's shapes and places alone, with a slack of their own, so
/// that it does not matter when or where it was found out. Children near the pair's other body, and those near them,
/// are compared once a step: a large compound costs no more than what is met of it.
class CompoundFacts {
 public:
  /// To be called for each pair in each step.
  /// @param stamp  of this step, 0: unknown, so that children are compared again
  void begin_pair(std::uint64_t stamp) {
    if (stamp == 0 || stamp != stamp_) ++visit_;
    stamp_ = stamp;
  }

  /// To be called for each child near the other body, before any facts are asked for: one that has changed or come next
  /// to another is seen here. (Where Bullet hands over the children one by one, that is when they are asked
  /// themselves.)
  /// @return its shape, null where it is not convex
  const std::shared_ptr<CachedShape>& look_at(const ChildOf& child, BulletShapeCache& cache) {
    return compared(child, known_of(child.compound), cache).shape;
  }

  /// @param slack  as the reach of `neighbours`
  /// @return never `unknown`; `some` where the child is no solid polytope
  [[nodiscard]] FacetCover cover_of(const ChildOf& child, std::size_t facet, double slack, BulletShapeCache& cache);

  /// The children other than this one whose boxes come within `reach` of its own, and perhaps a few more; nullptr: they
  /// are not known for so large a reach.
  [[nodiscard]] const std::vector<int>* neighbours(const ChildOf& child, double reach, BulletShapeCache& cache);

  /// Whether a child other than this one comes within `reach` of a point of its core, or might: of most contacts none
  /// does.
  [[nodiscard]] bool may_hold(const ChildOf& child, const NearPoint& near, BulletShapeCache& cache);

  /// The children that could cover what this one touches another body with: of those as above the ones that come within
  /// `reach` of a point of its core and rise beyond a level along n. Most contacts have none.
  /// @param rising  set to them, by number
  /// @return false, and nothing set, where they are not known
  bool rising_near(const ChildOf& child, const NearPoint& near, const Beyond& beyond, BulletShapeCache& cache,
                   std::vector<int>& rising);

  /// A child as planes in the compound's frame, as it is in this step; no planes where it is no solid polytope.
  [[nodiscard]] const UnionPiece& piece_of(const ChildOf& child, BulletShapeCache& cache) {
    return compared(child, known_of(child.compound), cache).piece;
  }

 private:
  struct Child {
    std::uint64_t compared = 0;    ///< the visit in which it was
    std::uint64_t surrounded = 0;  ///< the visit in which its neighbours were
    std::uint64_t facts = 0;       ///< the change of the compound after which `facets` and `neighbours` were begun
    const btCollisionShape* source = nullptr;
    btTransform place;
    std::shared_ptr<CachedShape> shape;
    UnionPiece piece;           ///< in the compound's frame
    std::vector<Vec3> corners;  ///< of the piece
    btVector3 lower;
    btVector3 upper;
    std::vector<FacetCover> facets;
    std::vector<int> neighbours;  ///< by number

    /// Neighbours within this distance are all known.
    [[nodiscard]] double known_within() const;
  };
  struct Known {
    std::uint64_t change = 1;  ///< counts those of children
    std::vector<Child> children;
  };

  Known& known_of(const btCompoundShape& compound);
  /// The child as it is in this step.
  Child& compared(const ChildOf& child, Known& known, BulletShapeCache& cache) const;
  /// The same, with its neighbours as they are in this step, and facts that hold.
  Child& surrounded(const ChildOf& child, Known& known, BulletShapeCache& cache);
  void find_neighbours(const ChildOf& child, Known& known, BulletShapeCache& cache) const;
  FacetCover find_cover(const ChildOf& child, Known& known, std::size_t facet, BulletShapeCache& cache);

  std::unordered_map<const btCompoundShape*, Known> compounds_;
  std::vector<const PiecePlane*> active_;
  std::uint64_t stamp_ = 0;
  std::uint64_t visit_ = 0;
  /// Asked for last.
  struct Recent {
    Known* known = nullptr;
    const btCompoundShape* of = nullptr;
    std::uint64_t visit = 0;
  };
  std::array<Recent, 2> recent_;  ///< a pair asks for the one and the other
};

/// `look_at` for a pair's children of a body; of one that is no compound, nothing.
void look_at(const btCollisionObjectWrapper& body, std::span<const Child> children, CompoundFacts& facts,
             BulletShapeCache& cache);

}  // namespace pd::detail
