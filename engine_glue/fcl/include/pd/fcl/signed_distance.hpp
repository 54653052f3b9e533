/// @file
/// Exact distance and depth of FCL's collision objects. `distance` and `collide` take the arguments of `fcl::distance`
/// and `fcl::collide`.
///
///   pd::FclQueries queries;  // one a thread
///   fcl::DistanceResultd result;
///   const double signed_distance = queries.distance(&a, &b, fcl::DistanceRequestd(), result);
///
/// pdepth answers boxes, spheres, capsules, cylinders, cones, ellipsoids, triangles and convex meshes. FCL answers all
/// others (half-spaces, planes, octrees, triangle meshes) and objects that are no bodies; these pairs are counted.
///
/// Points and normals are in the frame of the world, lengths in the unit of the objects.
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

/// Buffers, converted shapes and counters of one thread. Each geometry is converted once, and its numbers are compared
/// in every call. Results do not depend on earlier calls. An object that was moved from may only be assigned or
/// destroyed.
class FclQueries {
 public:
  FclQueries();
  ~FclQueries();
  FclQueries(FclQueries&&) noexcept;
  FclQueries& operator=(FclQueries&&) noexcept;

  /// The signed distance: above 0 apart, minus the penetration depth where the objects overlap.
  ///
  /// `result` is updated, as by FCL, if the pair is nearer than the one that it holds. The update always sets the
  /// nearest points: the closest points of objects that are apart, or two points whose difference, the second minus the
  /// first, moves the first object out of the second. `request.rel_err` bounds the relative error for curved bodies (0,
  /// NaN and values outside of [0, 1] stand for 1e-6); all else is exact up to rounding, whatever the request allows.
  ///
  /// @return FCL's own answer for pairs that pdepth does not take
  /// Time: that of `penetration_depth`. The first call for a convex mesh builds its hull.
  double distance(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                  const fcl::DistanceRequest<double>& request, fcl::DistanceResult<double>& result);

  /// Adds the contacts of two objects to `result`: none if the objects are apart, else up to four, the deepest first.
  ///
  /// Objects that only touch have a contact of depth 0. Normals point from the first object to the second, positions
  /// lie midway between the surfaces. Costs (`enable_cost`) are computed for pairs alone that FCL answers.
  ///
  /// @return the number of contacts that this call added, at most `request.num_max_contacts`. FCL differs: its function
  /// counts the contacts that `result` held before, for its answer and against the maximum.
  /// Time: that of `penetration_depth` and `contact_manifold`.
  std::size_t collide(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                      const fcl::CollisionRequest<double>& request, fcl::CollisionResult<double>& result);

  [[nodiscard]] std::int64_t answered() const;     ///< pairs
  [[nodiscard]] std::int64_t left_to_fcl() const;  ///< pairs
  /// The reason why the first pair was left to FCL; empty while there is none.
  [[nodiscard]] const std::string& first_reason() const;

 private:
  std::unique_ptr<detail::FclPairs> pairs_;
};

}  // namespace pd
