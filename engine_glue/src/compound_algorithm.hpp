/// @file
/// The contact algorithm of compounds of convex children, against each other or a convex body: the points of all pairs
/// of children, chosen together.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <memory>

namespace pd::detail {

class Installation;

/// Bullet's own algorithms give every pair of children a manifold of its own, so that parts of one face fight over a
/// body, and offer no child before its box overlaps the other body's, so that what is fast is inside before anything
/// touches. This one meets children within the breaking threshold, asks each pair under the rule of covered_contact.hpp
/// and keeps four points for each direction of the whole pair (patches.hpp). Pairs with a child that is not convex or
/// has no exact form are left to Bullet's.
class CompoundAlgorithm final : public btActivatingCollisionAlgorithm {
 public:
  CompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                    const btCollisionObjectWrapper* b, const Installation& installation);
  ~CompoundAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  /// 1: as without motion; no world of Bullet 3 asks.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

  struct CreateFunc : public btCollisionAlgorithmCreateFunc {
    explicit CreateFunc(const Installation& i) : installation(i) {}
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
    const Installation& installation;
  };

 private:
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace pd::detail
