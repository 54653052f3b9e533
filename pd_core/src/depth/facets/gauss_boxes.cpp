#include "depth/facets/gauss_boxes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "numeric/lanes.hpp"

namespace pd::detail {

namespace {

/// A column of a pose's rotation is no longer than 1 + 1e-6 (Pose).
constexpr double kLongestAxis = 1 + 0x1p-19;
/// Sines below this are rounding.
constexpr double kParallelSine = 8 * kUnitRoundoff;
/// Fourth powers of lengths above it, the squares of cross products, are ordinary numbers.
constexpr double kLeastExtent = 0x1p-200;
/// Two faces that overlap share a point after one or two projections each way; faces askew take more.
constexpr int kMaxFootSteps = 12;
constexpr double kLeastProgress = 0.75;

struct AxisVectors {
  Lanes x, y, z;
};

PD_INLINE void load_box(AxisVectors& axes, AxisVectors& edges, Lanes& half, const BoxRows& from) {
  load(axes.x, from.x);
  load(axes.y, from.y);
  load(axes.z, from.z);
  load(half, from.half_extents);
  edges.x = axes.x * half;
  edges.y = axes.y * half;
  edges.z = axes.z * half;
}
/// Gives every lane the number of the next axis: (x, y, z) -> (y, z, x).
PD_INLINE Lanes turned(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
PD_INLINE AxisVectors turned(const AxisVectors& v) { return {turned(v.x), turned(v.y), turned(v.z)}; }
/// Puts an axis of a box into all lanes; `edge_of` puts its half edge.
PD_INLINE AxisVectors axis_of(const BoxRows& box, int i) {
  const Lanes zero = {0, 0, 0, 0};
  return {zero + box.x[i], zero + box.y[i], zero + box.z[i]};
}
PD_INLINE AxisVectors edge_of(const BoxRows& box, int i) {
  const Lanes zero = {0, 0, 0, 0};
  const double half = box.half_extents[i];
  return {zero + box.x[i] * half, zero + box.y[i] * half, zero + box.z[i] * half};
}
PD_INLINE void axes_product(AxisVectors& n, const AxisVectors& u, const AxisVectors& v) {
  n.x = u.y * v.z - u.z * v.y;
  n.y = u.z * v.x - u.x * v.z;
  n.z = u.x * v.y - u.y * v.x;
}
/// Computes |<n, v>| lane by lane.
PD_INLINE Lanes height_along(const AxisVectors& n, const AxisVectors& v) {
  return magnitude(n.x * v.x + n.y * v.y + n.z * v.z);
}

/// Holds the nearest axes so far, lane by lane.
struct NearestAxes {
  Lanes key, lower_key, slivers, axis;
  AxisVectors n;
};

struct AxisErrors {
  double turn;      ///< error of the height of P along a cross product of axes
  double parallel;  ///< squared lengths of products up to this are rounding
};

/// A block holds four normals of facets.
struct AxisBlock {
  int block;
  AxisVectors n;
  Lanes height;          ///< of P, along n as it is
  Lanes half_u, half_v;  ///< of the edges
};

/// Compares a block of normals with the nearest so far, and stores the block's lower keys.
/// @param exact  true if products of the axes have no rounding errors
template <bool exact>
PD_INLINE void consider(NearestAxes& best, const AxisBlock& of, const AxisErrors& errors,
                        double (&lower_keys)[kBoxAxisSlots]) {
  const Lanes zero = {0, 0, 0, 0}, none = zero + std::numeric_limits<double>::infinity();
  const AxisVectors& n = of.n;
  const Lanes squared = n.x * n.x + n.y * n.y + n.z * n.z;
  const Flags spans = squared > errors.parallel;
  const Lanes key = of.height * magnitude(of.height) / squared;
  const Flags nearer = spans & (key < best.key);
  best.key = nearer ? key : best.key;
  best.axis = nearer ? Lanes{0, 1, 2, 3} + static_cast<double>(4 * of.block) : best.axis;
  best.n.x = nearer ? n.x : best.n.x;
  best.n.y = nearer ? n.y : best.n.y;
  best.n.z = nearer ? n.z : best.n.z;
  Lanes lower_key = spans ? key : none;
  if (!exact) {
    const Lanes lowered = of.height - errors.turn;
    lower_key = spans ? lowered * magnitude(lowered) / squared : none;
    best.lower_key = lower_key < best.lower_key ? lower_key : best.lower_key;
    const Lanes shorter = of.half_u < of.half_v ? of.half_u : of.half_v;
    best.slivers += spans ? zero : shorter;
  }
  store(lower_keys + 4 * of.block, lower_key);
}

struct NearestAxis {
  double key, lower_key, slivers;
  int axis;
  double n[3];
};

template <bool exact>
PD_INLINE void nearest_of_all(const PosedBoxes& boxes, const AxisErrors& errors, NearestAxis& out,
                              double (&lower_keys)[kBoxAxisSlots]) {
  const BoxRows &a = boxes.a, &b = boxes.b;
  const Lanes zero = {0, 0, 0, 0};
  const Lanes none = zero + std::numeric_limits<double>::infinity();
  NearestAxes best{none, none, zero, zero, {zero, zero, zero}};
  AxisVectors axes_a, edges_a, axes_b, edges_b;
  Lanes half_a, half_b;
  load_box(axes_a, edges_a, half_a, a);
  load_box(axes_b, edges_b, half_b, b);
  const AxisVectors centre = {zero + boxes.centre[0], zero + boxes.centre[1], zero + boxes.centre[2]};
  const AxisVectors edge_a[3] = {edge_of(a, 0), edge_of(a, 1), edge_of(a, 2)};
  const AxisVectors edges_b_1 = turned(edges_b), edges_b_2 = turned(edges_b_1);

  // The facets of A have the normals x x y, y x z and z x x.
  AxisBlock of;
  of.block = 0;
  axes_product(of.n, axes_a, turned(axes_a));
  of.height = height_along(of.n, turned(turned(edges_a))) + height_along(of.n, edge_of(b, 0)) +
              height_along(of.n, edge_of(b, 1)) + height_along(of.n, edge_of(b, 2)) - height_along(of.n, centre);
  of.half_u = half_a;
  of.half_v = turned(half_a);
  consider<exact>(best, of, errors, lower_keys);
  // The facets of B have such products of the axes of B.
  of.block = 1;
  axes_product(of.n, axes_b, turned(axes_b));
  of.height = height_along(of.n, edges_b_2) + height_along(of.n, edge_a[0]) + height_along(of.n, edge_a[1]) +
              height_along(of.n, edge_a[2]) - height_along(of.n, centre);
  of.half_u = half_b;
  of.half_v = turned(half_b);
  consider<exact>(best, of, errors, lower_keys);
  // The other facets are spanned by an edge of A and an edge of B.
  of.half_v = half_b;
  for (int i = 0; i < 3; ++i) {
    of.block = 2 + i;
    axes_product(of.n, axis_of(a, i), axes_b);
    of.height = height_along(of.n, edge_a[i == 2 ? 0 : i + 1]) + height_along(of.n, edge_a[i == 0 ? 2 : i - 1]) +
                height_along(of.n, edges_b_1) + height_along(of.n, edges_b_2) - height_along(of.n, centre);
    of.half_u = zero + a.half_extents[i];
    consider<exact>(best, of, errors, lower_keys);
  }
  if (exact) best.lower_key = best.key;

  // Lane 1 holds the facets across x, lane 2 those across y. The first of equally near axes
  // wins: if two cubes are in one place, no axis is nearer than another, and no host takes x as the way up.
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

PD_CLONES void nearest_box_axis(const PosedBoxes& boxes, const AxisErrors& errors, NearestAxis& out,
                                double (&lower_keys)[kBoxAxisSlots]) {
  if (errors.turn == 0) {
    nearest_of_all<true>(boxes, errors, out, lower_keys);
  } else {
    nearest_of_all<false>(boxes, errors, out, lower_keys);
  }
}

/// Puts a vector into lanes, one for each coordinate.
PD_INLINE Lanes lanes_of(double x, double y, double z) { return Lanes{x, y, z, 0}; }
PD_INLINE Lanes lanes_of(const Vec3& v) { return lanes_of(v.x(), v.y(), v.z()); }
PD_INLINE Vec3 vector_of(const Lanes& v) { return {v[0], v[1], v[2]}; }
PD_INLINE double sum_of(const Lanes& v) { return v[0] + v[1] + v[2]; }
PD_INLINE double dot(const Lanes& u, const Lanes& v) { return sum_of(u * v); }
PD_INLINE Lanes cross(const Lanes& u, const Lanes& v) {
  return turned(u) * turned(turned(v)) - turned(turned(u)) * turned(v);
}
PD_INLINE double within_one(double x) { return x < -1 ? -1 : x > 1 ? 1 : x; }

/// Finds the point of B's edge that is nearest to A's edge: -1 and 1 are the ends. Given are the half edges and the gap
/// between the middles. If the edges are parallel, the middle is as good as any point.
PD_INLINE double crossing(const Lanes& edge_a, const Lanes& edge_b, const Lanes& gap) {
  const Lanes n = cross(edge_a, edge_b);
  const double squared = dot(n, n);
  return squared > 0 ? within_one(dot(cross(gap, edge_a), n) / squared) : 0;
}

/// The points of a box that are farthest along a direction, up to a level, are a centre and half edges, each added with
/// any weight from -1 to 1.
struct FaceOfBox {
  Lanes centre;
  Lanes edges[3];
  double weights[3];
  int count;
  int farthest;  ///< vertex
};

/// Finds the face of a box along a direction. Requires: `out.centre` is the centre of the box.
/// @param spanned  the edges that span the face for certain, as bits
PD_INLINE void find_face(FaceOfBox& out, const BoxRows& of, const Lanes& along, int spanned, double level) {
  out.count = out.farthest = 0;
  for (int k = 0; k < 3; ++k) {
    const Lanes edge = lanes_of(of.x[k], of.y[k], of.z[k]) * of.half_extents[k];
    const double height = dot(edge, along);
    const int bit = bit_of_box_axis(k);
    out.farthest |= height > 0 ? bit : 0;
    if ((spanned & bit) != 0 || (height <= level && height >= -level)) {
      out.weights[out.count] = 0;
      out.edges[out.count++] = edge;
    } else {
      out.centre += height > 0 ? edge : -edge;
    }
  }
}
/// Moves the face's point along a gap, edge by edge as far as the face reaches, and shortens the gap by that.
PD_INLINE void follow(FaceOfBox& face, Lanes& gap) {
  for (int k = 0; k < face.count; ++k) {
    const Lanes& edge = face.edges[k];
    const double last = face.weights[k];
    face.weights[k] = within_one(last + dot(gap, edge) / dot(edge, edge));
    gap -= (face.weights[k] - last) * edge;
  }
}
PD_INLINE Lanes point_of(const FaceOfBox& face) {
  Lanes x = face.centre;
  for (int k = 0; k < face.count; ++k) x += face.weights[k] * face.edges[k];
  return x;
}

// Eight coordinates are compared two at a time.
typedef double TwoDoubles __attribute__((vector_size(16)));
typedef std::int64_t TwoFlags __attribute__((vector_size(16)));
TwoDoubles two(const double* x, int pair) { return TwoDoubles{x[2 * pair], x[2 * pair + 1]}; }

}  // namespace

std::optional<BoxFrame> box_frame(const ConvexPolytope& p) {
  // Vertices are in lexicographic order, and z changes fastest: all coordinates between two equal ones are equal.
  if (p.num_vertices() != 8) return std::nullopt;
  const double *const x = p.x(), *const y = p.y(), *const z = p.z();
  const TwoDoubles ends = two(z, 0);
  const TwoFlags as_box = (TwoDoubles{x[0], x[4]} == TwoDoubles{x[3], x[7]}) &
                          (TwoDoubles{y[0], y[2]} == TwoDoubles{y[1], y[3]}) & (two(y, 0) == two(y, 2)) &
                          (two(y, 1) == two(y, 3)) & (two(z, 1) == ends) & (two(z, 2) == ends) & (two(z, 3) == ends);
  if ((as_box[0] & as_box[1]) == 0) return std::nullopt;
  const Vec3 least = p.vertex(0), most = p.vertex(7);
  if (!((most - least).minCoeff() > kLeastExtent)) return std::nullopt;
  return BoxFrame{0.5 * (least + most), 0.5 * (most - least)};
}

int facet_of_box(const ConvexPolytope& p, int axis, bool positive) {
  int f = 0;
  while ((positive ? 1 : -1) * p.facet_normal(f)[axis] < 0.5) ++f;
  return f;
}

int farthest_of_box(const BoxRows& of, const Vec3& normal, double sign) {
  int id = 0;
  for (int k = 0; k < 3; ++k) id |= sign * of.half_edge(k).dot(normal) > 0 ? bit_of_box_axis(k) : 0;
  return id;
}

bool PosedBoxes::has_single_axes() const {
  // The bits are tested, because GCC 12 drops roundings to float and back that stand side by side in one vector.
  constexpr std::uint64_t kBeyond = (std::uint64_t{1} << (53 - 24)) - 1;
  std::uint64_t bits = 0;
  for (const BoxRows* box : {&a, &b}) {
    for (const auto* row : {&box->x, &box->y, &box->z}) {
      for (const double number : *row) bits |= std::bit_cast<std::uint64_t>(number);
    }
  }
  return (bits & kBeyond) == 0;
}

double PosedBoxes::greatest_coordinate() const {
  const auto extent = [&](const double(&of_a)[4], const double(&of_b)[4], double middle) {
    Lanes row_a, row_b, half_a, half_b;
    load(row_a, of_a);
    load(row_b, of_b);
    load(half_a, a.half_extents);
    load(half_b, b.half_extents);
    return std::abs(middle) + sum_of(magnitude(row_a) * half_a + magnitude(row_b) * half_b);
  };
  return std::max({extent(a.x, b.x, centre[0]), extent(a.y, b.y, centre[1]), extent(a.z, b.z, centre[2])});
}

double PosedBoxes::height_along(const Vec3& n) const {
  const auto height_of = [&](const BoxRows& box) {
    AxisVectors axes, edges;
    Lanes half;
    load_box(axes, edges, half, box);
    return sum_of(magnitude(edges.x * n.x() + edges.y * n.y() + edges.z * n.z()));
  };
  return height_of(a) + height_of(b);
}

Vec3 PosedBoxes::normal_of(BoxAxis axis) const {
  if (axis.is_of_edges()) return a.axis(axis.block - 2).cross(b.axis(axis.lane));
  const BoxRows& own = axis.block == 0 ? a : b;
  return own.axis(axis.lane).cross(own.axis((axis.lane + 1) % 3));
}

BoxDistance distance_of_boxes(const PosedBoxes& boxes) {
  // Lengths of two axes have a product of kLongestAxis^2 at the most.
  constexpr double kProduct = kLongestAxis * kLongestAxis;
  constexpr double kParallelProduct = kParallelSine * kProduct;
  const bool exact = boxes.has_single_axes();
  const AxisErrors errors{exact ? 0 : kBoxTurn * boxes.reach * kProduct,
                          exact ? 0 : kParallelProduct * kParallelProduct};
  BoxDistance out;
  NearestAxis nearest;
  nearest_box_axis(boxes, errors, nearest, out.lower_keys);
  out.axis = nearest.axis;
  const Vec3 n(nearest.n[0], nearest.n[1], nearest.n[2]);
  const double along_centre = n.x() * boxes.centre[0] + n.y() * boxes.centre[1] + n.z() * boxes.centre[2];
  out.normal = n * ((along_centre > 0 ? -1 : 1) / n.norm());
  // The normal errs by 3u and its length by 3u, which changes h_P by as much times the reach.
  out.rounding = box_rounding(boxes.reach) + 8 * kUnitRoundoff * boxes.reach;
  out.height = std::copysign(std::sqrt(std::abs(nearest.key)), nearest.key);
  out.slivers = exact ? 0 : kLongestAxis * (kParallelSine + 2 * kBoxTurn) * nearest.slivers;
  if (nearest.lower_key > 0) out.depth = std::sqrt(nearest.lower_key) - box_rounding(boxes.reach) - out.slivers;
  return out;
}

PD_CLONES FootPoints foot_of_boxes(const PosedBoxes& boxes, const Vec3& centre_a, const BoxDistance& found,
                                   double level) {
  const BoxAxis axis(found.axis);
  const double rounding = 16 * kUnitRoundoff * boxes.reach, near = 2 * rounding;
  level = level > rounding ? level : rounding;
  const Lanes normal = lanes_of(found.normal), x = found.height * normal;
  FaceOfBox of_a, of_b;
  of_a.centre = lanes_of(centre_a);
  of_b.centre = of_a.centre + lanes_of(boxes.centre[0], boxes.centre[1], boxes.centre[2]);
  find_face(of_a, boxes.a, -normal, axis.flat_a(), level);
  find_face(of_b, boxes.b, normal, axis.flat_b(), level);
  Lanes gap = of_b.centre - of_a.centre - x;
  if (of_a.count == 1 && of_b.count == 1) {
    of_b.weights[0] = crossing(of_a.edges[0], of_b.edges[0], gap);
    gap += of_b.weights[0] * of_b.edges[0];
  }
  double missed = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxFootSteps; ++step) {
    follow(of_a, gap);
    gap = -gap;
    follow(of_b, gap);
    gap = -gap;
    const double last = missed;
    missed = dot(gap, gap);
    if (missed <= near * near || !(missed < kLeastProgress * kLeastProgress * last)) break;
  }
  const Lanes on_a = point_of(of_a), on_b = point_of(of_b);
  gap = on_b - on_a - x;
  return {vector_of(on_a), vector_of(on_b), std::sqrt(dot(gap, gap)), {of_a.farthest, of_b.farthest}};
}

}  // namespace pd::detail
