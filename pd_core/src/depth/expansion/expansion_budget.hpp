/// @file
/// When an expanding polytope had better be given up: where it shows that P has far more facets nearly as near as the
/// nearest one than its bodies have vertices.
///
/// What tells the two apart. Let g be the relative gap between the nearest face and the least height of a support so
/// far. Where P has about N facets, N the vertices of both bodies, spread over all directions, its facets differ in
/// distance by some 20 / N to 60 / N of it (measured on hulls of 128 to 2048 random points on spheres), and when g is
/// below 1 / N only a few faces are left below that height. P with some N^2 facets on a patch (crossed roofs, the
/// families of [A] section 2 where K is quadratic) passes that mark with all of the patch still below, and each step
/// adds two faces more. So an expansion is given up where g < 1 / N, many faces lie below, and steps add to them;
/// and where after many steps all faces are below still.
///
/// A fixed budget cannot do that: random hulls of 2048 vertices need 400 steps of .35 us and are done then, roofs of
/// 128 need 660 for what takes others (near_facets.hpp) the time of 100.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

class ExpansionBudget {
 public:
  /// @param vertices  N; 0 for bodies of unlimited vertices: never given up.
  explicit ExpansionBudget(int vertices) : vertices_(vertices) {}

  /// Whether to give up after a step that found a support at `height` in the normal of the nearest face, at `distance`.
  /// Costs a comparison but for every 16th step, and then half a nanosecond a face.
  bool exhausted(int step, double distance, double height, const InnerSurface& surface) {
    lowest_ = std::min(lowest_, height);
    return step % kEvery == 0 && step > 0 && vertices_ > 0 && many_facets_tie(step, distance, surface);
  }

  /// In so many steps faces of hulls of random points have come to lie above the least height; of evenly spread ones,
  /// all of whose facets are nearly tied, none has.
  static int min_steps(int vertices) { return 64 + 4 * static_cast<int>(std::sqrt(static_cast<double>(vertices))); }
  /// More steps than these are left to the overlay, which needs no more than some 4 times their time then.
  static int max_steps(int vertices) { return std::max(min_steps(vertices), 64 + vertices / 4); }

 private:
  static constexpr int kEvery = 16;
  /// Faces below that the expansion may well be done with: about as many steps are left then, and small bodies run out
  /// of vertices.
  [[nodiscard]] int face_threshold() const { return 40 + 4096 / vertices_; }

  bool many_facets_tie(int step, double distance, const InnerSurface& surface) {
    const int before = below_;
    below_ = 0;
    if (!(distance > 0)) return false;
    const double level = lowest_ * lowest_;
    for (int f = 0; f < surface.slots(); ++f) below_ += surface.key(f) < level;
    if (step >= min_steps(vertices_) && 32 * below_ >= 31 * surface.size()) return true;
    return below_ > face_threshold() && below_ >= before + kEvery && (lowest_ - distance) * vertices_ < distance;
  }

  int vertices_;
  int below_ = std::numeric_limits<int>::max() / 2;  ///< at the last check; the first one decides nothing
  double lowest_ = std::numeric_limits<double>::infinity();
};

/// Steps of an expansion for Bracket::contact, counted and never timed: a query costs what it costs on any machine.
struct ContactBudget {
  /// Steps that go for the bracket asked for; after them a thousandth of the depth is enough (`kContactClose`). Most
  /// pairs need a tenth of them.
  static constexpr int kStepsToFull = 128;
  /// Then the search ends with the bracket that it has. .25 to .35 us a step. Two balls of a thousand vertices each
  /// need some 350 for a thousandth, whatever order their supports come in: so many facets of P are as near as that.
  static int max_steps(int vertices) { return std::max(kStepsToFull, 64 + vertices / 8); }
  /// Curved bodies, about .2 us a step.
  static constexpr int kCurvedStepsToFull = 64;
  static constexpr int kCurvedSteps = 128;
  /// Of them, on an exact hull, where the surface in doubles has folded again and again: up to 2 us each.
  static constexpr int kExactSteps = 24;
  /// Of the closest points of curved bodies in double-double, as far apart as rounding: up to .7 us each.
  static constexpr int kDoubleDoubleSteps = 40;
};

}  // namespace pd::detail
