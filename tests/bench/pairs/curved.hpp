/// @file
/// Curved bodies in each other, from frame to frame and from nothing.
///
/// Bodies of radii .5 to 1 that overlap by .01 or .1 along a random line of centres, and small bodies anywhere inside
/// balls, near-balls, cones and cylinders, a quarter of them in the very middle, where all directions are tied. Every
/// number is one of single precision, so that all solvers receive the same bodies.
#pragma once

#include "bench/pairs/standing.hpp"

namespace pd::bench {

enum class CurvedPair : std::uint8_t {
  sphere_sphere,
  capsule_capsule,
  capsule_box,
  cylinder_box,
  cone_hull,
  ellipsoid_ellipsoid,
  ball_small,        ///< an ellipsoid of equal radii round any small body but cylinders and cones
  near_ball_small,   ///< of radii within 1.001
  tenth_ball_small,  ///< of radii within 1.1
  ball_cylinder,     ///< a small cylinder in a ball
  ball_cone,
  cylinder_sphere,  ///< a small sphere in a cylinder
  cone_sphere,
  spheres_box,      ///< the hull of three spheres
  spheres_spheres,  ///< of three and four
};
[[nodiscard]] std::string_view to_string(CurvedPair pair);

struct CurvedCell {
  CurvedPair pair;
  double depth;  ///< 0: anywhere inside
};

/// The cells of `families` (empty = all). An unknown name is an Error.
[[nodiscard]] Expected<std::vector<CurvedCell>> choose_curved(const std::vector<std::string>& families);

[[nodiscard]] Bodies curved_bodies(CurvedPair pair, scenes::Random& random);

/// Nothing where the bodies are too small for the depth.
[[nodiscard]] std::vector<Standing> frames_inside(const Bodies& bodies, double depth, int count,
                                                  scenes::Random& random);

/// Right: a depth within kTolerance of the least height of the difference, after which no more overlap is left. That
/// height is the least of a sweep of directions refined in long double (oracle/curved_oracle.hpp) and of the one along
/// our own normal, which the sweep may miss by little: each is an upper bound by itself.
class CurvedJudge {
 public:
  explicit CurvedJudge(const Bodies& bodies) : bodies_(bodies) {}
  [[nodiscard]] double depth(const Standing& at) const;
  [[nodiscard]] double error(const Answer& answer, const Standing& at, double truth) const;

 private:
  const Bodies& bodies_;
};

struct CurvedSettings {
  std::vector<CurvedCell> cells;
  int pairs = 24;
  std::uint64_t seed = 0;
};

/// All cells, printed as they come. The ratios are to Bullet's EPA.
[[nodiscard]] std::vector<Row> run_curved(const CurvedSettings& settings, Solvers& solvers);

}  // namespace pd::bench
