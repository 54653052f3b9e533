#include "depth/facets/box_sat_kernels.hpp"

#include <cstdint>
#include <initializer_list>
#include <limits>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

typedef double Lanes __attribute__((vector_size(32)));
typedef std::int64_t Flags __attribute__((vector_size(32)));
constexpr int kLanes = 4;
constexpr int kAxisBlocks = 5;

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }

struct LaneVectors {
  Lanes x, y, z;
};

PD_INLINE void load(LaneVectors& to, const BoxGenerators& from, int i) {
  load(to.x, from.x + i);
  load(to.y, from.y + i);
  load(to.z, from.z + i);
}

/// += |<n, (x, y, z)>|
PD_INLINE void add_height(Lanes& sum, const LaneVectors& n, double x, double y, double z) {
  const Lanes height = n.x * x + n.y * y + n.z * z;
  constexpr std::int64_t kMagnitude = std::numeric_limits<std::int64_t>::max();  // all bits but the sign's
  sum += (Lanes)((Flags)height & Flags{kMagnitude, kMagnitude, kMagnitude, kMagnitude});
}

/// What the axes of one block are about.
struct BlockKeys {
  Lanes key, lower_key, shorter;
  Flags parallel;
};

PD_INLINE void keys_of_block(BlockKeys& out, int block, const BoxEdges& edges_a, const BoxEdges& edges_b,
                             const double (&c)[3], const BoxAxesErrors& errors) {
  const BoxGenerators& a = edges_a.generators;
  const BoxGenerators& b = edges_b.generators;
  const BoxGenerators& along_a = edges_a.directions;
  const BoxGenerators& along_b = edges_b.directions;
  const Lanes zero = {0, 0, 0, 0};
  LaneVectors u, v;
  Lanes length_u, length_v;
  if (block < 2) {
    const BoxGenerators& own = block == 0 ? along_a : along_b;
    load(u, own, 0);
    load(v, own, 1);
    load(length_u, own.length);
    load(length_v, own.length + 1);
  } else {
    const int i = block - 2;
    u.x = zero + along_a.x[i];
    u.y = zero + along_a.y[i];
    u.z = zero + along_a.z[i];
    length_u = zero + along_a.length[i];
    load(v, along_b, 0);
    load(length_v, along_b.length);
  }
  LaneVectors n;
  n.x = u.y * v.z - u.z * v.y;
  n.y = u.z * v.x - u.x * v.z;
  n.z = u.x * v.y - u.y * v.x;
  const Lanes squared = n.x * n.x + n.y * n.y + n.z * n.z;
  const Lanes product = length_u * length_v;
  out.parallel = squared <= (errors.sine * errors.sine) * (product * product);
  Lanes height = zero, centre = zero;
  for (int k = 0; k < 3; ++k) {
    add_height(height, n, a.x[k], a.y[k], a.z[k]);
    add_height(height, n, b.x[k], b.y[k], b.z[k]);
  }
  add_height(centre, n, c[0], c[1], c[2]);
  height -= centre;
  out.key = height * (height < zero ? -height : height) / squared;
  out.lower_key = out.key;
  if (errors.turn != 0) {
    const Lanes lowered = height - errors.turn * product;
    out.lower_key = lowered * (lowered < zero ? -lowered : lowered) / squared;
  }
  out.shorter = length_u < length_v ? length_u : length_v;
}

}  // namespace

PD_CLONES void box_axis_keys(const BoxEdges& a, const BoxEdges& b, const double (&c)[3], const BoxAxesErrors& errors,
                             BoxAxisKeys& out) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes none = zero + std::numeric_limits<double>::infinity();
  for (int block = 0; block < kAxisBlocks; ++block) {
    BlockKeys found;
    keys_of_block(found, block, a, b, c, errors);
    const Lanes key = found.parallel ? none : found.key;
    const Lanes lower_key = found.parallel ? none : found.lower_key;
    __builtin_memcpy(out.key + kLanes * block, &key, sizeof(Lanes));
    __builtin_memcpy(out.lower_key + kLanes * block, &lower_key, sizeof(Lanes));
  }
}

PD_CLONES NearestBoxAxis nearest_box_axis(const BoxEdges& edges_a, const BoxEdges& edges_b, const double (&c)[3],
                                          const BoxAxesErrors& errors) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes none = zero + std::numeric_limits<double>::infinity();
  const Flags first_three = {-1, -1, -1, 0};
  Lanes best = none, lower = none, slivers = zero, best_axis = zero;
  for (int block = 0; block < kAxisBlocks; ++block) {
    BlockKeys found;
    keys_of_block(found, block, edges_a, edges_b, c, errors);
    const Flags counts = first_three & ~found.parallel;
    const Flags left_out = first_three & found.parallel;
    const Flags nearer = counts & (found.key < best);
    const Flags lowers = counts & (found.lower_key < lower);
    slivers += left_out ? found.shorter : zero;
    best_axis = nearer ? Lanes{0, 1, 2, 3} + static_cast<double>(kLanes * block) : best_axis;
    best = nearer ? found.key : best;
    lower = lowers ? found.lower_key : lower;
  }
  // Lane 1 holds the facets across x, lane 2 those across y. Of equal ones the first of them wins: of cubes in one
  // place no axis is nearer than another, and x is no host's way up.
  NearestBoxAxis out{best[1], lower[1], static_cast<int>(best_axis[1]), slivers[0] + slivers[1] + slivers[2]};
  for (const int lane : {2, 0}) {
    if (best[lane] < out.key) {
      out.key = best[lane];
      out.axis = static_cast<int>(best_axis[lane]);
    }
    out.lower_key = lower[lane] < out.lower_key ? lower[lane] : out.lower_key;
  }
  return out;
}

}  // namespace pd::detail
