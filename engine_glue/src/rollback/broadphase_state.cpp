#include "rollback/broadphase_state.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>
#include <map>

namespace pd::detail {

namespace {

template <class Visit>
void for_each_node(btDbvtNode* node, Visit&& visit) {
  if (node == nullptr) {
    return;
  }
  if (node->isinternal()) {
    for_each_node(node->childs[0], visit);
    for_each_node(node->childs[1], visit);
  }
  visit(node);
}

/// The counters of a broadphase, and the first proxies of its stages.
template <class Broadphase>
auto counters_of(Broadphase& b) {
  return std::tie(b.m_stageRoots[0], b.m_stageRoots[1], b.m_stageRoots[2], b.m_stageCurrent, b.m_newpairs,
                  b.m_fixedleft, b.m_updates_call, b.m_updates_done, b.m_updates_ratio, b.m_pid, b.m_cid,
                  b.m_needcleanup);
}
static_assert(btDbvtBroadphase::STAGECOUNT == 2);

int count_manifolds(btCollisionAlgorithm* algorithm) {
  if (algorithm == nullptr) {
    return -1;
  }
  thread_local btManifoldArray manifolds;  // asked for every pair of every snapshot: its memory is kept
  manifolds.resize(0);
  algorithm->getAllContactManifolds(manifolds);
  return manifolds.size();
}

void free_algorithm(btCollisionAlgorithm* algorithm, btDispatcher* dispatcher) {
  algorithm->~btCollisionAlgorithm();
  dispatcher->freeCollisionAlgorithm(algorithm);
}

}  // namespace

void BroadphaseState::save(btCollisionWorld& world) {
  pairs_.clear();
  proxies_.clear();
  const btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    pairs_.push_back({pairs[i].m_pProxy0, pairs[i].m_pProxy1, count_manifolds(pairs[i].m_algorithm)});
  }
  if (const auto* trees = dynamic_cast<const btDbvtBroadphase*>(world.getBroadphase())) {
    save_trees(*trees, world);
  }
}

void BroadphaseState::restore(btCollisionWorld& world) const {
  if (auto* trees = dynamic_cast<btDbvtBroadphase*>(world.getBroadphase())) {
    restore_trees(*trees);
  } else {
    world.updateAabbs();
  }
  restore_pairs(world);
}

void BroadphaseState::save_trees(const btDbvtBroadphase& broadphase, const btCollisionWorld& world) {
  for (int i = 0; i < 2; ++i) {
    const btDbvt& tree = broadphase.m_sets[i];
    trees_[i].root = tree.m_root;
    trees_[i].lookahead = tree.m_lkhd;
    trees_[i].leaves = tree.m_leaves;
    trees_[i].path = tree.m_opath;
    trees_[i].nodes.clear();
    for_each_node(tree.m_root, [&](btDbvtNode* node) { trees_[i].nodes.push_back({node, *node}); });
  }
  const btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (auto* proxy = static_cast<btDbvtProxy*>(const_cast<btBroadphaseProxy*>(objects[i]->getBroadphaseHandle()))) {
      proxies_.push_back({proxy, *proxy});
    }
  }
  counters_ = counters_of(broadphase);
}

/// Where each saved node lives now: at its old address where that is still a node's, else anywhere. The nodes of both
/// trees and their spare ones are the memory at hand; updates alone neither add to it nor take away.
std::map<const btDbvtNode*, btDbvtNode*> BroadphaseState::house_nodes(btDbvtBroadphase& broadphase) const {
  std::vector<btDbvtNode*> memory;
  for (btDbvt& tree : broadphase.m_sets) {
    for_each_node(tree.m_root, [&](btDbvtNode* node) { memory.push_back(node); });
    if (tree.m_free != nullptr) {
      memory.push_back(tree.m_free);
    }
    tree.m_root = nullptr;
    tree.m_free = nullptr;
  }
  std::sort(memory.begin(), memory.end());
  std::map<const btDbvtNode*, btDbvtNode*> now_at{{nullptr, nullptr}};
  std::vector<btDbvtNode*> homeless;
  for (const SavedTree& tree : trees_) {
    for (const SavedNode& saved : tree.nodes) {
      const auto place = std::lower_bound(memory.begin(), memory.end(), saved.address);
      if (place != memory.end() && *place == saved.address) {
        now_at[saved.address] = saved.address;
        memory.erase(place);
      } else {
        homeless.push_back(saved.address);  // a body has gone to sleep or woken since: its leaf was made anew
      }
    }
  }
  for (btDbvtNode* address : homeless) {
    if (memory.empty()) {
      memory.push_back(new (btAlignedAlloc(sizeof(btDbvtNode), 16)) btDbvtNode);
    }
    now_at[address] = memory.back();
    memory.pop_back();
  }
  for (btDbvtNode* left_over : memory) {
    btAlignedFree(left_over);
  }
  return now_at;
}

