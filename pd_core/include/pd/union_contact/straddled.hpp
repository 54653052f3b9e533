/// @file
/// Triangles that a body of several pieces stands through, while each piece's way off them leads into another piece.
///
/// A piece's contact is dropped where its siblings cover it (covered_contact.hpp). A body of two flush boxes with a
/// sheet near their seam, or as deep in one box as no exit of that box reaches, is so left without any contact. Its way
/// out then is that of the whole: off each such triangle to the side that the body's middle is on (`along_front`).
#pragma once

#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/union_contact/patches.hpp"

namespace pd {

/// The contacts of one body A of several pieces with a mesh B that were dropped.
class StraddledTriangles {
 public:
  /// A piece of A and a triangle of B, by the numbers that were handed in.
  struct Dropped {
    int piece;
    int triangle;
  };

  /// Forgets all contacts.
  void clear() { dropped_.clear(); }

  /// Takes the depth of a piece and a triangle (negative: a gap), and what the rule for covered contacts left of their
  /// points. Time O(1).
  void note(const Dropped& pair, double depth, const ContactManifold& left) {
    if (left.count == 0 && depth >= 0) dropped_.push_back(pair);
  }

  /// Returns the pairs that need the way out of the whole: all that were dropped if no other contact overlaps, else
  /// none. Time O(p) in the points of `patches`.
  [[nodiscard]] const std::vector<Dropped>& need_way_out(const Patches& patches) {
    if (patches.overlap()) dropped_.clear();
    return dropped_;
  }

 private:
  std::vector<Dropped> dropped_;
};

/// Returns the side of a triangle that the middle of a body is on, or `normal` if the middle lies in its plane.
/// @param normal  of the triangle, unit
/// @param corner  of the triangle; all three in one frame
[[nodiscard]] inline Vec3 side_towards(const Vec3& middle, const Vec3& normal, const Vec3& corner) {
  return normal.dot(middle - corner) < 0 ? Vec3(-normal) : normal;
}

}  // namespace pd
