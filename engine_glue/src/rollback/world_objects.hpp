/// @file
/// The collision objects of a world at one moment, and which of them are still there at a later one.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <cstdint>
#include <vector>

namespace pd::detail {

/// An object is known by its address, by the number that the broadphase gave it when it was added and, if it is a rigid
/// body, by Bullet's own number: a new object may lie where one was deleted, and btAxisSweep3 gives its numbers again.
class WorldObjects {
 public:
  /// True if an object that has another shape now counts as changed.
  enum class Shapes : std::uint8_t { compared, left_alone };

  void note(const btCollisionWorld& world);
  /// True if the world has the noted objects in the noted order. Time: O(objects).
  [[nodiscard]] bool same(const btCollisionWorld& world, Shapes shapes) const;
  /// Notes the present objects. @return those that were noted before, too, sorted by address
  [[nodiscard]] std::vector<const btCollisionObject*> renew(const btCollisionWorld& world);

 private:
  struct Noted {
    const btCollisionObject* object;
    const btCollisionShape* shape;
    int number;       ///< the broadphase's
    int body_number;  ///< Bullet's for a rigid body, else -1

    [[nodiscard]] bool is(const Noted& other) const {
      return object == other.object && number == other.number && body_number == other.body_number;
    }
  };
  [[nodiscard]] static Noted noted(const btCollisionObject& object);

  std::vector<Noted> objects_;
};

}  // namespace pd::detail
