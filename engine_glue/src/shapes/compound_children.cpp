#include "shapes/compound_children.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>
#include <typeinfo>

#include "pd/bullet/scalar.hpp"
#include "shapes/child_tree.hpp"
#include "shapes/flat_compound.hpp"

namespace pd::detail {

namespace {

/// Importers put a `btEmptyShape` where a link has nothing to collide with.
bool is_empty(const btCollisionShape& child) { return child.getShapeType() == EMPTY_SHAPE_PROXYTYPE; }

const FlatCompound* as_flat(const btCompoundShape& compound) {
  return typeid(compound) == typeid(FlatCompound) ? static_cast<const FlatCompound*>(&compound) : nullptr;
}

int number_for_hosts(const FlatCompound* flat, int child) {
  return flat != nullptr ? flat->number_in_its_compound(child) : child;
}

}  // namespace

ChildBox box_of(const btCollisionShape& shape, const btTransform& pose) {
  ChildBox box;
  shape.getAabb(pose, box.lower, box.upper);
  return box;
}

bool apart(const ChildBox& a, const ChildBox& b, btScalar reach) {
  for (int i = 0; i < 3; ++i) {
    if (a.lower[i] > b.upper[i] + reach || b.lower[i] > a.upper[i] + reach) return true;
  }
  return false;
}

void children_near(const btCollisionObjectWrapper& wrapper, const btCollisionObjectWrapper& other, const ChildBox& box,
                   btScalar reach, std::vector<Child>& children) {
  children.clear();
  const btCollisionShape& shape = *wrapper.getCollisionShape();
  const btTransform& pose = wrapper.getWorldTransform();
  if (!shape.isCompound()) {
    children.push_back({&shape, pose, -1, box_of(shape, pose)});
    return;
  }
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  const FlatCompound* const flat = as_flat(compound);
  const auto visit = [&](int i) {
    if (is_empty(*compound.getChildShape(i))) return;
    Child child{compound.getChildShape(i), pose * compound.getChildTransform(i), i, {}};
    child.box = box_of(*child.shape, child.pose);
    if (apart(child.box, box, reach)) return;
    child.told_as = number_for_hosts(flat, i);
    children.push_back(child);
  };
  const ChildBox local = box_of(*other.getCollisionShape(), pose.inverseTimes(other.getWorldTransform()));
  const btVector3 extra(reach, reach, reach);
  for_each_child_meeting(compound, btDbvtVolume::FromMM(local.lower - extra, local.upper + extra), visit);
  // The tree's order depends on its history.
  const auto by_number = [](const Child& x, const Child& y) { return x.index < y.index; };
  if (!std::is_sorted(children.begin(), children.end(), by_number)) {
    std::sort(children.begin(), children.end(), by_number);
  }
}

bool all_children(const btCollisionObjectWrapper& wrapper, const btCollisionShape& other,
                  std::vector<Child>& children) {
  children.clear();
  const btCollisionShape& shape = *wrapper.getCollisionShape();
  const btTransform& pose = wrapper.getWorldTransform();
  if (!shape.isCompound()) {
    children.push_back({&shape, pose, -1, {}});
    return true;
  }
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  const FlatCompound* const flat = as_flat(compound);
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    const btCollisionShape& child = *compound.getChildShape(i);
    if (is_empty(child)) continue;
    if (!child.isConvex()) return false;
    if (gCompoundChildShapePairCallback != nullptr && !gCompoundChildShapePairCallback(&other, &child)) continue;
    const btTransform place = pose * compound.getChildTransform(i);
    if (is_finite(place)) children.push_back({&child, place, i, {}, number_for_hosts(flat, i)});
  }
  return true;
}

}  // namespace pd::detail
