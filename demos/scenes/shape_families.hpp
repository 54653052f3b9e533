/// @file
/// Families of convex bodies, and pairs of them at a wanted depth: the same numbers for the demos, the tests and the
/// benches.
///
/// Everything is a function of its parameters and a seed. No distribution of the standard library and no transcendental
/// function is used (their bits differ between libraries): only +, -, *, /, sqrt, which are correctly rounded
/// everywhere. No two operands and no two arguments in parentheses draw from a generator: compilers differ in which
/// they evaluate first. What stands in braces is evaluated in its order.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"

namespace pd::scenes {

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// In [0, 1), a multiple of 2^-53.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [low, high], both included.
  int integer(int low, int high);
  /// Each coordinate in [low, high), z drawn first.
  Vec3 point(double low, double high);
  /// Each coordinate an integer of [low, high], z drawn first.
  Vec3 integer_point(int low, int high);
  /// On the unit sphere.
  Vec3 direction();
  /// A direction, and then its length in [shortest, longest].
  Vec3 vector(double shortest, double longest);
  /// A random rotation, unit up to rounding.
  std::array<double, 4> quaternion();
  /// A random rotation with this translation.
  Pose pose(const Vec3& translation);

 private:
  std::uint64_t state_;
};

using Points = std::vector<Vec3>;

/// sin and cos of a turn (1 = a whole circle), to 1e-15; the same bits everywhere.
struct Turn {
  double sine;
  double cosine;
};
[[nodiscard]] Turn turn(double fraction);

/// The eight corners, numbered by the bits of (x, y, z) > 0.
[[nodiscard]] Points box(const Vec3& half_extents);
/// n points on the unit sphere.
[[nodiscard]] Points sphere_hull(int n, Random& random);
/// n points on an ellipsoid with semi-axes 1, 0.01, 0.01.
[[nodiscard]] Points needle(int n, Random& random);
/// Prism over a regular polygon with n / 2 corners, n >= 6: radius 1, half height 0.5.
[[nodiscard]] Points prism(int n);
/// Lens-shaped profile of n / 2 corners in the plane y = 0 (two arcs of slopes up to `eta`), extruded to |y| <= 1.
/// Two of them crossed at right angles have about (n / 2)^2 edge-edge facets: the lens grid.
[[nodiscard]] Points lens(int n, double eta);

struct RoofShape {
  double eta = 0.5;     ///< slopes of the profile run over [-eta, eta]
  double jitter = 0.2;  ///< radial noise, in units of (slope step)^2
  double tilt = 0;      ///< noise of the far ends in x and z, in units of the slope step
};
/// Round-patch construction: the upper profile is an arc of a circle of radius 1 about the origin, extruded along y,
/// its far ends tapered and closed by apexes; the bottom is a ridge far below. n >= 10 vertices. Two of them, one
/// upside down and turned by a right angle, have (n / 2)^2 / 4 to n^2 / 2 facets whose distances are all nearly tied.
[[nodiscard]] Points roof(int n, const RoofShape& shape, Random& random);

/// n points of a random cloud pressed to the given thickness.
[[nodiscard]] Points sliver(int n, double thickness, Random& random);
/// A planar polygon with at most n corners in a random plane through the origin.
[[nodiscard]] Points polygon(int n, Random& random);
/// n points, of which many coincide, lie on common lines and planes, or inside.
[[nodiscard]] Points cloud(int n, Random& random);
/// n integer points in [-range, range]^3.
[[nodiscard]] Points integer_points(int n, int range, Random& random);

enum class PairFamily : std::uint8_t {
  box,
  cubes,
  sphere,
  needle,
  prism,
  grid,
  patch,
  roofs,
  tilted_roofs,
  slivers,
  polygons,
  segments,
  points,
  clouds,
  near_aligned_boxes,
  parallel_edges,
  kissing,
  near_kissing,
  equal_bodies,
  integer_grid,
  scales,
  far_translations,
  single_precision,
  mixed_scales,
  ulp_noise,
  near_equal_bodies,
};
inline constexpr int kPairFamilies = 26;
[[nodiscard]] std::string_view to_string(PairFamily family);

/// How deep the pair stands: apart by 1 % of the size, overlapping by at most 1 % or 10 % of it, or with centres that
/// nearly coincide. Families with a placement of their own (kissing, equal bodies, grids of integers) use it as they
/// can.
enum class DepthClass : std::uint8_t { gap, shallow, mid, deep };
inline constexpr int kDepthClasses = 4;
[[nodiscard]] std::string_view to_string(DepthClass depth);

struct PointPair {
  Points a;
  Points b;
  Pose pose_a;
  Pose pose_b;
};

/// A pair of the family with about n vertices on each side (families of fixed size take what they have).
[[nodiscard]] PointPair make_pair(PairFamily family, int n, DepthClass depth, std::uint64_t seed);

}  // namespace pd::scenes
