/// @file
/// The children of a compound by Bullet's tree of their boxes.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

namespace pd::detail {

/// Calls `visit(number)` for the children whose boxes meet a volume in the compound's frame, in the tree's order.
template <class Visit>
void for_each_leaf(const btDbvt& tree, const btDbvtVolume& volume, const Visit& visit) {
  struct Leaves : public btDbvt::ICollide {
    explicit Leaves(const Visit& function) : each(function) {}
    void Process(const btDbvtNode* leaf) override { each(leaf->dataAsInt); }
    const Visit& each;
  } leaves(visit);
  tree.collideTV(tree.m_root, volume, leaves);
}

/// Calls `visit(number)` for the children whose boxes meet a volume in the compound's frame, in no order. Those of a
/// compound without a tree are visited all.
template <class Visit>
void for_each_child_meeting(const btCompoundShape& compound, const btDbvtVolume& volume, const Visit& visit) {
  /// Of so few children each is compared; of more, Bullet's tree is asked.
  constexpr int kFewChildren = 32;
  const btDbvt* tree = compound.getDynamicAabbTree();
  const int count = compound.getNumChildShapes();
  if (tree != nullptr && count > kFewChildren) {
    for_each_leaf(*tree, volume, visit);
    return;
  }
  // Bullet offers no children to a reader of a constant compound.
  const btCompoundShapeChild* children = const_cast<btCompoundShape&>(compound).getChildList();
  for (int i = 0; i < count; ++i) {
    if (tree == nullptr || Intersect(children[i].m_node->volume, volume)) visit(i);
  }
}

}  // namespace pd::detail
