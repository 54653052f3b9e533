/// @file
/// Meshes as surfaces of solids (`BulletSolverSettings::one_sided_meshes`): a body leaves a triangle by its front.
///
/// The shortest way off a sheet leads to either side. For a solid's surface the way backward is none: it leads on into
/// the solid. What leads backward is dropped where the body is apart from the triangle, or leaves it over an edge
/// (which is its neighbour's to answer); where it leads through the back, the contact is along the front instead,
/// unless another triangle's contact leads off this one anyway: a box that lies too deep on a kerb leaves upward, not
/// through the kerb's wall that it has behind it, too.
#pragma once

#include <vector>

#include "pair/solver_core.hpp"

namespace pd::detail {

class OneSided {
 public:
  void clear();

  /// Of the answer about a body A and triangle number `triangle`, whose front is `front` (unit, in the world).
  /// @return whether the answer's own contact counts
  bool admit(const PairAnswer& answer, const Vec3& front, int triangle);

  /// The body stands through or behind a triangle that it is to leave by its front.
  void add_behind(int triangle, const Vec3& front) { behind_.push_back({triangle, front}); }

  /// Of a contact with the front of a triangle, found another way: by this translation of A it ends.
  void add_way(const Vec3& way) { ways_.push_back(way); }

  /// The same of an answer that counts.
  void add_way_of(const PairAnswer& answer) {
    if (answer.depth.contact == ContactClass::overlapping) add_way(answer.depth.depth * answer.depth.normal);
  }

  struct Behind {
    int triangle;
    Vec3 front;
  };
  /// The triangles that the body stands through and would leave by the back.
  [[nodiscard]] const std::vector<Behind>& behind() const { return behind_; }

  /// Translations of A by which the contacts that count end, longest first, at most four.
  [[nodiscard]] const std::vector<Vec3>& ways_out();

 private:
  std::vector<Behind> behind_;
  std::vector<Vec3> ways_;
};

}  // namespace pd::detail
