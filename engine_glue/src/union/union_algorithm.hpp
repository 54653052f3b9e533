/// @file
/// The contact algorithm of pairs with a mesh, heightfield or compound: the points of all pieces, chosen together.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <cstdint>
#include <memory>

#include "union/patch_manifolds.hpp"
#include "union/patches.hpp"

namespace pd::detail {

class Installation;
class SolverCore;

/// What a step asks of a pair; of a mesh and another body, a is the other one.
struct UnionQuestion {
  const btCollisionObjectWrapper& a;
  const btCollisionObjectWrapper& b;
  double seconds;      ///< of the step
  btScalar threshold;  ///< up to which gap points are contacts
  std::uint64_t stamp;
  btManifoldResult& result;
};

/// The contacts of a pair's pieces, of one kind of union: triangles (mesh_contacts.hpp) or children
/// (compound_contacts.hpp). Lives as long as the pair.
class UnionContacts {
 public:
  UnionContacts() = default;
  virtual ~UnionContacts() = default;
  UnionContacts(const UnionContacts&) = delete;
  UnionContacts& operator=(const UnionContacts&) = delete;

  /// Adds the points of all pieces to `patches`, each piece's under the rule of covered_contact.hpp.
  /// @return false where a piece is not convex or has no exact form: Bullet's own algorithm answers for the pair then
  virtual bool find(const UnionQuestion& question, SolverCore& core, PairMemory& memory, Patches& patches) = 0;
  /// Hands the patches to the manifolds, with the pieces found last as surroundings of their points.
  virtual void replace(const UnionQuestion& question, Patches& patches, PatchManifolds& manifolds) = 0;
};

/// Bullet's own algorithms hand the pieces their points one after the other; this one keeps four for each direction of
/// the whole pair (patches.hpp).
class UnionAlgorithm final : public btActivatingCollisionAlgorithm {
 public:
  /// @param swapped  b is asked as the question's a
  UnionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                 const btCollisionObjectWrapper* b, const Installation& installation, bool swapped,
                 std::unique_ptr<UnionContacts> contacts);
  ~UnionAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  /// 1: as without motion; no world of Bullet 3 asks.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

  struct CreateFunc : public btCollisionAlgorithmCreateFunc {
    using Contacts = std::unique_ptr<UnionContacts> (*)();
    CreateFunc(const Installation& i, Contacts c, bool swapped) : installation(i), contacts(c) { m_swapped = swapped; }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
    const Installation& installation;
    Contacts contacts;
  };

 private:
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace pd::detail
