/// @file
/// Bodies on compounds of compounds, as bodies on one compound.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCompoundCompoundCollisionAlgorithm.h>

#include <cstdint>

#include "shapes/flat_compound.hpp"

namespace pd::detail {

/// A body with the flat form of its compound. A host's callback for pairs of children sees nested compounds as Bullet
/// shows them: where there is one, the body is taken as it is. Lives for one question; its references must outlive it.
class FlatWrapper {
 public:
  FlatWrapper(const btCollisionObjectWrapper& body, FlatCompounds& compounds, std::uint64_t stamp, FlatMemory& memory)
      : flat_(body.m_parent, &shape_of(body, compounds, stamp, memory), body.getCollisionObject(),
              body.getWorldTransform(), body.m_partId, body.m_index),
        used_(flat_.getCollisionShape() == body.getCollisionShape() ? body : flat_) {}
  FlatWrapper(const FlatWrapper&) = delete;
  FlatWrapper& operator=(const FlatWrapper&) = delete;
  [[nodiscard]] const btCollisionObjectWrapper& wrapper() const { return used_; }

 private:
  static const btCollisionShape& shape_of(const btCollisionObjectWrapper& body, FlatCompounds& compounds,
                                          std::uint64_t stamp, FlatMemory& memory) {
    const btCollisionShape& shape = *body.getCollisionShape();
    const bool asks_host =
        gCompoundChildShapePairCallback != nullptr || gCompoundCompoundChildShapePairCallback != nullptr;
    if (!shape.isCompound() || asks_host) return shape;
    return compounds.flat(static_cast<const btCompoundShape&>(shape), stamp, memory);
  }

  btCollisionObjectWrapper flat_;
  const btCollisionObjectWrapper& used_;
};

}  // namespace pd::detail