void BroadphaseState::restore_trees(btDbvtBroadphase& broadphase) const {
  std::map<const btDbvtNode*, btDbvtNode*> now_at = house_nodes(broadphase);
  for (int i = 0; i < 2; ++i) {
    btDbvt& tree = broadphase.m_sets[i];
    for (const SavedNode& saved : trees_[i].nodes) {
      btDbvtNode* node = now_at[saved.address];
      *node = saved.content;
      node->parent = now_at[saved.content.parent];
      if (node->isinternal()) {
        node->childs[0] = now_at[saved.content.childs[0]];
        node->childs[1] = now_at[saved.content.childs[1]];
      }
    }
    tree.m_root = now_at[trees_[i].root];
    tree.m_lkhd = trees_[i].lookahead;
    tree.m_leaves = trees_[i].leaves;
    tree.m_opath = trees_[i].path;
  }
  for (const SavedProxy& saved : proxies_) {
    *saved.proxy = saved.content;
    saved.proxy->leaf = now_at[saved.content.leaf];
  }
  counters_of(broadphase) = counters_;
}

void BroadphaseState::restore_pairs(btCollisionWorld& world) const {
  btOverlappingPairCache* cache = world.getPairCache();
  btDispatcher* dispatcher = world.getDispatcher();
  btBroadphasePairArray& pairs = cache->getOverlappingPairArray();
  // Taken out with their algorithms set aside, put back in the saved order. Those left over are freed by the proxies'
  // numbers, for the order in which manifolds go is the order of those that stay, and addresses differ from run to run.
  const auto numbers = [](const btBroadphaseProxy* a, const btBroadphaseProxy* b) {
    return std::pair(a->m_uniqueId, b->m_uniqueId);
  };
  std::map<std::pair<int, int>, btCollisionAlgorithm*> algorithms;
  while (pairs.size() > 0) {
    btBroadphasePair& last = pairs[pairs.size() - 1];
    btBroadphaseProxy* const proxy0 = last.m_pProxy0;
    btBroadphaseProxy* const proxy1 = last.m_pProxy1;
    algorithms[numbers(proxy0, proxy1)] = last.m_algorithm;
    last.m_algorithm = nullptr;
    cache->removeOverlappingPair(proxy0, proxy1, dispatcher);
  }
  std::vector<int> incomplete;
  for (const SavedPair& saved : pairs_) {
    btBroadphasePair* pair = cache->addOverlappingPair(saved.proxy0, saved.proxy1);
    const auto found = algorithms.find(numbers(saved.proxy0, saved.proxy1));
    if (pair == nullptr || saved.num_manifolds < 0) {
      continue;
    }
    // A compound's algorithm that has lost children since is made anew; children that came since are left to the
    // caller.
    if (found != algorithms.end() && count_manifolds(found->second) >= saved.num_manifolds) {
      pair->m_algorithm = found->second;
      found->second = nullptr;
    } else {
      incomplete.push_back(static_cast<int>(pair - &pairs[0]));
    }
  }
  for (const auto& [pair_numbers, algorithm] : algorithms) {
    if (algorithm != nullptr) {
      free_algorithm(algorithm, dispatcher);
    }
  }
  // Only these are processed: the others keep their manifolds, in their order.
  auto& narrow_phase = *static_cast<btCollisionDispatcher*>(dispatcher);
  for (const int i : incomplete) {
    narrow_phase.getNearCallback()(pairs[i], narrow_phase, world.getDispatchInfo());
  }
}

}  // namespace pd::detail
