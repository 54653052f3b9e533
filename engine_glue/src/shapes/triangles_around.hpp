/// @file
/// The triangles of a mesh around a body, read from the mesh once a pair and step: for the contacts of the body's
/// children, and for what lies round those contacts.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "shapes/each_triangle.hpp"
#include "shapes/rounded_box.hpp"

namespace pd::detail {

/// With an area, in the mesh's frame.
struct MeshTriangle {
  btVector3 corners[3];
  btVector3 lower;  ///< of its box
  btVector3 upper;
  Vec3 across;  ///< (corner 1 - corner 0) x (corner 2 - corner 0)
  int part;     ///< Bullet's numbers for it
  int index;
  /// One number for both, in the order of parts and of a part's triangles.
  [[nodiscard]] std::uint64_t number() const { return number_of(part, index); }
  [[nodiscard]] static std::uint64_t number_of(int part, int index) {
    const auto ordered = [](int of) { return static_cast<std::uint32_t>(of) ^ 0x80000000U; };
    return static_cast<std::uint64_t>(ordered(part)) << 32U | ordered(index);
  }
};

/// How far from a convex body triangles count, in the mesh's frame.
class BodyReach {
 public:
  /// @param pose  of the body in the mesh's frame
  BodyReach(const btConvexShape& body, const btTransform& pose, btScalar reach);
  /// False where the triangle is out of reach for certain.
  [[nodiscard]] bool meets(const MeshTriangle& triangle) const;
  [[nodiscard]] const btVector3& lower() const { return lower_; }
  [[nodiscard]] const btVector3& upper() const { return upper_; }

 private:
  RoundedBox box_;
  btVector3 lower_;
  btVector3 upper_;
  double reach_;
};

/// Returns true if two boxes may have a point in common, and also if a corner is no number.
inline bool boxes_meet(const btVector3& lower_a, const btVector3& upper_a, const btVector3& lower_b,
                       const btVector3& upper_b) {
  return !(lower_a.x() > upper_b.x() || upper_a.x() < lower_b.x() || lower_a.y() > upper_b.y() ||
           upper_a.y() < lower_b.y() || lower_a.z() > upper_b.z() || upper_a.z() < lower_b.z());
}

/// Keeps its memory from step to step.
class TrianglesAround {
 public:
  /// Reads the triangles whose boxes meet a box, but for those without area, which have no surface, and those whose
  /// corners are no numbers.
  /// @return how many of these there were
  int read(const btConcaveShape& mesh, const btVector3& lower, const btVector3& upper);

  /// By Bullet's numbers, so that their order does not depend on the mesh's tree.
  [[nodiscard]] std::span<const MeshTriangle> triangles() const { return triangles_; }
  /// The corners of the same triangles as the core takes them.
  [[nodiscard]] std::span<const std::array<Vec3, 3>> corners() const { return corners_; }
  [[nodiscard]] bool are_of(const btCollisionShape& mesh) const { return mesh_ == &mesh; }
  /// The place of one of them, or their number. Time O(log k), where a host gives each a number of its own.
  [[nodiscard]] std::size_t find(int part, int index, const btVector3* corners) const;
  /// Whether all triangles of this mesh that meet a box are among them.
  [[nodiscard]] bool cover(const btConcaveShape& mesh, const btVector3& lower, const btVector3& upper) const;
  /// Calls `visit(place)` for those of them whose boxes meet a box.
  template <class Visit>
  void for_each_in(const btVector3& lower, const btVector3& upper, const Visit& visit) const {
    const auto offer = [&](std::size_t i) {
      if (boxes_meet(triangles_[i].lower, triangles_[i].upper, lower, upper)) visit(i);
    };
    if (triangles_.size() <= kFew) {
      for (std::size_t i = 0; i < triangles_.size(); ++i) offer(i);
      return;
    }
    for_each_triangle(*mesh_, lower, upper, [&](const btVector3* corners, int part, int index) {
      const std::size_t i = find(part, index, corners);
      if (i < triangles_.size()) offer(i);
    });
  }

 private:
  /// Up to so many triangles are compared one by one; among more, the mesh's tree is asked.
  static constexpr std::size_t kFew = 256;

  const btConcaveShape* mesh_ = nullptr;
  btVector3 lower_;
  btVector3 upper_;
  std::vector<MeshTriangle> triangles_;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<MeshTriangle> read_;                            ///< in the order of the mesh's tree
  std::vector<std::pair<std::uint64_t, std::size_t>> order_;  ///< by Bullet's numbers
};

}  // namespace pd::detail
