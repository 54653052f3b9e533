/// @file
/// Proves by supports along one direction that a moving body stays apart from what stands still, without a query of
/// their distance. The proofs are those of time_of_impact.hpp; here many triangles share one motion.
///
/// Along a unit direction n the bodies are apart by s(t) = min <p(t), n> - level, p in the moving one and `level` the
/// support of the other. Between two times t0, t1 whose s is known
///
///     s(t) >= min(s(t0), s(t1)) - (t1 - t0)^2 / 8 * c,   c = curvature_bound(body)
///
/// (pd/contact/time_of_impact.hpp says why). A direction may also turn with the moving body, as the six faces of the
/// box about its core do. Then c = omega (2 v + omega D). Here v is the speed of the body's pivot, and D the largest
/// distance of a corner from the pivot. Most triangles under a body that rests, rolls or rocks are told apart in one of
/// these ways, without a query of their distance.
#pragma once

#include <array>

#include "pd/contact/time_of_impact.hpp"

namespace pd {

/// A direction, and how far what stands still comes along it.
struct SupportLevel {
  Vec3 normal;  ///< unit
  double level;
};

/// The corners of a triangle that stands still, in the world, and its margin.
struct StillTriangle {
  std::array<Vec3, 3> corners;
  double margin;
};

/// One motion of a body, for proofs along many directions. Poses are computed once, and supports once for directions of
/// one normal that follow each other.
class StaysApart {
 public:
  /// `body` must outlive the object.
  StaysApart(const MovingShape& body, double duration);

  /// Returns s at the start.
  [[nodiscard]] double at_start(const SupportLevel& direction);
  /// Returns the point of the core that is the first along a direction, in the world, where the motion begins.
  [[nodiscard]] Vec3 first_along(const Vec3& direction) const;
  /// True if s(t) >= least is proved for all of the motion.
  [[nodiscard]] bool proved(const SupportLevel& direction, double least);
  /// Returns the distance of a triangle at the start along the best face of the body's box.
  [[nodiscard]] double beside_at_start(const StillTriangle& triangle);
  /// True if a triangle is proved to stay apart by `least` along one face of the body's box.
  [[nodiscard]] bool proved_beside(const StillTriangle& triangle, double least);

 private:
  using Faces = std::array<double, 6>;

  /// Parts of the duration, at the most.
  static constexpr int kMostParts = 16;

  [[nodiscard]] const Pose& pose(int sixteenths);
  /// Returns min <p, n> over the points p of the body at a share of the duration; -HUGE_VAL for NaN.
  [[nodiscard]] double height(int sixteenths);
  /// Returns the distances of a triangle from the faces of the body's box.
  [[nodiscard]] Faces beside(const StillTriangle& triangle, int sixteenths);
  void turn_to(const Vec3& normal);

  const MovingShape& body_;
  double duration_;
  double bulge_;  ///< below the chord of the whole motion
  Vec3 lower_;    ///< of the box about the shape, in its frame
  Vec3 upper_;
  std::array<Pose, kMostParts + 1> poses_;
  std::array<bool, kMostParts + 1> posed_{};
  Vec3 normal_;
  std::array<double, kMostParts + 1> heights_;  ///< along `normal_`; NaN: not asked for yet
};

}  // namespace pd
