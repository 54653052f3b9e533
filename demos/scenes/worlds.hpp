/// @file
/// Worlds of rigid bodies as plain data: what stands where and how fast it moves. No engine is named here; demos, tests
/// and benches give them to one. Metres, kilograms, seconds; z up.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::scenes {

struct WorldBody {
  enum class Kind { hull, box, cylinder, sphere, capsule, compound, mesh, heightfield };
  Kind kind = Kind::hull;
  std::vector<Vec3> points = {};  ///< hull; mesh; heightfield: a square grid row by row, y outermost
  /// box; cylinder: (radius, radius, half height), axis z; sphere: (radius, ...); capsule: (radius, radius, half length
  /// of the segment), axis z
  Vec3 half_extents = Vec3::Zero();
  std::vector<std::array<int, 3>> triangles = {};  ///< mesh: counter-clockwise from above
  std::vector<WorldBody> parts = {};               ///< compound: convex bodies, posed in its frame
  double mass = 0;                                 ///< 0: it stands still
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vec3 linear_velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
  std::optional<double> friction = {};  ///< of this body; else the world's
  int colour = 0;                       ///< class, for pictures
  bool drawn = true;                    ///< false: the floor, which the studio shows itself
  /// compound: each part is drawn in a colour of its own. A compound with triangles is drawn as those, without its
  /// parts.
  bool parts_coloured = false;
};

/// Two bodies that share a point.
struct WorldJoint {
  int body_a = 0;
  int body_b = 0;
  Vec3 at = Vec3::Zero();  ///< in the world, at the start
};

struct World {
  std::string name;
  std::string title;  ///< a few words for captions
  std::vector<WorldBody> bodies;
  std::vector<WorldJoint> joints = {};
  Vec3 gravity{0, 0, -9.81};
  double friction = 0.6;
  double restitution = 0;
  int solver_iterations = 30;   ///< of the contact solver, with two friction directions, for every depth solver
  bool solved_at_once = false;  ///< constraints by `StackSolver`, else by Bullet's sequential impulses
  double steps_per_second = 240;
  int steps = 0;              ///< how long it is worth watching
  bool should_stand = false;  ///< every move from the start is a fault
  bool should_glide = false;  ///< the first moving body keeps its speed: a contact that leans against its way is one
  double studio_floor = 0;    ///< height of the floor that pictures show, which no body touches
  Vec3 view_lower = Vec3::Zero();  ///< what a camera should see
  Vec3 view_upper = Vec3::Zero();
  double view_azimuth = -62;  ///< from where, degrees; 0 is along x
  double view_elevation = 16;
};

/// The eight corners of a box, for engines whose boxes are a special case.
[[nodiscard]] std::vector<Vec3> box_points(const Vec3& half_extents);

/// Two towers of bodies two centimetres wide, boxes (as hulls) and cylinders, each turned a little against the one
/// below: stacks that have to stand.
[[nodiscard]] World small_towers(std::uint64_t seed);

/// A tower of twenty boxes of a centimetre at 60 steps a second, solved at once: falls unless contacts hold from the
/// first step on, and unless a load goes through all of it in one step.
[[nodiscard]] World centimetre_tower(std::uint64_t seed);

/// A loose pile of small hulls, boxes and cylinders that start up to a third of their size inside each other.
[[nodiscard]] World deep_pile(std::uint64_t seed);

/// Spinning bodies thrown at each other and at a thin wall, faster than one body length a step.
[[nodiscard]] World fast_throws(std::uint64_t seed);

/// Spinning rods thrown at a wall of one millimetre.
[[nodiscard]] World rods_at_a_foil(std::uint64_t seed);

}  // namespace pd::scenes
