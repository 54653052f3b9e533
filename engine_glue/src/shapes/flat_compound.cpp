#include "shapes/flat_compound.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <algorithm>
#include <mutex>

namespace pd::detail {

namespace {

/// Calls `visit(child, place in the whole, number in its compound)` for all children that are no compounds, until it
/// returns false. @return whether it never did
template <class Visit>
bool for_each_leaf_child(const btCompoundShape& compound, const btTransform& place, Visit&& visit) {
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    const btCollisionShape& child = *compound.getChildShape(i);
    const btTransform in_whole = place * compound.getChildTransform(i);
    const bool go_on = child.isCompound()
                           ? for_each_leaf_child(static_cast<const btCompoundShape&>(child), in_whole, visit)
                           : visit(child, in_whole, i);
    if (!go_on) return false;
  }
  return true;
}

/// True if the children that are no compounds are those of a flat compound from `next` on, by their addresses.
bool same_children(const btCompoundShape& holder, const btCompoundShape& flat, int& next) {
  for (int i = 0; i < holder.getNumChildShapes(); ++i) {
    const btCollisionShape* const child = holder.getChildShape(i);
    const bool same = child->isCompound() ? same_children(static_cast<const btCompoundShape&>(*child), flat, next)
                                          : next < flat.getNumChildShapes() && flat.getChildShape(next++) == child;
    if (!same) return false;
  }
  return true;
}

bool holds_compounds(const btCompoundShape& compound) {
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    if (compound.getChildShape(i)->isCompound()) return true;
  }
  return false;
}

}  // namespace

FlatCompound::FlatCompound(const btCompoundShape& source) : source_(&source) {
  setMargin(source.getMargin());
  for_each_leaf_child(source, btTransform::getIdentity(),
                      [&](const btCollisionShape& child, const btTransform& place, int number) {
                        numbers_.push_back(number);
                        // Bullet writes nothing to a child.
                        addChildShape(place, const_cast<btCollisionShape*>(&child));
                        return true;
                      });
}

bool FlatCompound::is_of(const btCompoundShape& source, std::uint64_t stamp) const {
  if (source_ != &source) return false;
  const int count = getNumChildShapes();
  int next = 0;
  if (stamp != 0 && compared_.load(std::memory_order_relaxed) == stamp) {
    // A child that the source has lost within the step may be freed.
    return same_children(source, *this, next) && next == count;
  }
  const bool same = for_each_leaf_child(
      source, btTransform::getIdentity(), [&](const btCollisionShape& child, const btTransform& place, int number) {
        if (next == count || getChildShape(next) != &child || !(getChildTransform(next) == place) ||
            numbers_[static_cast<std::size_t>(next)] != number) {
          return false;
        }
        // The tree has the boxes that the children had.
        const btDbvtVolume& held = const_cast<FlatCompound*>(this)->getChildList()[next].m_node->volume;
        btVector3 lower, upper;
        child.getAabb(place, lower, upper);
        ++next;
        return held.Mins() == lower && held.Maxs() == upper;
      });
  if (!same || next != count) return false;
  compared_.store(stamp, std::memory_order_relaxed);
  return true;
}

const btCompoundShape& FlatCompounds::flat(const btCompoundShape& compound, std::uint64_t stamp, FlatMemory& memory) {
  if (memory.plain == &compound && memory.revision == compound.getUpdateRevision()) return compound;
  if (memory.flat && memory.flat->is_of(compound, stamp)) return *memory.flat;
  memory = {};
  if (!holds_compounds(compound)) {
    memory.plain = &compound;
    memory.revision = compound.getUpdateRevision();
    return compound;
  }
  memory.flat = find(compound, stamp);
  return *memory.flat;
}

std::shared_ptr<const FlatCompound> FlatCompounds::find(const btCompoundShape& compound, std::uint64_t stamp) {
  {
    const std::shared_lock lock(mutex_);
    const auto found = known_.find(&compound);
    if (found != known_.end() && found->second->is_of(compound, stamp)) return found->second;
  }
  const std::unique_lock lock(mutex_);
  std::shared_ptr<const FlatCompound>& known = known_[&compound];
  if (known && known->is_of(compound, stamp)) return known;
  known = std::make_shared<const FlatCompound>(compound);
  const std::shared_ptr<const FlatCompound> made = known;
  if (known_.size() > most_) {
    std::erase_if(known_, [](const auto& entry) { return entry.second.use_count() == 1; });
    most_ = std::max<std::size_t>(256, 2 * known_.size());
  }
  return made;
}

}  // namespace pd::detail
