/// @file
/// A solid and a convex shape, which may be curved or swept: the class, the nearest triangle, and the shape as the body
/// that stays in a cover of translations.
///
/// The core answers exactly about each of the solid's triangles and the shape. The shape's interior meets the solid if
/// it meets the surface, or if one of its points lies in the solid. So the class is as exact as that of a triangle and
/// the shape.
#pragma once

#include <memory>
#include <optional>

#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid/translation_cover.hpp"

namespace pd::detail {

class ShapeBeside final : public StandingBody {
 public:
  /// Refers to all of them. @return out_of_range for poses too far apart; not_full_dimensional for a flat shape.
  static Expected<std::unique_ptr<ShapeBeside>> place(const PosedSolid& a, const PosedShape& b, Scratch& scratch);

  struct Found {
    ContactClass contact = ContactClass::separated;
    /// The triangle that tells the class, or the nearest one; -1 where the shape lies inside or none is near.
    std::int32_t triangle = -1;
    PenetrationDepth answer;     ///< about that triangle
    double distance_lower = 0;   ///< of all triangles
    std::int64_t triangles = 0;  ///< that were asked
  };
  /// @param pose_a  where A stands, and `way`, how far from its place (both outside lengths)
  /// @param beyond  triangles farther away need no answer
  [[nodiscard]] Found meet(const Pose& pose_a, const Vec3& way, double beyond);

  [[nodiscard]] const PosedSolids& solids() const { return *solids_; }

  [[nodiscard]] SurfaceDepth depth_at(const Vec3& x) override;
  [[nodiscard]] SurfaceDepth depth_at(const Vec3& x, const SurfaceDepth& near, double moved) override;
  [[nodiscard]] std::vector<Vec3> landmarks() const override;
  [[nodiscard]] Meeting meeting_after(const Vec3& way) override;

 private:
  ShapeBeside(const PosedSolid& a, const PosedShape& b, Scratch& scratch) : a_(a), b_(b), scratch_(scratch) {}
  std::optional<Error> arrange();

  [[nodiscard]] const TriangleNode& node(std::int32_t at) const {
    return a_.solid->nodes()[static_cast<std::size_t>(at)];
  }
  /// The core's answer about a point (inside lengths) and the shape; the points of bodies are of no use.
  [[nodiscard]] PenetrationDepth answer_at(const Vec3& x, double beyond);
  /// At least the distance of a node's box, A moved by the way, as far as it is less than `beyond` (outside lengths).
  [[nodiscard]] double gap(std::int32_t at, const Vec3& way, double beyond);
  void visit(std::int32_t at, double least, const Pose& pose_a, const Vec3& way, Found& found);
  void test(std::int32_t triangle, const Pose& pose_a, Found& found);
  [[nodiscard]] bool lies_inside(const Vec3& way) const;

  const PosedSolid& a_;
  const PosedShape& b_;
  Scratch& scratch_;
  Pose near_b_;                        ///< B's, relative to A's origin
  Vec3 inner_ = Vec3::Zero();          ///< a point of the shape's interior, in its own frame
  std::optional<MeshSolid> box_;       ///< around the shape, in its own frame
  std::optional<MeshSolid> corner_;    ///< a solid of which `inner_` is a vertex
  std::int32_t corner_vertex_ = -1;    ///< its index
  std::optional<PosedSolids> solids_;  ///< A and the box
  double slack_ = 0;                   ///< at most the error of a point's distance, an outside length
  double nearest_ = 0;                 ///< while triangles are looked at: farther ones need no answer
};

}  // namespace pd::detail
