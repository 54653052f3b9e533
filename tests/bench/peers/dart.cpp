/// DART's collision detectors as its users call them, two groups of one object each, and pdepth's among them.
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/CollisionOption.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <utility>

#include "bench/peers/solver.hpp"
#include "dart/dart_mesh.hpp"
#include "pd/dart/collision_detector.hpp"

namespace pd::bench {

namespace {

using dart::collision::CollisionDetectorPtr;

/// A box as a box, all else as a mesh.
dart::dynamics::ShapePtr dart_shape(const ConvexShape& shape) {
  if (const auto half = half_extents_of(shape)) return std::make_shared<dart::dynamics::BoxShape>(2 * *half);
  return test::dart_mesh(*shape.polytope());
}

class DartAttempt final : public Attempt {
 public:
  DartAttempt(CollisionDetectorPtr detector, const Bodies& bodies)
      : detector_(std::move(detector)), a_(frame_of(bodies.a)), b_(frame_of(bodies.b)) {
    group_a_ = detector_->createCollisionGroup(a_.get());
    group_b_ = detector_->createCollisionGroup(b_.get());
  }
  void stand(const Pose& a, const Pose& b) override {
    place(*a_, a);
    place(*b_, b);
  }
  void run() override { group_a_->collide(group_b_.get(), dart::collision::CollisionOption(), &result_); }
  /// The deepest contact. DART's normal points from the second object to the first.
  [[nodiscard]] Answer answer() const override {
    const dart::collision::Contact* deepest = nullptr;
    for (const auto& contact : result_.getContacts()) {
      if (deepest == nullptr || contact.penetrationDepth > deepest->penetrationDepth) deepest = &contact;
    }
    if (deepest == nullptr) return {};
    const bool a_first = deepest->collisionObject1->getShapeFrame() == a_.get();
    return {true, deepest->penetrationDepth, (a_first ? 1 : -1) * deepest->penetrationDepth * deepest->normal};
  }

 private:
  static dart::dynamics::SimpleFramePtr frame_of(const ConvexShape& shape) {
    auto frame = dart::dynamics::SimpleFrame::createShared(dart::dynamics::Frame::World());
    frame->setShape(dart_shape(shape));
    return frame;
  }
  static void place(dart::dynamics::SimpleFrame& frame, const Pose& pose) {
    Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
    at.linear() = pose.rotation();
    at.translation() = pose.translation();
    frame.setTransform(at);
  }

  CollisionDetectorPtr detector_;
  dart::dynamics::SimpleFramePtr a_, b_;
  std::unique_ptr<dart::collision::CollisionGroup> group_a_, group_b_;
  dart::collision::CollisionResult result_;
};

class DartSolver final : public Solver {
 public:
  /// @param detector  a name of DART's factory
  explicit DartSolver(std::string detector) : detector_(std::move(detector)), name_("dart-" + detector_) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  /// DART's own detector knows boxes, but no meshes.
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    return detector_ != "dart" || (half_extents_of(bodies.a) && half_extents_of(bodies.b));
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<DartAttempt>(dart::collision::CollisionDetector::getFactory()->create(detector_), bodies);
  }

 private:
  std::string detector_, name_;
};

}  // namespace

void add_dart(Solvers& solvers) {
  register_dart_detector();
  for (const char* detector : {"fcl", "bullet", "ode", "dart", "pdepth"}) {
    if (dart::collision::CollisionDetector::getFactory()->canCreate(detector)) {
      solvers.push_back(std::make_unique<DartSolver>(detector));
    }
  }
}

}  // namespace pd::bench
