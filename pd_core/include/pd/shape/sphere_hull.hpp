/// @file
/// The convex hull of spheres, as a core: {c_i, r_i} has the support function h(d) = max_i (<c_i, d> + r_i |d|).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd {

struct Sphere {
  Vec3 centre;
  double radius;  ///< >= 0; 0 is a point
};

/// Two spheres or more, one of radius 0: the least radius of a hull of spheres is its margin. Made by
/// ConvexShape::hull_of_spheres. Immutable, cheap to copy.
class SphereHull {
 public:
  /// In lexicographic order of (x, y, z, radius).
  [[nodiscard]] std::span<const Sphere> spheres() const { return *spheres_; }
  /// A point farthest along the direction (any length; a zero direction gives some point). Time O(spheres).
  [[nodiscard]] Vec3 support(const Vec3& direction) const;

  /// Bit for bit the same spheres.
  friend bool operator==(const SphereHull& x, const SphereHull& y);

 private:
  friend class ConvexShape;
  explicit SphereHull(std::vector<Sphere> spheres)
      : spheres_(std::make_shared<const std::vector<Sphere>>(std::move(spheres))) {}

  std::shared_ptr<const std::vector<Sphere>> spheres_;
};

}  // namespace pd
