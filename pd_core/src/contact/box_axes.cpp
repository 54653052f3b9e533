#include "contact/box_axes.hpp"

#include <cmath>
#include <limits>

#include "contact/box_lanes.hpp"

namespace pd::detail {

namespace {

/// |column of R| <= 1 + 1e-6 (Pose).
constexpr double kLongestAxis = 1 + 0x1p-19;

struct AxisVectors {
  FourDoubles x, y, z;
};

PD_INLINE void load_box(AxisVectors& axes, AxisVectors& edges, FourDoubles& half, const BoxInRows& from) {
  load_four(axes.x, from.x);
  load_four(axes.y, from.y);
  load_four(axes.z, from.z);
  load_four(half, from.half_extents);
  edges.x = axes.x * half;
  edges.y = axes.y * half;
  edges.z = axes.z * half;
}
/// To the next axis: (x, y, z) -> (y, z, x).
PD_INLINE FourDoubles turned(const FourDoubles& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
PD_INLINE AxisVectors turned(const AxisVectors& v) { return {turned(v.x), turned(v.y), turned(v.z)}; }
/// An axis, and its half edge, in all lanes.
PD_INLINE AxisVectors axis_of(const BoxInRows& box, int i) {
  const FourDoubles zero = {0, 0, 0, 0};
  return {zero + box.x[i], zero + box.y[i], zero + box.z[i]};
}
PD_INLINE AxisVectors edge_of(const BoxInRows& box, int i) {
  const FourDoubles zero = {0, 0, 0, 0};
  const double half = box.half_extents[i];
  return {zero + box.x[i] * half, zero + box.y[i] * half, zero + box.z[i] * half};
}
PD_INLINE void axes_product(AxisVectors& n, const AxisVectors& u, const AxisVectors& v) {
  n.x = u.y * v.z - u.z * v.y;
  n.y = u.z * v.x - u.x * v.z;
  n.z = u.x * v.y - u.y * v.x;
}
/// |<n, v>|
PD_INLINE FourDoubles height(const AxisVectors& n, const AxisVectors& v) {
  return magnitude(n.x * v.x + n.y * v.y + n.z * v.z);
}

/// The nearest axes so far, lane by lane.
struct NearestAxes {
  FourDoubles key, lower_key, slivers, axis;
  AxisVectors n;
};

struct AxisErrors {
  double turn;      ///< of an axis' height
  double parallel;  ///< squared lengths of products up to this are rounding
};

/// @param exact   there are no errors
/// @param height  of P, along n as it is
template <bool exact>
PD_INLINE void consider(NearestAxes& best, int block, const AxisVectors& n, const FourDoubles& height,
                        const FourDoubles& half_u, const FourDoubles& half_v, const AxisErrors& errors) {
  const FourDoubles zero = {0, 0, 0, 0};
  const FourDoubles squared = n.x * n.x + n.y * n.y + n.z * n.z;
  const FourFlags spans = squared > errors.parallel;
  const FourDoubles key = height * magnitude(height) / squared;
  const FourFlags nearer = spans & (key < best.key);
  best.key = nearer ? key : best.key;
  best.axis = nearer ? FourDoubles{0, 1, 2, 3} + static_cast<double>(4 * block) : best.axis;
  best.n.x = nearer ? n.x : best.n.x;
  best.n.y = nearer ? n.y : best.n.y;
  best.n.z = nearer ? n.z : best.n.z;
  if (exact) return;
  const FourDoubles lowered = height - errors.turn;
  const FourDoubles lower_key = lowered * magnitude(lowered) / squared;
  best.lower_key = (spans & (lower_key < best.lower_key)) ? lower_key : best.lower_key;
  const FourDoubles shorter = half_u < half_v ? half_u : half_v;
  best.slivers += spans ? zero : shorter;
}

struct NearestAxis {
  double key, lower_key, slivers;
  int axis;
  double n[3];
};

template <bool exact>
PD_INLINE void nearest_of_all(const BoxInRows& a, const BoxInRows& b, const double (&c)[3], const AxisErrors& errors,
                              NearestAxis& out) {
  const FourDoubles zero = {0, 0, 0, 0};
  const FourDoubles none = zero + std::numeric_limits<double>::infinity();
  NearestAxes best{none, none, zero, zero, {zero, zero, zero}};
  AxisVectors axes_a, edges_a, axes_b, edges_b, n;
  FourDoubles half_a, half_b;
  load_box(axes_a, edges_a, half_a, a);
  load_box(axes_b, edges_b, half_b, b);
  const AxisVectors centre = {zero + c[0], zero + c[1], zero + c[2]};
  const AxisVectors edge_a[3] = {edge_of(a, 0), edge_of(a, 1), edge_of(a, 2)};
  const AxisVectors edges_b_1 = turned(edges_b), edges_b_2 = turned(edges_b_1);

  // Facets of A: x x y, y x z, z x x.
  axes_product(n, axes_a, turned(axes_a));
  FourDoubles of_p = height(n, turned(turned(edges_a))) + height(n, edge_of(b, 0)) + height(n, edge_of(b, 1)) +
                     height(n, edge_of(b, 2)) - height(n, centre);
  consider<exact>(best, 0, n, of_p, half_a, turned(half_a), errors);
  // Of B.
  axes_product(n, axes_b, turned(axes_b));
  of_p = height(n, edges_b_2) + height(n, edge_a[0]) + height(n, edge_a[1]) + height(n, edge_a[2]) - height(n, centre);
  consider<exact>(best, 1, n, of_p, half_b, turned(half_b), errors);
  // An edge of A and one of B.
  for (int i = 0; i < 3; ++i) {
    axes_product(n, axis_of(a, i), axes_b);
    of_p = height(n, edge_a[i == 2 ? 0 : i + 1]) + height(n, edge_a[i == 0 ? 2 : i - 1]) + height(n, edges_b_1) +
           height(n, edges_b_2) - height(n, centre);
    consider<exact>(best, 2 + i, n, of_p, zero + a.half_extents[i], half_b, errors);
  }
  if (exact) best.lower_key = best.key;

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

PD_CLONES void nearest_axis(const BoxInRows& a, const BoxInRows& b, const double (&c)[3], const AxisErrors& errors,
                            NearestAxis& out) {
  if (errors.turn == 0) {
    nearest_of_all<true>(a, b, c, errors, out);
  } else {
    nearest_of_all<false>(a, b, c, errors, out);
  }
}

}  // namespace

BoxDistance distance_of_boxes(const BoxInRows& a, const BoxInRows& b, const double (&centre)[3], double reach,
                              bool exact_edges) {
  // Two unit vectors, not of generators: their lengths' product is kLongestAxis^2 at the most.
  constexpr double kProduct = kLongestAxis * kLongestAxis;
  constexpr double kParallel = kBoxParallelSine * kProduct;
  const AxisErrors errors{exact_edges ? 0 : kBoxTurn * reach * kProduct, exact_edges ? 0 : kParallel * kParallel};
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
  const double slivers = exact_edges ? 0 : kLongestAxis * (kBoxParallelSine + 2 * kBoxTurn) * nearest.slivers;
  out.depth = nearest.lower_key > 0 ? std::sqrt(nearest.lower_key) - out.rounding - slivers : 0;
  return out;
}

}  // namespace pd::detail
