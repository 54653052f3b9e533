#include "depth/expansion/plane_kernels.hpp"

#include <cstddef>
#include <limits>

#include "numeric/lanes.hpp"

namespace pd::detail {

namespace {

static_assert(kPlaneLanes == kLanes && kPlaneBlock == kFloats);

struct Points {
  Lanes x, y, z;
};

/// Four points, given by their ids, turned into arrays of coordinates.
PD_INLINE void gather(Points& to, const double* points, const std::int32_t* ids) {
  Lanes a, b, c, d;
  load(a, points + kPointStride * static_cast<std::ptrdiff_t>(ids[0]));
  load(b, points + kPointStride * static_cast<std::ptrdiff_t>(ids[1]));
  load(c, points + kPointStride * static_cast<std::ptrdiff_t>(ids[2]));
  load(d, points + kPointStride * static_cast<std::ptrdiff_t>(ids[3]));
  transpose(a, b, c, d);
  to.x = a;
  to.y = b;
  to.z = c;
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
  const Lanes lowest_corner = lower < c ? lower : c;
  const Lanes higher = a > b ? a : b;
  const Lanes squared = nx * nx + ny * ny + nz * nz;
  const Lanes zero = {0, 0, 0, 0};
  const Lanes lowest = zero - std::numeric_limits<double>::max();
  const Lanes size = lowest_corner < zero ? -lowest_corner : lowest_corner;
  out.normal.x = nx;
  out.normal.y = ny;
  out.normal.z = nz;
  out.level = higher > c ? higher : c;
  out.key = squared > zero ? lowest_corner * size / squared : lowest;
}

PD_INLINE void load_planes(Points& normal, Lanes& level, const PlaneArrays& planes, int i) {
  load(normal.x, planes.nx + i);
  load(normal.y, planes.ny + i);
  load(normal.z, planes.nz + i);
  load(level, planes.level + i);
}

/// The index of the first key of this value, which is there.
PD_INLINE int first_of(const double* keys, double value) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes wanted = zero + value;
  for (int i = 0;; i += kLanes) {
    Lanes next;
    load(next, keys + i);
    const unsigned found = mask_of_four(next == wanted);
    if (found != 0) return i + __builtin_ctz(found);
  }
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
  std::uint64_t below = 0;
  for (int i = 0; i < count; i += kLanes) {
    Points normal;
    Lanes level;
    load_planes(normal, level, planes, i);
    below |= std::uint64_t{mask_of_four(normal.x * x + normal.y * y + normal.z * z > level)} << i;
  }
  return below;
}

PD_CLONES int add_fan(const double* points, const CornerIds& corners, std::int32_t apex, int count,
                      const PlaneArrays& planes, int first) {
  const double* const top = points + kPointStride * static_cast<std::ptrdiff_t>(apex);
  const Lanes zero = {0, 0, 0, 0};
  const Lanes infinite = zero + std::numeric_limits<double>::infinity();
  const Lanes end = zero + static_cast<double>(count);
  Lanes nearest = infinite, number = {0, 1, 2, 3};
  for (int i = 0; i < first; i += kLanes) {
    Lanes key;
    load(key, planes.key + i);
    nearest = key < nearest ? key : nearest;
  }
  Points p, q, r{zero + top[0], zero + top[1], zero + top[2]};
  for (int i = 0; i < count; i += kLanes) {
    gather(p, points, corners.p + i);
    gather(q, points, corners.q + i);
    Planes found;
    planes_through(found, p, q, r);
    const Lanes key = number < end ? found.key : infinite;
    nearest = key < nearest ? key : nearest;
    store(planes.nx + first + i, found.normal.x);
    store(planes.ny + first + i, found.normal.y);
    store(planes.nz + first + i, found.normal.z);
    store(planes.level + first + i, number < end ? found.level : infinite);
    store(planes.key + first + i, key);
    number += kLanes;
  }
  return first_of(planes.key, least(nearest));
}

PD_CLONES int least_key(const double* keys, int count) {
  // Two rows of lanes, so that comparisons do not wait for each other.
  Lanes first, second;
  load(first, keys);
  load(second, keys + kLanes);
  for (int i = kPlaneBlock; i < count; i += kPlaneBlock) {
    Lanes next, after;
    load(next, keys + i);
    load(after, keys + i + kLanes);
    first = next < first ? next : first;
    second = after < second ? after : second;
  }
  return first_of(keys, least(second < first ? second : first));
}

}  // namespace pd::detail
