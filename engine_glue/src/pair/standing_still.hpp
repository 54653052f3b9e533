/// @file
/// Which triangles of a mesh a body that has hardly moved is asked about again.
///
/// A body at rest meets the same triangles in each step, of which four a direction make its points. As long as it has
/// moved by less than a small share of the distance up to which contacts reach since all triangles around it were
/// asked, only those that made points then are asked again: their depths, normals and points are those of the step.
/// What another triangle would have said is late by that share at the most (`kHardly`). The mesh is read in each step
/// all the same, so that a triangle that was edited or has come is seen, and asked.
#pragma once

#include <LinearMath/btTransform.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shapes/cached_shape.hpp"
#include "shapes/triangles_around.hpp"

namespace pd::detail {

/// Of a child of the body, or the body itself, as all triangles were asked about it.
struct StandingChild {
  int index;
  btTransform pose;  ///< in the mesh's frame
  std::shared_ptr<CachedShape> shape;
};

class StandingStill {
 public:
  /// What a triangle was to a child.
  enum class Met : std::uint8_t {
    out_of_reach,
    within_reach,
    with_points,
  };

  [[nodiscard]] bool empty() const { return threshold_ < 0; }
  void forget() { threshold_ = -1; }

  /// Whether these are the children that stood there, with contacts up to the same gap of a mesh of the same margin,
  /// none of them moved since by more than a small share of the gap.
  /// @param radii  of the children, about their frames' origins
  [[nodiscard]] bool still(std::span<const StandingChild> children, std::span<const double> radii, btScalar threshold,
                           btScalar margin) const;

  /// In place of what was known: none of the triangles is within reach of any child.
  void begin(std::span<const StandingChild> children, btScalar threshold, btScalar margin,
             std::span<const MeshTriangle> triangles);
  /// The place of each of these triangles among those that were known, -1: it was edited or is new. Time O(k).
  void find(std::span<const MeshTriangle> triangles, std::vector<int>& places) const;

  [[nodiscard]] Met met(std::size_t child, std::size_t triangle) const {
    return met_[child * known_.size() + triangle];
  }
  void set(std::size_t child, std::size_t triangle, Met met) { met_[child * known_.size() + triangle] = met; }
  /// Whether the child stood on flat ground (flat_ground.hpp), which asks all triangles at once.
  [[nodiscard]] bool flat(std::size_t child) const { return flat_[child] != 0; }
  void set_flat(std::size_t child) { flat_[child] = 1; }

 private:
  /// A triangle, in the order of `TrianglesAround`.
  struct Known {
    std::uint64_t number;
    std::array<btScalar, 9> corners;
  };
  static Known known(const MeshTriangle& triangle);

  btScalar threshold_ = -1;
  btScalar margin_ = 0;
  std::vector<StandingChild> children_;
  std::vector<Known> known_;
  std::vector<Met> met_;  ///< of each child all triangles
  std::vector<std::uint8_t> flat_;
};

}  // namespace pd::detail
