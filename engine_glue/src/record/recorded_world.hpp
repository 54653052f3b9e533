/// @file
/// The near callback of a recorded world: what the narrow phase has just said of one pair, as lines of a record.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/Dynamics/btActionInterface.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "record/record_shapes.hpp"

namespace pd::detail {

/// A body of a pair, or a part of it: a child of a compound, a triangle of a mesh.
struct RecordedPart {
  std::optional<std::string> shape;  ///< empty: no exact form
  btTransform pose;
};

class RecordedWorld final : public btActionInterface {
 public:
  RecordedWorld(btCollisionWorld& world, const char* path, int every);
  ~RecordedWorld() override;
  RecordedWorld(const RecordedWorld&) = delete;
  RecordedWorld& operator=(const RecordedWorld&) = delete;

  bool close();
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::int64_t contacts() const { return record_.contacts; }
  [[nodiscard]] std::int64_t unsupported() const { return unsupported_; }

  /// Of the dispatcher: the callback before ours, then ours.
  static void near_callback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

  // A step of a dynamics world has ended.
  void updateAction(btCollisionWorld* world, btScalar step) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  struct Group;

  void write_pair(btBroadphasePair& pair);
  /// The points of a pair's manifolds by the parts that they belong to, in the order in which they come.
  [[nodiscard]] std::vector<Group> groups_of(const btBroadphasePair& pair, const btCollisionObject*& a,
                                             const btCollisionObject*& b) const;
  void write_group(const btCollisionObject& a, const btCollisionObject& b, const Group& group);
  [[nodiscard]] RecordedPart part_of(const btCollisionObject& object, int part, int index, bool sharp,
                                     bool without_margin, const btVector3* at);
  [[nodiscard]] RecordedPart triangle_of(const btCollisionObject& object, int part, int index, bool without_margin,
                                         const btVector3& at);

  btCollisionWorld& world_;
  btCollisionDispatcher* dispatcher_;
  btNearCallback before_ = nullptr;
  pd_record record_{};
  RecordShapes shapes_;
  std::mutex mutex_;
  int every_;
  std::int64_t step_ = 0;
  std::int64_t unsupported_ = 0;
  bool good_ = false;
  bool open_ = false;
};

}  // namespace pd::detail
