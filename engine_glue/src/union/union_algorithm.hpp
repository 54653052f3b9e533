/// @file
/// The contact algorithm of pairs with a mesh, heightfield or compound: the points of all pieces, chosen together.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <cstdint>
#include <memory>

#include "pair/algorithm_shell.hpp"
#include "pair/bounce.hpp"
#include "pd/union_contact/patches.hpp"
#include "pieces/asked_pieces.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/met_triangle.hpp"
#include "union/patch_manifolds.hpp"

namespace pd::detail {

/// What a step asks of a pair; of a mesh and another body, a is the other one.
struct UnionQuestion {
  const btCollisionObjectWrapper& a;
  const btCollisionObjectWrapper& b;
  StepTime time;
  btScalar threshold;  ///< up to which gap points are contacts
  std::uint64_t stamp;
  btManifoldResult& result;
  SolverCore& core;
  ThreadBuffers& buffers;
  PairMemory& memory;  ///< of the pair

  /// Two pieces of the pair, as the rule for covered contacts is asked about them.
  [[nodiscard]] AskedPieces of_pieces(const btCollisionObjectWrapper& piece_a,
                                      const btCollisionObjectWrapper& piece_b) const {
    return {piece_a,
            piece_b,
            {.threshold = static_cast<double>(threshold),
             .seconds = static_cast<double>(time.seconds),
             .shapes = {core.cache, stamp},
             .near = buffers.near,
             .cover = buffers.cover,
             .manifold = buffers.manifold}};
  }
};

/// The pieces that a point lies between: a child of the body a, and a child or triangle of the body b, or all of b.
struct PointPieces {
  const Child& of_a;
  const Child* child_of_b = nullptr;
  const MetTriangle* triangle = nullptr;
};

/// The search for the contacts of a pair's pieces, of one kind of union: triangles (mesh_contacts.hpp) or children
/// (compound_contacts.hpp). It holds nothing but what it works with, so that one search serves all pairs of a thread:
/// a search of each pair's own is 10 KB, and a thousand of them push each other out of the cache. What a pair remembers
/// from step to step is in its `PairMemory`.
class UnionContacts {
 public:
  UnionContacts() = default;
  virtual ~UnionContacts() = default;
  UnionContacts(const UnionContacts&) = delete;
  UnionContacts& operator=(const UnionContacts&) = delete;

  /// Adds the points of all pieces to `patches`, each piece's under the rule of covered_contact.hpp.
  /// @return false where a piece is not convex or has no exact form: Bullet's own algorithm answers for the pair then
  virtual bool find(const UnionQuestion& question, Patches& patches) = 0;
  /// Returns the pieces that a point of the patches lies between, by its piece's number. Requires: `find` filled them.
  [[nodiscard]] virtual PointPieces pieces_of(int piece) const = 0;
  /// Takes note of the points that were chosen.
  virtual void remember_chosen(const Patches& /*patches*/, PairMemory& /*memory*/) {}
};

/// True if a shape is a signed distance field. Its type is that of the host's own meshes, and it has no triangles.
[[nodiscard]] bool is_distance_field(const btCollisionShape& shape);

/// Bullet's own algorithms hand the pieces their points one after the other; this one keeps four for each direction of
/// the whole pair (patches.hpp).
class UnionAlgorithm final : public AlgorithmShell {
 public:
  struct Kind {
    std::unique_ptr<UnionContacts> (*contacts)();
    bool swapped;  ///< b is asked as the question's a
    static constexpr ContactTable table = ContactTable::contacts;
    [[nodiscard]] static bool takes(const SolverInWorld& world, const btCollisionObjectWrapper& a,
                                    const btCollisionObjectWrapper& b) {
      const bool field = is_distance_field(*a.getCollisionShape()) || is_distance_field(*b.getCollisionShape());
      return !field && world.core().settings.unions_as_one;
    }
  };
  UnionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                 const btCollisionObjectWrapper* b, const SolverInWorld& world, const Kind& kind);
  ~UnionAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 private:
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace pd::detail
