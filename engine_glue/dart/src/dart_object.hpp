/// @file
/// DART's collision objects and groups for pdepth's detector, and its shapes as bodies.
#pragma once

#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/dynamics/ShapeFrame.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kept_bodies.hpp"
#include "pd/dart/collision_detector.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd::detail {

/// The reason why DART's own detector has to answer a pair, and a text that names the frame.
struct NamedDartRefusal {
  DartRefusal kind;
  std::string text;
};

/// A shape of DART: a body, a half-space in its frame, or a refusal.
struct DartBody {
  std::optional<ConvexShape> shape;
  std::optional<Halfspace3> ground;
  std::optional<Vec3> half_extents;  ///< of a box
  std::optional<NamedDartRefusal> refusal;
  double radius = 0;  ///< of what the shape fills around its origin; infinity: unbounded or unknown
};

[[nodiscard]] DartBody dart_body(const dart::dynamics::ShapeFrame& frame);

/// The name and the type of a frame's shape, for messages: "gripper" (MeshShape).
[[nodiscard]] std::string name_of(const dart::dynamics::ShapeFrame& frame);

class DartObject final : public dart::collision::CollisionObject {
 public:
  DartObject(dart::collision::CollisionDetector* detector, const dart::dynamics::ShapeFrame* frame)
      : CollisionObject(detector, frame) {
    convert_if_changed();
  }
  /// Converts the frame's shape if it is another one, or another version of it, than the last.
  void convert_if_changed();

  /// The shape at the pose of the last update; a refusal if either is none.
  [[nodiscard]] const DartBody& body() const { return body_; }
  [[nodiscard]] const std::optional<NamedDartRefusal>& refusal() const {
    return body_.refusal ? body_.refusal : bad_pose_;
  }
  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] PosedShape posed() const { return {&*body_.shape, pose_}; }
  /// The half-space of a plane, in the world.
  [[nodiscard]] Halfspace3 ground() const;

 protected:
  void updateEngineData() override;

 private:
  std::optional<std::pair<std::size_t, std::size_t>> converted_;  ///< the shape's id and version
  DartBody body_;
  Pose pose_;
  std::optional<NamedDartRefusal> bad_pose_;
};

class DartGroup final : public dart::collision::CollisionGroup {
 public:
  using CollisionGroup::CollisionGroup;

  /// The objects, at their poses of now.
  const std::vector<DartObject*>& refreshed() {
    updateEngineData();
    return objects_;
  }

 protected:
  void initializeEngineData() override {}
  void addCollisionObjectToEngine(dart::collision::CollisionObject* object) override;
  void addCollisionObjectsToEngine(const std::vector<dart::collision::CollisionObject*>& objects) override;
  void removeCollisionObjectFromEngine(dart::collision::CollisionObject* object) override;
  void removeAllCollisionObjectsFromEngine() override { objects_.clear(); }
  void updateCollisionGroupEngineData() override {}

 private:
  std::vector<DartObject*> objects_;
};

/// True if the spheres around two objects meet or one of the objects has none.
[[nodiscard]] bool spheres_meet(const DartObject& a, const DartObject& b);

}  // namespace pd::detail
