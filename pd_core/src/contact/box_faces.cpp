#include "contact/box_faces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/manifold_reduce.hpp"
#include "numeric/lanes.hpp"

namespace pd::detail {

namespace {

PD_INLINE double unsigned_of(double x) { return __builtin_fabs(x); }
PD_INLINE double less_of(double x, double y) { return y < x ? y : x; }
PD_INLINE double more_of(double x, double y) { return x < y ? y : x; }
/// Plain arrays: an inline function of a library must not become a part of a wider instruction set.
struct PlainVector {
  double x, y, z;
};
PD_INLINE PlainVector operator+(const PlainVector& u, const PlainVector& v) {
  return {u.x + v.x, u.y + v.y, u.z + v.z};
}
PD_INLINE PlainVector operator-(const PlainVector& u, const PlainVector& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}
PD_INLINE PlainVector operator*(double s, const PlainVector& v) { return {s * v.x, s * v.y, s * v.z}; }
PD_INLINE double plain_dot(const PlainVector& u, const PlainVector& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
PD_INLINE PlainVector plain_cross(const PlainVector& u, const PlainVector& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// A face of a box: its middle, its two half edges and the vertices at its corners, counter-clockwise about the contact
/// normal from the one at minus both half edges.
struct BoxFace {
  PlainVector centre, first, second;
  double length_first, length_second;
  unsigned ids[4];
};

PD_INLINE PlainVector half_edge(const BoxInRows& box, int axis) {
  const double half = box.half_extents[axis];
  return {box.x[axis] * half, box.y[axis] * half, box.z[axis] * half};
}

/// Vertices are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
PD_INLINE unsigned bit(int axis) { return 4U >> axis; }

/// The face that looks along a direction the most; of equals the one across the first axis.
/// @param turned  of the body that the normal points away from.
PD_INLINE void face_towards(const BoxInRows& box, const PlainVector& centre, const PlainVector& direction, bool turned,
                            BoxFace& out) {
  Lanes x, y, z;
  load(x, box.x);
  load(y, box.y);
  load(z, box.z);
  const Lanes sum = x * direction.x + y * direction.y + z * direction.z;
  double along[4];
  store(along, sum);
  int axis = unsigned_of(along[1]) > unsigned_of(along[0]) ? 1 : 0;
  if (unsigned_of(along[2]) > unsigned_of(along[axis])) axis = 2;
  const bool positive = along[axis] > 0;
  const PlainVector up = half_edge(box, axis);
  out.centre = positive ? centre + up : centre - up;
  // The next two axes turn counter-clockwise about this one.
  const int next = axis == 2 ? 0 : axis + 1, last = axis == 0 ? 2 : axis - 1;
  const bool swapped = positive == turned;
  const int first = swapped ? last : next, second = swapped ? next : last;
  out.first = half_edge(box, first);
  out.second = half_edge(box, second);
  out.length_first = box.half_extents[first];
  out.length_second = box.half_extents[second];
  const unsigned base = positive ? bit(axis) : 0;
  out.ids[0] = base;
  out.ids[1] = base | bit(first);
  out.ids[2] = base | bit(first) | bit(second);
  out.ids[3] = base | bit(second);
}

/// Corners of the cut face in the other face's own coordinates, which run from -1 to 1 along its two edges.
struct CutCorners {
  double s[kMostBoxCorners], t[kMostBoxCorners];
  unsigned tag[kMostBoxCorners];
  int count;
};

/// What a corner is made of, and the edge that leaves it, by the vertex of its box that it starts at; of B's with kOfB.
constexpr unsigned kOfB = 16, kEdgeBits = 5, kEdge = (1U << kEdgeBits) - 1;
PD_INLINE unsigned tag_of(IdKind kind, unsigned a, unsigned b, unsigned edge) {
  return (static_cast<unsigned>(kind) << 8 | a << 4 | b) << kEdgeBits | edge;
}
/// Of the crossing of a line of the window with an edge.
PD_INLINE unsigned tag_of_crossing(unsigned edge_here, unsigned line, bool leaves) {
  const unsigned edge = leaves ? line | kOfB : edge_here;
  // Two edges of the window meet where the later one starts.
  return (edge_here & kOfB) != 0 ? tag_of(IdKind::vertex_b, 0, leaves ? line : edge_here & ~kOfB, edge)
                                 : tag_of(IdKind::crossing, edge_here, line, edge);
}

PD_INLINE void put(CutCorners& to, int i, const CutCorners& from, int k) {
  to.s[i] = from.s[k];
  to.t[i] = from.t[k];
  to.tag[i] = from.tag[k];
}

/// A line of the window: what lies to its left has 1 + sign * (s or t) > 0.
enum class Across : bool { s, t };

PD_INLINE bool any(const Flags& flags) { return (flags[0] | flags[1] | flags[2] | flags[3]) != 0; }
/// From lane to lane, by one and by two.
PD_INLINE void turn(Lanes& to, const Lanes& from) { to = __builtin_shufflevector(from, from, 1, 2, 3, 0); }
PD_INLINE void turn_twice(Lanes& to, const Lanes& from) { to = __builtin_shufflevector(from, from, 2, 3, 0, 1); }

/// What lies to the left of a line of the window.
template <Across across, int sign>
PD_INLINE void cut(const CutCorners& from, unsigned line, CutCorners& out) {
  const double* const at = across == Across::s ? from.s : from.t;
  int count = 0;
  double side_here = sign > 0 ? 1 + at[0] : 1 - at[0];
  for (int i = 0; i < from.count; ++i) {
    const int next = i + 1 < from.count ? i + 1 : 0;
    const double side_next = sign > 0 ? 1 + at[next] : 1 - at[next];
    if (side_here >= 0) put(out, count++, from, i);
    if ((side_here > 0 && side_next < 0) || (side_here < 0 && side_next > 0)) {
      const double w = side_here / (side_here - side_next);
      out.s[count] = from.s[i] + w * (from.s[next] - from.s[i]);
      out.t[count] = from.t[i] + w * (from.t[next] - from.t[i]);
      out.tag[count] = tag_of_crossing(from.tag[i] & kEdge, line, side_here > 0);
      ++count;
    } else if (side_here == 0 && side_next < 0 && count > 0) {
      out.tag[count - 1] = (out.tag[count - 1] & ~kEdge) | line | kOfB;
    }
    side_here = side_next;
  }
  out.count = count;
}

/// Cuts by one line, unless nothing is left.
template <Across across, int sign>
PD_INLINE void cut_by(unsigned line, CutCorners (&corners)[2], int& held) {
  if (corners[held].count == 0) return;
  cut<across, sign>(corners[held], line, corners[1 - held]);
  held = 1 - held;
}

/// Whether a corner is next to one that is kept.
PD_INLINE bool repeated(const BoxCorners& kept, double s, double t, double merge_s, double merge_t) {
  for (int i = 0; i < kept.count; ++i) {
    if (unsigned_of(kept.s[i] - s) <= merge_s && unsigned_of(kept.t[i] - t) <= merge_t) return true;
  }
  return false;
}

PD_INLINE void write(double (&to)[3], const PlainVector& from) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

/// Depth of A's plane below centre + s first + t second, along the normal, is at_centre + s along_s + t along_t.
struct FaceSlope {
  double at_centre, along_s, along_t;
};

/// Of four numbers.
PD_INLINE double range(const Lanes& x) {
  Lanes turned, turned_twice;
  turn_twice(turned_twice, x);
  const Lanes less = turned_twice < x ? turned_twice : x, more = turned_twice < x ? x : turned_twice;
  turn(turned, less);
  const double least = less_of(less[0], turned[0]);
  turn(turned, more);
  return more_of(more[0], turned[0]) - least;
}

PD_INLINE void set_size(double range_s, double range_t, const BoxFace& face_b, BoxCorners& out) {
  out.size = 0.5 * more_of(range_s * face_b.length_first, range_t * face_b.length_second);
}

/// All corners at once. @return false: they are not four, one lies beyond the threshold, or two are one.
PD_INLINE bool lift_four(const CutCorners& polygon, const BoxFace& face_b, const FaceSlope& slope, double signed_depth,
                         double breaking_threshold, BoxCorners& out) {
  if (polygon.count != 4) return false;
  Lanes s, t;
  load(s, polygon.s);
  load(t, polygon.t);
  set_size(range(s), range(t), face_b, out);
  const double merge_s = kMergeRatio * out.size / face_b.length_first;
  const double merge_t = kMergeRatio * out.size / face_b.length_second;
  Lanes turned_s, turned_t;
  turn(turned_s, s);
  turn(turned_t, t);
  const Lanes next_s = magnitude(s - turned_s), next_t = magnitude(t - turned_t);
  turn_twice(turned_s, s);
  turn_twice(turned_t, t);
  const Lanes across_s = magnitude(s - turned_s), across_t = magnitude(t - turned_t);
  Lanes depth = slope.at_centre + s * slope.along_s + t * slope.along_t;
  depth = depth > signed_depth ? Lanes{} + signed_depth : depth;
  if (any(((next_s <= merge_s) & (next_t <= merge_t)) | ((across_s <= merge_s) & (across_t <= merge_t)) |
          (depth < -breaking_threshold))) {
    return false;
  }
  store(out.s, s);
  store(out.t, t);
  store(out.depth, depth);
  for (int i = 0; i < 4; ++i) {
    out.kind[i] = static_cast<std::uint16_t>(polygon.tag[i] >> kEdgeBits);
    out.deepest = more_of(out.deepest, depth[i]);
  }
  out.count = 4;
  return true;
}

PD_INLINE void lift_each(const CutCorners& polygon, const BoxFace& face_b, const FaceSlope& slope, double signed_depth,
                         double breaking_threshold, BoxCorners& out) {
  if (polygon.count == 0) return;
  double least_s = polygon.s[0], most_s = least_s, least_t = polygon.t[0], most_t = least_t;
  for (int i = 1; i < polygon.count; ++i) {
    least_s = less_of(least_s, polygon.s[i]);
    most_s = more_of(most_s, polygon.s[i]);
    least_t = less_of(least_t, polygon.t[i]);
    most_t = more_of(most_t, polygon.t[i]);
  }
  set_size(most_s - least_s, most_t - least_t, face_b, out);
  const double merge_s = kMergeRatio * out.size / face_b.length_first;
  const double merge_t = kMergeRatio * out.size / face_b.length_second;
  for (int i = 0; i < polygon.count; ++i) {
    const double s = polygon.s[i], t = polygon.t[i];
    const double depth = less_of(slope.at_centre + s * slope.along_s + t * slope.along_t, signed_depth);
    if (depth < -breaking_threshold || repeated(out, s, t, merge_s, merge_t)) continue;
    out.s[out.count] = s;
    out.t[out.count] = t;
    out.depth[out.count] = depth;
    out.kind[out.count] = static_cast<std::uint16_t>(polygon.tag[i] >> kEdgeBits);
    ++out.count;
    out.deepest = more_of(out.deepest, depth);
  }
  for (int i = out.count; i < 4; ++i) out.s[i] = out.t[i] = out.depth[i] = 0;  // `points_at_corners` reads four
}

}  // namespace

PD_CLONES void box_corners(const BoxInRows& a, const BoxInRows& b, const double (&centre_b)[3], const double (&n)[3],
                           double signed_depth, double breaking_threshold, BoxCorners& out) {
  const PlainVector normal = {n[0], n[1], n[2]};
  BoxFace face_a, face_b;
  face_towards(a, {0, 0, 0}, {-n[0], -n[1], -n[2]}, true, face_a);
  face_towards(b, {centre_b[0], centre_b[1], centre_b[2]}, normal, false, face_b);
  write(out.centre, face_b.centre);
  write(out.first, face_b.first);
  write(out.second, face_b.second);
  // x = centre of B's face + s first + t second + h n
  const PlainVector across_first = plain_cross(normal, face_b.first),
                    across_second = plain_cross(face_b.second, normal);
  const double per_area = 1 / plain_dot(face_b.first, across_second);
  const PlainVector s_of = per_area * across_second, t_of = per_area * across_first;
  const PlainVector from_b = face_a.centre - face_b.centre;
  const double s = plain_dot(from_b, s_of), t = plain_dot(from_b, t_of);
  const double s1 = plain_dot(face_a.first, s_of), t1 = plain_dot(face_a.first, t_of);
  const double s2 = plain_dot(face_a.second, s_of), t2 = plain_dot(face_a.second, t_of);
  CutCorners corners[2];
  int held = 0;
  corners[0].count = 4;
  // As `contact_manifold` does: solvers take points in this order, and under ten iterations a tower of twenty stands
  // 4.4 seconds when the first is at minus the first edge, 3.0 to 4.1 when the loop starts elsewhere.
  const double at_s[4] = {s + (s1 - s2), s + (s1 + s2), s - (s1 - s2), s - (s1 + s2)};
  const double at_t[4] = {t + (t1 - t2), t + (t1 + t2), t - (t1 - t2), t - (t1 + t2)};
  for (int i = 0; i < 4; ++i) {
    const unsigned id = face_a.ids[(i + 1) & 3];
    corners[0].s[i] = at_s[i];
    corners[0].t[i] = at_t[i];
    corners[0].tag[i] = tag_of(IdKind::vertex_a, id, 0, id);
  }
  const double reach_s = unsigned_of(s1) + unsigned_of(s2), reach_t = unsigned_of(t1) + unsigned_of(t2);
  // Along the window's loop.
  if (!(t - reach_t >= -1)) cut_by<Across::t, 1>(face_b.ids[0], corners, held);
  if (!(s + reach_s <= 1)) cut_by<Across::s, -1>(face_b.ids[1], corners, held);
  if (!(t + reach_t <= 1)) cut_by<Across::t, -1>(face_b.ids[2], corners, held);
  if (!(s - reach_s >= -1)) cut_by<Across::s, 1>(face_b.ids[3], corners, held);

  // The plane of A is that of its edges: columns of a rotation in single precision are at right angles up to 1e-7 only.
  const PlainVector across = plain_cross(face_a.first, face_a.second);
  const double along_normal = plain_dot(across, normal);
  const PlainVector slope = {across.x / along_normal, across.y / along_normal, across.z / along_normal};
  const FaceSlope of_a = {plain_dot(face_b.centre - face_a.centre, slope), plain_dot(face_b.first, slope),
                          plain_dot(face_b.second, slope)};
  out.count = 0;
  out.size = 0;
  out.deepest = -breaking_threshold;
  const CutCorners& polygon = corners[held];
  if (!lift_four(polygon, face_b, of_a, signed_depth, breaking_threshold, out)) {
    lift_each(polygon, face_b, of_a, signed_depth, breaking_threshold, out);
  }
}

PD_CLONES void points_at_corners(const BoxCorners& corners, const double (&n)[3], const double (&origin)[3],
                                 double (&out)[4][8]) {
  Lanes s, t, depth;
  load(s, corners.s);
  load(t, corners.t);
  load(depth, corners.depth);
  const double* const c = corners.centre;
  const double* const u = corners.first;
  const double* const v = corners.second;
  const Lanes zero = {0, 0, 0, 0};
  const Lanes b[3] = {c[0] + s * u[0] + t * v[0] + origin[0], c[1] + s * u[1] + t * v[1] + origin[1],
                      c[2] + s * u[2] + t * v[2] + origin[2]};
  const Lanes columns[8] = {
      b[0] - depth * n[0], b[1] - depth * n[1], b[2] - depth * n[2], b[0], b[1], b[2], depth, zero};
  for (int half = 0; half < 2; ++half) {
    const Lanes* const of = columns + 4 * half;
    const Lanes low_01 = __builtin_shufflevector(of[0], of[1], 0, 4, 2, 6);
    const Lanes high_01 = __builtin_shufflevector(of[0], of[1], 1, 5, 3, 7);
    const Lanes low_23 = __builtin_shufflevector(of[2], of[3], 0, 4, 2, 6);
    const Lanes high_23 = __builtin_shufflevector(of[2], of[3], 1, 5, 3, 7);
    store(out[0] + 4 * half, __builtin_shufflevector(low_01, low_23, 0, 1, 4, 5));
    store(out[1] + 4 * half, __builtin_shufflevector(high_01, high_23, 0, 1, 4, 5));
    store(out[2] + 4 * half, __builtin_shufflevector(low_01, low_23, 2, 3, 6, 7));
    store(out[3] + 4 * half, __builtin_shufflevector(high_01, high_23, 2, 3, 6, 7));
  }
}

}  // namespace pd::detail
