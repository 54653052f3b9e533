#include "contact/box_axes.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

typedef double Lanes __attribute__((vector_size(32)));
typedef std::int64_t Flags __attribute__((vector_size(32)));
constexpr int kLanes = 4;
/// |column of R| <= 1 + 1e-6 (Pose).
constexpr double kLongest = 1 + 0x1p-19;

struct LaneVectors {
  Lanes x, y, z;
};

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
PD_INLINE void load(LaneVectors& axes, LaneVectors& edges, Lanes& half, const BoxLanes& from) {
  load(axes.x, from.x);
  load(axes.y, from.y);
  load(axes.z, from.z);
  load(half, from.half);
  edges.x = axes.x * half;
  edges.y = axes.y * half;
  edges.z = axes.z * half;
}
/// To the next axis: (x, y, z) -> (y, z, x).
PD_INLINE Lanes turned(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
PD_INLINE LaneVectors turned(const LaneVectors& v) { return {turned(v.x), turned(v.y), turned(v.z)}; }
PD_INLINE LaneVectors all_lanes(const LaneVectors& v, int i) {
  const Lanes zero = {0, 0, 0, 0};
  return {zero + v.x[i], zero + v.y[i], zero + v.z[i]};
}
PD_INLINE void cross(LaneVectors& n, const LaneVectors& u, const LaneVectors& v) {
  n.x = u.y * v.z - u.z * v.y;
  n.y = u.z * v.x - u.x * v.z;
  n.z = u.x * v.y - u.y * v.x;
}
/// |<n, v>|
PD_INLINE Lanes height(const LaneVectors& n, const LaneVectors& v) {
  const Lanes signed_height = n.x * v.x + n.y * v.y + n.z * v.z;
  constexpr std::int64_t kMagnitude = std::numeric_limits<std::int64_t>::max();  // all bits but the sign's
  return (Lanes)((Flags)signed_height & Flags{kMagnitude, kMagnitude, kMagnitude, kMagnitude});
}

/// The nearest axes so far, lane by lane.
struct Nearest {
  Lanes key, lower_key, slivers, axis;
  LaneVectors n;
};

struct Errors {
  double turn;      ///< of an axis' height
  double parallel;  ///< squared lengths of products up to this are rounding
};

/// @param height  of P, along n as it is
PD_INLINE void consider(Nearest& best, int block, const LaneVectors& n, const Lanes& height, const Lanes& shorter,
                        const Errors& errors) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes squared = n.x * n.x + n.y * n.y + n.z * n.z;
  const Flags parallel = squared <= errors.parallel;
  const Lanes key = height * (height < zero ? -height : height) / squared;
  Lanes lower_key = key;
  if (errors.turn != 0) {
    const Lanes lowered = height - errors.turn;
    lower_key = lowered * (lowered < zero ? -lowered : lowered) / squared;
    best.slivers += parallel ? shorter : zero;
  }
  const Flags nearer = ~parallel & (key < best.key);
  const Flags lowers = ~parallel & (lower_key < best.lower_key);
  best.key = nearer ? key : best.key;
  best.lower_key = lowers ? lower_key : best.lower_key;
  best.axis = nearer ? Lanes{0, 1, 2, 3} + static_cast<double>(kLanes * block) : best.axis;
  best.n.x = nearer ? n.x : best.n.x;
  best.n.y = nearer ? n.y : best.n.y;
  best.n.z = nearer ? n.z : best.n.z;
}

struct NearestAxis {
  double key, lower_key, slivers;
  int axis;
  double n[3];
};

