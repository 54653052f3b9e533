/// @file
/// The broadphase's part of a snapshot: which pairs there are, in which order, and the trees that find the next ones.
///
/// The order of pairs decides the order in which Bullet merges bodies into islands and solves contacts, so it is part
/// of the state. btDbvtBroadphase improves its trees a little every step, choosing by the addresses of nodes; so nodes
/// are written back to the addresses that they had.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <array>
#include <map>
#include <tuple>
#include <vector>

namespace pd::detail {

class BroadphaseState {
 public:
  /// Saves trees and pairs, in the memory of what was saved before.
  void save(btCollisionWorld& world);

  /// Brings trees and pairs back. Pairs that came since lose their algorithm and go; pairs that went are there again,
  /// with an algorithm and manifolds made at the present poses. Restore the bodies first.
  void restore(btCollisionWorld& world) const;

 private:
  struct SavedNode {
    btDbvtNode* address;
    btDbvtNode content;
  };
  struct SavedTree {
    std::vector<SavedNode> nodes;
    btDbvtNode* root;
    int lookahead;
    int leaves;
    unsigned path;
  };
  struct SavedProxy {
    btDbvtProxy* proxy;
    btDbvtProxy content;
  };
  struct SavedPair {
    btBroadphaseProxy* proxy0;
    btBroadphaseProxy* proxy1;
    int num_manifolds;  ///< of its algorithm (compounds have one a pair of children); -1 without one
  };

  void save_trees(const btDbvtBroadphase& broadphase, const btCollisionWorld& world);
  void restore_trees(btDbvtBroadphase& broadphase) const;
  std::map<const btDbvtNode*, btDbvtNode*> house_nodes(btDbvtBroadphase& broadphase) const;
  void restore_pairs(btCollisionWorld& world) const;

  std::vector<SavedPair> pairs_;
  std::vector<SavedProxy> proxies_;
  std::array<SavedTree, 2> trees_{};
  std::tuple<btDbvtProxy*, btDbvtProxy*, btDbvtProxy*, int, int, int, unsigned, unsigned, btScalar, int, int, bool>
      counters_{};
};

}  // namespace pd::detail
