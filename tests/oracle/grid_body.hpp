/// @file
/// Hulls of few points on a small integer grid, by brute force in whole numbers: what the grid oracle knows of a body.
///
/// Nothing here or in the other `grid_` files is shared with the core or with the rational oracle (`exact_pair.hpp`).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::oracle::grid {

/// A vector of whole numbers.
struct Int3 {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;

  [[nodiscard]] bool is_zero() const { return x == 0 && y == 0 && z == 0; }
  [[nodiscard]] Vec3 to_vec3() const { return {double(x), double(y), double(z)}; }
  friend bool operator==(const Int3&, const Int3&) = default;
  friend auto operator<=>(const Int3&, const Int3&) = default;
  friend Int3 operator+(const Int3& a, const Int3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Int3 operator-(const Int3& a, const Int3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Int3 operator-(const Int3& a) { return {-a.x, -a.y, -a.z}; }
};
[[nodiscard]] inline std::int32_t dot(const Int3& a, const Int3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Int3 cross(const Int3& a, const Int3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Divided by the greatest common divisor of its coordinates. Requires a vector other than 0.
[[nodiscard]] Int3 primitive(const Int3& v);

/// {x : normal . x <= offset}.
struct HalfSpace {
  Int3 normal;
  std::int32_t offset = 0;
};

/// Bounds that let the oracle compute in 16 bits (`grid_oracle.hpp`).
inline constexpr int kMostPoints = 8;
inline constexpr int kMostUnits = 9;

struct Body {
  std::vector<Int3> points;  ///< as given, inner ones and duplicates included
  int dimension = 0;         ///< affine, 0 to 3
  std::vector<Int3> vertices;
  std::vector<Int3> directions;   ///< of the edges, primitive, one of several parallel ones
  std::vector<Int3> normals;      ///< outward, primitive, of the facets; of a polygon both
  std::vector<HalfSpace> inside;  ///< the body is what all of them hold, flat bodies included
};

/// Requires 1 to kMostPoints points with coordinates in [0, kMostUnits]. Time O(n^4).
[[nodiscard]] Body make_body(std::span<const Int3> points);

/// One of the 24 rotations that map the axes onto themselves: coordinate k of R v is sign[k] * v[axis[k]].
struct AxisRotation {
  std::array<int, 3> axis{};
  std::array<int, 3> sign{};

  [[nodiscard]] Int3 apply(const Int3& v) const {
    const std::array<std::int32_t, 3> c{v.x, v.y, v.z};
    return {sign[0] * c[static_cast<std::size_t>(axis[0])], sign[1] * c[static_cast<std::size_t>(axis[1])],
            sign[2] * c[static_cast<std::size_t>(axis[2])]};
  }
  [[nodiscard]] Mat3 matrix() const;
};
inline constexpr int kAxisRotations = 24;
/// Number 0 is the identity.
[[nodiscard]] const std::array<AxisRotation, kAxisRotations>& axis_rotations();

}  // namespace pd::oracle::grid
