/// @file
/// The arithmetic of a surface's planes over arrays: planes of a fan, visibility from a point, the nearest plane.
///
/// Compiled for several instruction sets and chosen at run time. Plain loops without contraction, each lane on its own:
/// the same bits on every instruction set.
#pragma once

#include <cstdint>

namespace pd::detail {

/// Arrays are read and written in blocks of this many entries: they need room for a whole number of blocks.
inline constexpr int kPlaneBlock = 8;
/// `count` rounded up to whole blocks.
constexpr int padded_to_block(int count) { return (count + kPlaneBlock - 1) & -kPlaneBlock; }
/// Planes are computed this many at a time.
inline constexpr int kPlaneLanes = 4;
constexpr int padded_to_lanes(int count) { return (count + kPlaneLanes - 1) & -kPlaneLanes; }

/// Planes: normal = (q - p) x (r - p), any length; `level` = the greatest of <p, n>, <q, n>, <r, n>, which a point must
/// exceed to be visible; `key` = the least of them as sign * square / |n|^2, a stand-in for the plane's signed distance
/// that needs no root (-DBL_MAX where the normal vanishes). For any normal whatsoever the triangle lies beyond the
/// least of the three: a sliver's bad normal cannot lie.
struct PlaneArrays {
  double* nx;
  double* ny;
  double* nz;
  double* level;
  double* key;
};

/// Triangles over a list of points that lie `kPointStride` doubles apart, the first three of them coordinates.
inline constexpr int kPointStride = 4;
struct CornerIds {
  const std::int32_t* p;
  const std::int32_t* q;
  const std::int32_t* r;  ///< nullptr: `apex` for all of them
};

/// Planes of `count` triangles. All lanes are written, those beyond `count` with infinite levels and keys, and the
/// lists of ids are read so, too: they must be filled up with valid ids.
void triangle_planes(const double* points, const CornerIds& corners, std::int32_t apex, int count,
                     const PlaneArrays& out);

/// The planes of a fan: triangles p q apex in slots first, first + 1, ... of `planes`, where `first` is a multiple of
/// kPlaneLanes; as `triangle_planes` otherwise. Returns the lowest index of the least key of all slots so far. Keys
/// before `first` must be there, infinite for free slots.
int add_fan(const double* points, const CornerIds& corners, std::int32_t apex, int count, const PlaneArrays& planes,
            int first);

/// Bit i: the point lies above plane i, i < count <= 64. Entries up to the next whole block are read, their bits given.
std::uint64_t planes_below(const PlaneArrays& planes, int count, double x, double y, double z);

/// Lowest index of the least key, count >= 1. Entries up to the next whole block must hold keys, too.
int least_key(const double* keys, int count);

}  // namespace pd::detail
