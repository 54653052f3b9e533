/// @file
/// Polytopes inside and around a curved or swept part, by supports: the hull of points of the part, and the
/// intersection of the halfspaces that hold it. Each direction that is looked along narrows the gap between the two
/// there.
#pragma once

#include <optional>
#include <vector>

#include "pd/shape/compound.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd::detail {

class PartBounds {
 public:
  /// Refers to the part's shape. Looks along directions that suit the core, its flat faces among them: some forty, or
  /// fewer if these leave a gap of about `gap` or less between the two polytopes.
  PartBounds(const PosedShape& part, double gap);

  /// Adds the point that is farthest along a unit vector (world axes), and the plane across it, unless one is nearly
  /// parallel to it.
  void look_along(const Vec3& unit);

  /// A polytope that lies in the part, and one that holds it, both in the world; nothing where rounding leaves no such
  /// polytope. A polytope without a margin is both.
  [[nodiscard]] std::optional<Compound::Part> inner() const;
  [[nodiscard]] std::optional<Compound::Part> outer() const;

 private:
  void add_direction(const Vec3& unit);
  void look_along_local(const Vec3& direction);
  void add_point(const Vec3& local_core, const Vec3& unit);
  void sample(const ConvexPolytope& core);
  void sample(const Ellipsoid& core);
  void sample(const Cylinder& core);
  void sample(const Cone& core);
  void sample(const SphereHull& core);

  PosedShape part_;
  double gap_;
  bool exact_;
  Mat3 rotation_;             ///< of the core
  double size_;               ///< of the part: distances from its translation are no larger
  std::vector<Vec3> points_;  ///< of the part, relative to its translation, in world axes; they may err by rounding
  std::vector<Halfspace3> planes_;  ///< the same
};

}  // namespace pd::detail
