/// @file
/// The contact algorithm of a convex body and a mesh or heightfield: the points of all triangles, chosen together.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <memory>

namespace pd::detail {

class Installation;

/// Bullet's own algorithm hands one manifold of four to every triangle in turn, so that what it keeps hangs on their
/// order, and (3.24) asks no triangle before the body is within the breaking threshold of it less its margin, which
/// lets bodies sink through most of a mesh's margin. This one collects the points of all triangles that the body's box
/// meets, each under the rule of covered_contact.hpp, and keeps four for each direction (patches.hpp).
class MeshAlgorithm final : public btActivatingCollisionAlgorithm {
 public:
  /// @param swapped  a is the mesh
  MeshAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                const btCollisionObjectWrapper* b, const Installation& installation, bool swapped);
  ~MeshAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  /// 1: as without motion; no world of Bullet 3 asks.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

  struct CreateFunc : public btCollisionAlgorithmCreateFunc {
    CreateFunc(const Installation& i, bool swapped) : installation(i) { m_swapped = swapped; }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
    const Installation& installation;
  };

  /// Whether meshes of this Bullet type are taken: those that are triangles and nothing else.
  [[nodiscard]] static bool takes(int proxy_type);

 private:
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace pd::detail
