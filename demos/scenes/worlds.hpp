/// @file
/// Worlds of rigid bodies as plain data: what stands where and how fast it moves. No engine is named here; demos, tests
/// and benches give them to one. Metres, kilograms, seconds; z up.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::scenes {

struct WorldBody {
  enum class Kind { hull, box, cylinder, sphere };
  Kind kind = Kind::hull;
  std::vector<Vec3> points = {};     ///< hull
  Vec3 half_extents = Vec3::Zero();  ///< box; cylinder: (radius, radius, half height), axis z; sphere: (radius, ...)
  double mass = 0;                   ///< 0: it stands still
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vec3 linear_velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
  int colour = 0;     ///< class, for pictures
  bool drawn = true;  ///< false: the floor, which the studio shows itself
};

struct World {
  std::string name;
  std::string title;  ///< a few words for captions
  std::vector<WorldBody> bodies;
  Vec3 gravity{0, 0, -9.81};
  double friction = 0.6;
  double restitution = 0;
  int solver_iterations = 30;  ///< of the contact solver, with two friction directions, for every depth solver
  double steps_per_second = 240;
  int steps = 0;                   ///< how long it is worth watching
  bool should_stand = false;       ///< every move from the start is a fault
  Vec3 view_lower = Vec3::Zero();  ///< what a camera should see
  Vec3 view_upper = Vec3::Zero();
};

/// The eight corners of a box, for engines whose boxes are a special case.
[[nodiscard]] std::vector<Vec3> box_points(const Vec3& half_extents);

/// Two towers of bodies two centimetres wide, boxes (as hulls) and cylinders, each turned a little against the one
/// below: stacks that have to stand.
[[nodiscard]] World small_towers(std::uint64_t seed);

/// A loose pile of small hulls, boxes and cylinders that start up to a third of their size inside each other.
[[nodiscard]] World deep_pile(std::uint64_t seed);

/// Spinning bodies thrown at each other and at a thin wall, faster than one body length a step.
[[nodiscard]] World fast_throws(std::uint64_t seed);

}  // namespace pd::scenes