PD_CLONES void nearest_axis(const BoxLanes& a, const BoxLanes& b, const double (&c)[3], const Errors& errors,
                            NearestAxis& out) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes none = zero + std::numeric_limits<double>::infinity();
  Nearest best{none, none, zero, zero, {zero, zero, zero}};
  LaneVectors axes_a, edges_a, axes_b, edges_b, n;
  Lanes half_a, half_b;
  load(axes_a, edges_a, half_a, a);
  load(axes_b, edges_b, half_b, b);
  const LaneVectors centre = {zero + c[0], zero + c[1], zero + c[2]};
  const LaneVectors edge_a[3] = {all_lanes(edges_a, 0), all_lanes(edges_a, 1), all_lanes(edges_a, 2)};
  const LaneVectors edges_b_1 = turned(edges_b), edges_b_2 = turned(edges_b_1);

  // Facets of A: x x y, y x z, z x x.
  cross(n, axes_a, turned(axes_a));
  Lanes of_p = height(n, turned(turned(edges_a))) + height(n, all_lanes(edges_b, 0)) +
               height(n, all_lanes(edges_b, 1)) + height(n, all_lanes(edges_b, 2)) - height(n, centre);
  const Lanes next_a = turned(half_a), next_b = turned(half_b);
  consider(best, 0, n, of_p, half_a < next_a ? half_a : next_a, errors);
  // Of B.
  cross(n, axes_b, turned(axes_b));
  of_p = height(n, edges_b_2) + height(n, edge_a[0]) + height(n, edge_a[1]) + height(n, edge_a[2]) - height(n, centre);
  consider(best, 1, n, of_p, half_b < next_b ? half_b : next_b, errors);
  // An edge of A and one of B.
  for (int i = 0; i < 3; ++i) {
    cross(n, all_lanes(axes_a, i), axes_b);
    of_p = height(n, edge_a[i == 2 ? 0 : i + 1]) + height(n, edge_a[i == 0 ? 2 : i - 1]) + height(n, edges_b_1) +
           height(n, edges_b_2) - height(n, centre);
    const Lanes half_i = zero + half_a[i];
    consider(best, 2 + i, n, of_p, half_i < half_b ? half_i : half_b, errors);
  }

  // Lane 1 holds the facets across x, lane 2 those across y. Of equal ones the first of them wins: of cubes in one
  // place no axis is nearer than another, and x is no host's way up.
  int lane = 1;
  out.key = best.key[1];
  out.lower_key = best.lower_key[1];
  for (const int other : {2, 0}) {
    if (best.key[other] < out.key) {
      out.key = best.key[other];
      lane = other;
    }
    out.lower_key = best.lower_key[other] < out.lower_key ? best.lower_key[other] : out.lower_key;
  }
  out.axis = static_cast<int>(best.axis[lane]);
  out.slivers = best.slivers[0] + best.slivers[1] + best.slivers[2];
  out.n[0] = best.n.x[lane];
  out.n[1] = best.n.y[lane];
  out.n[2] = best.n.z[lane];
}

}  // namespace

BoxDistance distance_of_boxes(const BoxLanes& a, const BoxLanes& b, const double (&centre)[3], double reach,
                              bool exact_edges) {
  // Two unit vectors, not of generators: their lengths' product is kLongest^2 at the most.
  constexpr double kProduct = kLongest * kLongest;
  constexpr double kParallel = kBoxParallelSine * kProduct;
  const Errors errors{exact_edges ? 0 : kBoxTurn * reach * kProduct, exact_edges ? 0 : kParallel * kParallel};
  NearestAxis nearest;
  nearest_axis(a, b, centre, errors, nearest);
  BoxDistance out;
  out.axis = nearest.axis;
  const Vec3 n(nearest.n[0], nearest.n[1], nearest.n[2]);
  const double along_centre = n.x() * centre[0] + n.y() * centre[1] + n.z() * centre[2];
  out.normal = n * ((along_centre > 0 ? -1 : 1) / n.norm());
  // As for `box_pair_depth`; the normal errs by 3u more.
  out.rounding = 28 * kUnitRoundoff * reach;
  out.height = std::copysign(std::sqrt(std::abs(nearest.key)), nearest.key);
  const double slivers = exact_edges ? 0 : kLongest * (kBoxParallelSine + 2 * kBoxTurn) * nearest.slivers;
  out.depth = nearest.lower_key > 0 ? std::sqrt(nearest.lower_key) - out.rounding - slivers : 0;
  return out;
}

}  // namespace pd::detail
