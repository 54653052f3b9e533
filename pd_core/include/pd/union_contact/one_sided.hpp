/// @file
/// Meshes may be surfaces of solids: a body then leaves a triangle by its front.
///
/// The shortest way off a sheet leads to either side. For a solid's surface the way backward is none: it leads on into
/// the solid. A contact that leads backward is dropped. If the body stands through or behind the triangle, the contact
/// is along the front instead, unless another triangle's contact leads off this one anyway. So a box that lies too deep
/// on a kerb leaves upward, and not through the wall of the kerb behind it.
#pragma once

#include <vector>

#include "pd/depth/depth_answer.hpp"

namespace pd {

/// The contacts of one body A with the triangles of a mesh B. Vectors are in the world, lengths in the unit of the
/// input.
class OneSided {
 public:
  /// Forgets all contacts.
  void clear();

  /// Takes the answer about a body A and triangle number `triangle`, whose front is `front` (unit, in the world).
  /// @return true if the answer's own contact may count; its way is added by the caller. Time O(1).
  bool admit(const PenetrationDepth& answer, const Vec3& front, int triangle);

  /// Takes note that the body stands through or behind a triangle that it is to leave by its front (unit).
  void add_behind(int triangle, const Vec3& front) { behind_.push_back({triangle, front}); }

  /// Takes a contact with the front of a triangle that was found another way: it ends by this translation of A.
  void add_way(const Vec3& way) { ways_.push_back(way); }

  /// Takes the way of an answer that counts.
  void add_way_of(const PenetrationDepth& answer) {
    if (answer.contact == ContactClass::overlapping) add_way(answer.depth * answer.normal);
  }

  /// A triangle that the body stands through, and its front.
  struct Behind {
    int triangle;
    Vec3 front;
  };
  /// Returns the triangles that the body stands through and would leave by the back.
  [[nodiscard]] const std::vector<Behind>& behind() const { return behind_; }

  /// Returns translations of A by which the contacts that count end, longest first, at most four; shorter ones are
  /// dropped. Time O(k log k) in k contacts.
  [[nodiscard]] const std::vector<Vec3>& ways_out();

 private:
  std::vector<Behind> behind_;
  std::vector<Vec3> ways_;
};

}  // namespace pd
