#include "depth/surface_planes.hpp"

#include <cstddef>
#include <limits>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

/// Four lanes; on narrower machines the compiler takes two registers for one.
typedef double Lanes __attribute__((vector_size(32)));
typedef std::int64_t Flags __attribute__((vector_size(32)));
constexpr int kLanes = kPlaneLanes;

typedef float Floats __attribute__((vector_size(32)));
typedef std::int32_t Ids __attribute__((vector_size(32)));
typedef std::int32_t HalfIds __attribute__((vector_size(16)));
static_assert(kPlaneBlock == 8);

struct Points {
  Lanes x, y, z;
};

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
PD_INLINE void store(double* to, const Lanes& from) { __builtin_memcpy(to, &from, sizeof(Lanes)); }
/// Four points, given by their ids, turned into arrays of coordinates.
PD_INLINE void gather(Points& to, const double* points, const std::int32_t* ids) {
  Lanes a, b, c, d;
  load(a, points + kPointStride * static_cast<std::ptrdiff_t>(ids[0]));
  load(b, points + kPointStride * static_cast<std::ptrdiff_t>(ids[1]));
  load(c, points + kPointStride * static_cast<std::ptrdiff_t>(ids[2]));
  load(d, points + kPointStride * static_cast<std::ptrdiff_t>(ids[3]));
  const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  to.x = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  to.y = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  to.z = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
}

struct Planes {
  Points normal;
  Lanes level, key;
};

PD_INLINE void planes_through(Planes& out, const Points& p, const Points& q, const Points& r) {
  const Lanes ux = q.x - p.x, uy = q.y - p.y, uz = q.z - p.z;
  const Lanes wx = r.x - p.x, wy = r.y - p.y, wz = r.z - p.z;
  const Lanes nx = uy * wz - uz * wy;
  const Lanes ny = uz * wx - ux * wz;
  const Lanes nz = ux * wy - uy * wx;
  const Lanes a = p.x * nx + p.y * ny + p.z * nz;
  const Lanes b = q.x * nx + q.y * ny + q.z * nz;
  const Lanes c = r.x * nx + r.y * ny + r.z * nz;
  const Lanes lower = a < b ? a : b;
  const Lanes least = lower < c ? lower : c;
  const Lanes higher = a > b ? a : b;
  const Lanes squared = nx * nx + ny * ny + nz * nz;
  const Lanes zero = {0, 0, 0, 0};
  const Lanes lowest = zero - std::numeric_limits<double>::max();
  const Lanes size = least < zero ? -least : least;
  out.normal.x = nx;
  out.normal.y = ny;
  out.normal.z = nz;
  out.level = higher > c ? higher : c;
  out.key = squared > zero ? least * size / squared : lowest;
}

}  // namespace

PD_CLONES void triangle_planes(const double* points, const CornerIds& corners, std::int32_t apex, int count,
                               const PlaneArrays& out) {
  const double* const top = points + kPointStride * static_cast<std::ptrdiff_t>(apex);
  const Lanes zero = {0, 0, 0, 0};
  const Lanes infinite = zero + std::numeric_limits<double>::infinity();
  const Lanes end = zero + static_cast<double>(count);
  Lanes number = {0, 1, 2, 3};
  Points p, q, r{zero + top[0], zero + top[1], zero + top[2]};
  for (int i = 0; i < count; i += kLanes) {
    gather(p, points, corners.p + i);
    gather(q, points, corners.q + i);
    if (corners.r != nullptr) gather(r, points, corners.r + i);
    Planes found;
    planes_through(found, p, q, r);
    store(out.nx + i, found.normal.x);
    store(out.ny + i, found.normal.y);
    store(out.nz + i, found.normal.z);
    store(out.level + i, number < end ? found.level : infinite);
    store(out.key + i, number < end ? found.key : infinite);
    number += kLanes;
  }
}

PD_CLONES std::uint64_t planes_below(const PlaneArrays& planes, int count, double x, double y, double z) {
  Flags below = {0, 0, 0, 0};
  Flags bits = {1, 2, 4, 8};
  for (int i = 0; i < count; i += kLanes) {
    Points normal;
    Lanes level;
    load(normal.x, planes.nx + i);
    load(normal.y, planes.ny + i);
    load(normal.z, planes.nz + i);
    load(level, planes.level + i);
    below |= (normal.x * x + normal.y * y + normal.z * z > level) & bits;
    bits <<= kLanes;
  }
  return static_cast<std::uint64_t>((below[0] | below[1]) | (below[2] | below[3]));
}

PD_CLONES int least_key(const double* keys, int count) {
  // Two rows of lanes, so that comparisons do not wait for each other.
  Lanes least, other;
  load(least, keys);
  load(other, keys + kLanes);
  for (int i = kPlaneBlock; i < count; i += kPlaneBlock) {
    Lanes next, after;
    load(next, keys + i);
    load(after, keys + i + kLanes);
    least = next < least ? next : least;
    other = after < other ? after : other;
  }
  least = other < least ? other : least;
  const double low = least[1] < least[0] ? least[1] : least[0];
  const double high = least[3] < least[2] ? least[3] : least[2];
  const Lanes zero = {0, 0, 0, 0};
  const Lanes best = zero + (high < low ? high : low);
  for (int i = 0;; i += kLanes) {
    Lanes next;
    load(next, keys + i);
    const Flags equal = (next == best) & Flags{1, 2, 4, 8};
    const auto found = static_cast<unsigned>((equal[0] | equal[1]) | (equal[2] | equal[3]));
    if (found != 0) return i + __builtin_ctz(found);
  }
}

PD_CLONES std::uint64_t near_faces(const float* distances, const float* spreads, int count, float turn, float limit) {
  std::uint64_t bits = 0;
  for (int i = 0; i < count; i += kPlaneBlock) {
    Floats distance, spread;
    __builtin_memcpy(&distance, distances + i, sizeof(Floats));
    __builtin_memcpy(&spread, spreads + i, sizeof(Floats));
    const Ids found = (distance - turn * spread <= limit) & Ids{1, 2, 4, 8, 16, 32, 64, 128};
    const HalfIds half =
        __builtin_shufflevector(found, found, 0, 1, 2, 3) | __builtin_shufflevector(found, found, 4, 5, 6, 7);
    bits |= static_cast<std::uint64_t>((half[0] | half[1]) | (half[2] | half[3])) << i;
  }
  return bits;
}

PD_CLONES double least_clearance(const PlaneArrays& planes, int count, double x, double y, double z, double slack) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes lowest = zero - std::numeric_limits<double>::max();
  Lanes least = zero + std::numeric_limits<double>::infinity();
  for (int i = 0; i < padded_to_block(count); i += kLanes) {
    Points normal;
    Lanes level;
    load(normal.x, planes.nx + i);
    load(normal.y, planes.ny + i);
    load(normal.z, planes.nz + i);
    load(level, planes.level + i);
    const Lanes below = level - (normal.x * x + normal.y * y + normal.z * z) - slack;
    const Lanes squared = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
    const Lanes size = below < zero ? -below : below;
    Lanes key = squared > zero ? below * size / squared : lowest;
    key = level < std::numeric_limits<double>::infinity() ? key : level;
    least = key < least ? key : least;
  }
  const double low = least[1] < least[0] ? least[1] : least[0];
  const double high = least[3] < least[2] ? least[3] : least[2];
  return high < low ? high : low;
}

}  // namespace pd::detail
