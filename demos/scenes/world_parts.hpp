/// @file
/// The bodies that worlds are made of.
#pragma once

#include <functional>

#include "scenes/contact_worlds.hpp"

namespace pd::scenes {

/// The same numbers on every platform (the standard's distributions are not).
class Stream {
 public:
  explicit Stream(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ULL + 0x2545F4914F6CDD1DULL) {}
  /// In [-1, 1).
  double next();
  Vec3 vector();
  /// (x, y, 0), y drawn first.
  Vec3 level_vector();
  Vec3 direction();
  Eigen::Quaterniond orientation();

 private:
  std::uint64_t state_;
};

inline constexpr double kDensity = 700;  ///< kg/m^3: wood

/// A fixed box whose upper face is z = 0, `extent` to each side.
[[nodiscard]] WorldBody ground_box(double extent);
[[nodiscard]] WorldBody box(const Vec3& half_extents, const Vec3& at);
[[nodiscard]] WorldBody cylinder(double radius, double half_height, const Vec3& at);
[[nodiscard]] WorldBody sphere(double radius, const Vec3& at);
[[nodiscard]] WorldBody capsule(double radius, double half_length, const Vec3& at, double mass);
/// A rough stone: points on an ellipsoid's surface.
[[nodiscard]] WorldBody stone(Stream& random, double radius, int points, const Vec3& at);
/// The graph z = height(x, y) over [-extent, extent]^2, fixed, `cells` to a side: a mesh or a heightfield.
[[nodiscard]] WorldBody graph_mesh(double extent, int cells, const std::function<double(double, double)>& height,
                                   bool heightfield);
[[nodiscard]] WorldBody flat_mesh(double extent, int cells, bool heightfield);

/// Moves every body that can move by up to 1e-6 of the scene's size; `seed` 0: nothing.
void perturb(ContactScene& scene, std::uint64_t seed);

}  // namespace pd::scenes
