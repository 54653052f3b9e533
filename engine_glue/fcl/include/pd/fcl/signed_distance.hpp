/// @file
/// Exact distance and depth of FCL's collision objects, in FCL's own words: `distance` and `collide` take what
/// `fcl::distance` and `fcl::collide` take.
///
///   pd::FclQueries queries;  // one a thread
///   fcl::DistanceResultd result;
///   const double signed_distance = queries.distance(&a, &b, fcl::DistanceRequestd(), result);
///
/// Boxes, spheres, capsules, cylinders, cones, ellipsoids, triangles and convex meshes are answered by pdepth. All
/// others (half-spaces, planes, octrees, triangle meshes) and objects that are no bodies are FCL's, and counted.
#pragma once

#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/collision_request.h>
#include <fcl/narrowphase/collision_result.h>
#include <fcl/narrowphase/distance_request.h>
#include <fcl/narrowphase/distance_result.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace pd {

namespace detail {
class FclPairs;
}

/// Buffers, converted shapes and counters; not for several threads at once. Shapes are converted once for each geometry
/// and compared in every call. Results do not depend on earlier calls.
class FclQueries {
 public:
  FclQueries();
  ~FclQueries();
  FclQueries(FclQueries&&) noexcept;
  FclQueries& operator=(FclQueries&&) noexcept;

  /// The signed distance: above 0 apart, minus the penetration depth where the objects overlap.
  ///
  /// `result` is updated as FCL does it, when the pair is nearer than what it holds. Its nearest points are always set:
  /// the closest points, or where the objects overlap two points whose difference, the second minus the first, moves
  /// the first object out of the second. `request.rel_err` bounds the relative error for curved bodies (0: 1e-6); all
  /// else is exact up to rounding, whatever the request allows.
  double distance(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                  const fcl::DistanceRequest<double>& request, fcl::DistanceResult<double>& result);

  /// How many contacts were added: 0 when the objects are apart, else up to four, the deepest first, and no more than
  /// `request.num_max_contacts`. Objects that only touch have a contact of depth 0. Normals point from the first object
  /// to the second, positions lie midway between the surfaces.
  std::size_t collide(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                      const fcl::CollisionRequest<double>& request, fcl::CollisionResult<double>& result);

  [[nodiscard]] std::int64_t answered() const;     ///< pairs
  [[nodiscard]] std::int64_t left_to_fcl() const;  ///< pairs
  /// Why the first of these was left; empty while there is none.
  [[nodiscard]] const std::string& first_reason() const;

 private:
  std::unique_ptr<detail::FclPairs> pairs_;
};

}  // namespace pd
