/// @file
/// The children of a compound by Bullet's tree of their boxes.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

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

}  // namespace pd::detail
