/// @file
/// The contact points of many pieces are sorted by normal into patches, and four points of each patch are chosen.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "pd/contact/manifold.hpp"

namespace pd {

/// A contact point among those of many pieces.
struct PatchPoint {
  Vec3 normal = Vec3::UnitX();  ///< unit, from B to A
  ContactPoint contact;
  int piece = -1;  ///< handed to `Patches::add`
};

/// At most four points of about one normal; none if all points fit another patch better.
struct Patch {
  std::array<PatchPoint, 4> points;
  int count = 0;
  Vec3 normal = Vec3::UnitX();  ///< of its deepest point, or of the patch of the last step that goes on in it
  int last = -1;                ///< number of that patch; -1: it is new
};

/// A patch of the last step where the bodies are now.
struct LastPatch {
  Vec3 normal = Vec3::UnitX();  ///< the mean of its points'
  std::array<Vec3, 4> places;   ///< of its points, on B
  int count = 0;
};

/// The points of one step and the patches chosen of them. Points are in the world, lengths in the unit of the input.
class Patches {
 public:
  /// Forgets points and patches.
  void clear();
  /// Adds the points of a manifold.
  /// @param piece  handed back with the point
  /// @param i, j  numbers of the piece that do not change from step to step: features are told apart by them
  void add(const ContactManifold& manifold, int piece, int i, int j);

  /// True if no points were added.
  [[nodiscard]] bool empty() const { return points_.empty(); }
  /// True if a point has a depth above 0. Time O(p) in p points.
  [[nodiscard]] bool overlap() const;
  /// Drops the points whose normals are more than 60 degrees off `normal`, and those deeper than `deepest`.
  void keep_along(const Vec3& normal, double deepest = std::numeric_limits<double>::infinity());

  /// Sorts the points, deepest first, into at most `most` patches of normals no farther apart than 25 degrees; the last
  /// ones take the points that fit nowhere. Points that coincide are one. Four points of each patch are kept: the
  /// deepest, the farthest from it, and those that span the largest triangles with these two, one to each side.
  ///
  /// The choice is the same from step to step as far as possible, since a point that is new has no impulse yet. Patches
  /// of the last step go on where points are left for them, and points of the last step count as a tenth farther out.
  /// Depths that differ by the noise of a resting contact (a thousandth of the breaking threshold) are one depth. Of
  /// such points the first is one of the last step, or else the farthest out in a fixed direction.
  ///
  /// In a valley that is less steep than a patch is wide, two points of a corner push, each to its side. One of them
  /// alone moves the body until the other one is the deeper, and back in the next step. So a point that touches within
  /// the breaking threshold of a chosen point, along a normal more than three degrees off, gets a patch of its own.
  /// Time O(p (q + log p)) in p points and q patches. Chosen again with the same `last`, the patches are the same.
  /// @param last  of the last step, at most `most`
  void choose(int most, double breaking_threshold, std::span<const LastPatch> last);

  [[nodiscard]] int size() const { return static_cast<int>(patches_.size()); }
  [[nodiscard]] const Patch& operator[](int i) const { return patches_[static_cast<std::size_t>(i)]; }

 private:
  struct Point : PatchPoint {
    int patch = -1;
    bool lasting = false;  ///< it stands where the patch had a point in the last step
  };
  /// A point by how far it lies in some direction.
  struct Place {
    double along;
    std::size_t point;
    bool kept;
  };
  static void add(const PatchPoint& point, Patch& patch);
  /// Takes over the patches of the last step that some point belongs to.
  void go_on(std::span<const LastPatch> last);
  /// Sorts the points, the deepest first. Equally deep points keep the order in which they were added.
  void sort_by_depth();
  void choose_in(int patch, double breaking_threshold, std::span<const LastPatch> last);
  /// Finds points among those left that touch and push another way than the points chosen beside them.
  void find_twins(double breaking_threshold);
  /// Adds the twins as patches of their own.
  void add_twins(int most, std::span<const LastPatch> last);
  /// Fills `left_` with the deepest of the patch's points that lie within `merge` of each other. O(p log p).
  void keep_one_of_each(int patch, double merge);

  std::vector<Point> points_;
  std::vector<Point> sorted_;
  std::vector<std::pair<double, std::size_t>> by_depth_;
  std::vector<Patch> patches_;
  std::vector<const Point*> left_;
  std::vector<const Point*> chosen_;  ///< of the patch at hand
  std::vector<Patch> twins_;
  std::vector<Place> places_;
  std::vector<std::size_t> ranks_;
};

}  // namespace pd
