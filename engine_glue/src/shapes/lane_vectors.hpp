/// @file
/// Four of Bullet's vectors at a time, coordinate by coordinate, as the points of a manifold come. Each lane computes
/// on its own and in Bullet's order: results are the bits of `btTransform`.
#pragma once

#include <LinearMath/btTransform.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace pd::detail {

typedef btScalar Lanes __attribute__((vector_size(4 * sizeof(btScalar))));

// By reference: lanes of double precision have no agreed way to be passed by value without AVX.
inline void load_lanes(const btVector3& v, Lanes& out) { __builtin_memcpy(&out, v.m_floats, sizeof(Lanes)); }

using LaneInteger = std::conditional_t<sizeof(btScalar) == sizeof(float), std::int32_t, std::int64_t>;
/// Of comparisons: all bits of a lane, or none.
typedef LaneInteger LaneFlags __attribute__((vector_size(4 * sizeof(btScalar))));

struct FourVectors {
  Lanes x, y, z;
};

inline FourVectors operator+(const FourVectors& u, const FourVectors& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
inline FourVectors operator-(const FourVectors& u, const FourVectors& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
/// v s, a factor for each lane.
inline FourVectors scaled(const FourVectors& v, const Lanes& s) { return {v.x * s, v.y * s, v.z * s}; }
inline void dot(const FourVectors& u, const FourVectors& v, Lanes& out) { out = u.x * v.x + u.y * v.y + u.z * v.z; }
inline void dot(const FourVectors& u, const btVector3& v, Lanes& out) { out = u.x * v.x() + u.y * v.y() + u.z * v.z(); }
inline FourVectors select(const LaneFlags& flags, const FourVectors& u, const FourVectors& v) {
  return {flags ? u.x : v.x, flags ? u.y : v.y, flags ? u.z : v.z};
}
inline bool all(const LaneFlags& flags) {
  std::uint64_t words[sizeof(LaneFlags) / sizeof(std::uint64_t)];
  __builtin_memcpy(words, &flags, sizeof(words));
  std::uint64_t both = ~std::uint64_t{0};
  for (const std::uint64_t word : words) both &= word;
  return both == ~std::uint64_t{0};
}

inline FourVectors gather(const std::array<const btVector3*, 4>& from) {
  Lanes v[4];
  for (std::size_t k = 0; k < 4; ++k) load_lanes(*from[k], v[k]);
  const Lanes xy_low = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5);
  const Lanes xy_high = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5);
  const Lanes z_low = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7);
  const Lanes z_high = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  return {__builtin_shufflevector(xy_low, xy_high, 0, 1, 4, 5), __builtin_shufflevector(xy_low, xy_high, 2, 3, 6, 7),
          __builtin_shufflevector(z_low, z_high, 0, 1, 4, 5)};
}

/// The vectors one by one, their fourth number 0.
inline void spread(const FourVectors& v, Lanes (&out)[4]) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes xy_low = __builtin_shufflevector(v.x, v.y, 0, 4, 1, 5);
  const Lanes xy_high = __builtin_shufflevector(v.x, v.y, 2, 6, 3, 7);
  const Lanes z_low = __builtin_shufflevector(v.z, zero, 0, 4, 1, 5);
  const Lanes z_high = __builtin_shufflevector(v.z, zero, 2, 6, 3, 7);
  out[0] = __builtin_shufflevector(xy_low, z_low, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(xy_low, z_low, 2, 3, 6, 7);
  out[2] = __builtin_shufflevector(xy_high, z_high, 0, 1, 4, 5);
  out[3] = __builtin_shufflevector(xy_high, z_high, 2, 3, 6, 7);
}

/// transform(v)
inline FourVectors apply(const btTransform& transform, const FourVectors& v) {
  const btMatrix3x3& rows = transform.getBasis();
  FourVectors out;
  dot(v, rows[0], out.x);
  dot(v, rows[1], out.y);
  dot(v, rows[2], out.z);
  const btVector3& origin = transform.getOrigin();
  return {out.x + origin.x(), out.y + origin.y(), out.z + origin.z()};
}

/// v * transform.getBasis()
inline FourVectors turn_back(const btTransform& transform, const FourVectors& v) {
  const btMatrix3x3& rows = transform.getBasis();
  return {v.x * rows[0].x() + v.y * rows[1].x() + v.z * rows[2].x(),
          v.x * rows[0].y() + v.y * rows[1].y() + v.z * rows[2].y(),
          v.x * rows[0].z() + v.y * rows[1].z() + v.z * rows[2].z()};
}

/// transform.invXform(v)
inline FourVectors apply_inverse(const btTransform& transform, const FourVectors& v) {
  const btVector3& origin = transform.getOrigin();
  return turn_back(transform, {v.x - origin.x(), v.y - origin.y(), v.z - origin.z()});
}

}  // namespace pd::detail
