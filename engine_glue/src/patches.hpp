/// @file
/// The contact points of many pieces, sorted by normal into patches, and four of each patch chosen.
#pragma once

#include <array>
#include <vector>

#include "manifold_points.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

/// At most four points of about one normal, and which piece each came from.
struct Patch {
  FreshPoints fresh;
  std::array<int, 4> pieces{};
  Vec3 normal = Vec3::UnitX();  ///< of its deepest point
  bool claimed = false;
};

class Patches {
 public:
  void clear();
  /// @param piece  handed back with the point
  /// @param i, j  numbers of the piece that do not change from step to step: features are told apart by them
  void add(const ContactManifold& manifold, int piece, int i, int j);

  /// Drops the points whose normals are more than 60 degrees off `normal`.
  void keep_along(const Vec3& normal);

  /// Sorts the points, deepest first, into at most `most` patches of normals no farther apart than 25 degrees (the
  /// last ones take what fits nowhere), drops those that coincide, and keeps four of each patch: the deepest, the
  /// farthest from it, and those that span the largest triangles with these two, one to each side. Of points that are
  /// as deep up to the noise of a resting contact (a thousandth of the breaking threshold) the first is the farthest
  /// out in a fixed direction, so that the choice is the same from step to step. O(p (q + log p)), p points, q patches.
  void choose(int most, double breaking_threshold);

  [[nodiscard]] const Patch& operator[](int i) const { return patches_[static_cast<std::size_t>(i)]; }
  /// The unclaimed patch nearest to a normal, within 25 degrees; -1 where there is none. It counts as claimed then.
  int claim(const Vec3& normal);
  /// The first unclaimed patch.
  int claim_any();

 private:
  struct Point {
    Vec3 normal;
    ContactPoint contact;
    int piece;
    int patch;
  };
  /// A point by how far it lies in some direction.
  struct Place {
    double along;
    std::size_t point;
    bool kept;
  };
  void choose_in(int patch, double breaking_threshold);
  /// Into `left_`: of points of the patch that lie within `merge` of each other the deepest. O(p log p).
  void keep_one_of_each(int patch, double merge);

  std::vector<Point> points_;
  std::vector<Patch> patches_;
  std::vector<const Point*> left_;
  std::vector<Place> places_;
  std::vector<std::size_t> ranks_;
};

}  // namespace pd::detail
