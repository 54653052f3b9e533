/// @file
/// From which side a body came to the triangles of a mesh.
///
/// A triangle has no inside: the shortest way off it leads to either side, whichever is nearer. A thin body whose
/// middle has gone through in one step would be pushed on, triangle by triangle to other sides. So a pair remembers,
/// for each triangle that a body stood over or touched in the last step, the side that it was on (its front), and
/// contacts that lead back to the other side are replaced by the way out of the front (`along_front`). A triangle that
/// is new takes after known ones of nearly its direction, where the body meets it near their planes. A body that is
/// pushed out of those comes back to its side so, and is led on until it is out, however slow it is. Where none is
/// known, the way that the body has come since the last step decides. What leaves a triangle over an edge is free
/// again, so that bodies go around the rim of a sheet as ever.
#pragma once

#include <LinearMath/btTransform.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pair/sheet_memory.hpp"
#include "pair/solver_core.hpp"
#include "shapes/met_triangle.hpp"
#include "shapes/triangles_around.hpp"

namespace pd::detail {

/// The sides of one step. Keeps its buffers, and nothing that an answer could depend on.
class SheetSides {
 public:
  void begin(const SheetMemory& memory);
  /// The child that is asked next.
  /// @param pose    in the mesh's frame
  /// @param middle  of the child, in the world
  /// @param way     that its points may come in a step at its present speed, at most
  /// @param reach   up to which gap there are contacts
  void enter(int child, const btTransform& pose, const Pose& mesh, const Vec3& middle, double way, double reach);

  /// Instead of `enter`: no triangle is near the child.
  void pass(int child, const btTransform& pose) { poses_.push_back({child, pose}); }

  /// True if the child may have come through a triangle that is out of reach now.
  [[nodiscard]] bool fast() const { return fast_; }

  /// The front of a triangle, unit and in the mesh's frame, zero: not known.
  /// @param normal  of the triangle, unit and in the mesh's frame
  [[nodiscard]] Vec3 front_of(std::uint64_t triangle, const Vec3& normal) const;
  /// Where the child's middle was in the last step, as far as it is known, else where it is. In the mesh's frame.
  [[nodiscard]] const Vec3& middle_before() const { return before_; }

  /// The triangles that the child is asked about: they have these places among all that were read, in their order.
  struct Around {
    std::span<const MetTriangle> met;
    std::span<const std::size_t> places;
    const TrianglesAround& read;
  };
  /// @param normal  of the triangle, unit and in the mesh's frame
  /// @return the triangle's front, unit and in the world, where the answer leads to its back; else zero
  Vec3 judge(const MetTriangle& met, const Vec3& normal, const Around& around, const PairAnswer& answer);
  /// The child is in front of a triangle.
  void keep(std::uint64_t triangle, const Vec3& front, const Vec3& corner) {
    fresh_.push_back({triangle, front, front.dot(corner)});
  }
  /// True if a contact with the triangle that was judged last leads off it to its back: one that was turned to another
  /// facet may.
  /// @param normal  of the contact, in the world
  [[nodiscard]] bool leads_back(const Vec3& normal) const { return normal.dot(front_) < 0; }
  /// The front of that triangle, unit and in the world; zero: not known.
  [[nodiscard]] const Vec3& front() const { return front_; }
  /// The child is to be led so far to the front of a triangle.
  void lead(double depth) { behind_ = std::max(behind_, depth); }

  /// Puts what was kept in place of what was known.
  void end(SheetMemory& memory);

 private:
  /// The front of a triangle that lies beside known ones. @param place  on the triangle, where the child meets it
  [[nodiscard]] Vec3 beside(std::span<const KnownFront> fronts, const Vec3& normal, const Vec3& place) const;
  /// Where a material point of the child was in the last step, in the mesh's frame.
  [[nodiscard]] Vec3 before(const Vec3& place) const;

  /// True if the child's middle was on the other side of a triangle that it was over or under and that has nearly this
  /// side. A plane goes on beyond its triangles.
  bool was_behind_one(const Vec3& side, std::span<const MetTriangle> met);

  const SheetMemory* memory_ = nullptr;
  std::vector<KnownFront> fresh_;
  std::vector<SheetMemory::LastPose> poses_;
  std::size_t first_of_child_ = 0;  ///< among `fresh_`
  int child_ = -1;                  ///< the one that is asked
  bool known_ = false;              ///< where the child was
  bool fast_ = false;
  double reach_ = 0;
  double behind_ = 0;
  Vec3 front_ = Vec3::Zero();  ///< of the triangle that was judged last, in the world
  Pose mesh_;
  btTransform pose_, last_pose_;
  Vec3 before_ = Vec3::Zero();
  bool looked_around_ = false;
  std::vector<Vec3> towards_middle_;  ///< sides of the triangles that the child's middle was over or under
};

}  // namespace pd::detail
