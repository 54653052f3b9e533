/// @file
/// A collision detector for DART whose contacts and distances are exact.
///
///   pd::register_dart_detector();
///   auto detector = dart::collision::CollisionDetector::getFactory()->create("pdepth");
///   world->getConstraintSolver()->setCollisionDetector(detector);
///
/// Boxes, spheres, ellipsoids, cylinders, capsules, cones, pyramids, hulls of spheres and meshes that bound a convex
/// solid are answered against each other and against planes, which are half-spaces. All other
/// shapes (soft meshes, height maps, voxels, meshes that are not convex) and shapes that are no bodies are left to
/// DART's own FCL detector, pair by pair, and counted.
///
/// Contacts mean what DART means by them: the normal points from the second object to the first, the point lies midway
/// between the surfaces. Points are in the frame of the world, lengths in DART's unit.
#pragma once

#include <array>
#include <cstdint>
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <memory>
#include <string>

namespace pd {

namespace detail {
class DartQueries;
}

struct DartOptions {
  /// For cylinders, cones, ellipsoids and hulls of spheres: the relative error of depth and distance, in [0, 1]; 0 and
  /// values outside stand for 1e-6. All else is exact up to rounding.
  double delta = 0;
  /// Gets one line when a pair is left to DART's FCL detector for the first time for a reason; null: silence.
  void (*warning)(const char* line, void* user) = &print_warning;
  void* user = nullptr;  ///< is handed to `warning`

  /// Writes the line to the standard error stream.
  static void print_warning(const char* line, void* user);
};

/// The reason why a pair got the contact of DART's FCL detector.
enum class DartRefusal : std::uint8_t {
  pose,   ///< a pose is NaN, infinite or no rotation
  size,   ///< a size is not positive and finite, or a plane has no normal
  mesh,   ///< a mesh bounds no convex solid
  shape,  ///< a shape that pdepth does not know
};
inline constexpr int kDartRefusals = 4;

/// Counts of one detector.
struct DartReport {
  std::int64_t answered = 0;                       ///< pairs whose spheres met
  std::int64_t contact_points = 0;                 ///< written for them
  std::array<std::int64_t, kDartRefusals> left{};  ///< pairs left to FCL, by DartRefusal
  std::array<std::string, kDartRefusals> first{};  ///< the first pair of each: its frame and the error
};

/// The detector. Like DART's own, one detector serves one thread at a time, and shapes are converted when DART says
/// that they have changed.
class DartDetector final : public dart::collision::CollisionDetector {
 public:
  using CollisionDetector::createCollisionGroup;

  static std::shared_ptr<DartDetector> create(const DartOptions& options = {});
  ~DartDetector() override;

  [[nodiscard]] std::shared_ptr<CollisionDetector> cloneWithoutCollisionObjects() const override;
  [[nodiscard]] const std::string& getType() const override;  ///< "pdepth"
  static const std::string& getStaticType();
  std::unique_ptr<dart::collision::CollisionGroup> createCollisionGroup() override;

  /// Up to four points of each pair that overlaps or touches, the deepest first, until the option's number of contacts
  /// is reached. Without a result it stops at the first pair. Filters are asked first. Objects that two groups share
  /// are not asked against themselves. Time O(n log n + k) for n objects of which k pairs have spheres that meet along
  /// the axis of the widest spread, and that of the pairs.
  bool collide(dart::collision::CollisionGroup* group, const dart::collision::CollisionOption& option,
               dart::collision::CollisionResult* result) override;
  bool collide(dart::collision::CollisionGroup* group1, dart::collision::CollisionGroup* group2,
               const dart::collision::CollisionOption& option, dart::collision::CollisionResult* result) override;

  /// The least signed distance of all pairs that the filter lets through, minus the depth where a pair overlaps,
  /// clamped by the option's lower bound (0 by default). The search ends at the first pair at or below that bound. Time
  /// O(n^2) for n objects, and that of the pairs whose spheres are nearer than the nearest pair so far.
  double distance(dart::collision::CollisionGroup* group, const dart::collision::DistanceOption& option,
                  dart::collision::DistanceResult* result) override;
  double distance(dart::collision::CollisionGroup* group1, dart::collision::CollisionGroup* group2,
                  const dart::collision::DistanceOption& option, dart::collision::DistanceResult* result) override;

  // Rays are refused by name, as in DART's own and FCL's detector: CollisionDetector::raycast warns and returns false.

  [[nodiscard]] DartReport report() const;

 protected:
  std::unique_ptr<dart::collision::CollisionObject> createCollisionObject(
      const dart::dynamics::ShapeFrame* frame) override;
  void refreshCollisionObject(dart::collision::CollisionObject* object) override;
  void notifyCollisionObjectDestroying(dart::collision::CollisionObject* object) override;

 private:
  explicit DartDetector(const DartOptions& options);

  std::unique_ptr<detail::DartQueries> queries_;
};

/// Makes the name "pdepth" known to DART's factory of detectors. May be called again. Not for several threads at once.
void register_dart_detector();

}  // namespace pd
