/// @file
/// The face of a simplex nearest to the origin when a vertex has been added to it, four of its faces at a time: a part
/// of every kernel that looks for closest points (instruction_sets.hpp).
///
/// Each step of Gilbert, Johnson and Keerthi 1988 keeps the face that holds the simplex' nearest point. From the second
/// step on it holds the newest vertex, so that three edges and three triangles are all there is to look at: one lane
/// each.
#pragma once

#include <limits>

#include "numeric/lanes.hpp"
#include "shape/support/scan_lanes.hpp"

namespace pd::detail {

/// The normal of a flatter triangle is rounding.
inline constexpr double kLeastSineSquared = 0x1p-52;

/// A vertex of P.
struct LanePoint {
  double x, y, z;
  std::int32_t a = -1, b = -1;
};

struct LaneVectors {
  Lanes x, y, z;
};

/// A face of the simplex in whose relative interior the nearest point lies.
struct NearestLaneFace {
  int count = 0;
  LanePoint corners[3];
  double weights[3];
  Direction toward;   ///< unit; from the nearest point to the origin
  double length = 0;  ///< of the nearest point
};

PD_INLINE double dot(const LanePoint& p, const Direction& d) { return p.x * d.x + p.y * d.y + p.z * d.z; }
PD_INLINE void dot(Lanes& out, const LaneVectors& u, const LaneVectors& v) { out = u.x * v.x + u.y * v.y + u.z * v.z; }
PD_INLINE void cross(LaneVectors& out, const LaneVectors& u, const LaneVectors& v) {
  out.x = u.y * v.z - u.z * v.y;
  out.y = u.z * v.x - u.x * v.z;
  out.z = u.x * v.y - u.y * v.x;
}
/// Lane i holds what lane i + 1 did, of three.
PD_INLINE void turn(Lanes& out, const Lanes& v) { out = __builtin_shufflevector(v, v, 1, 2, 0, 1); }
PD_INLINE void turn(LaneVectors& out, const LaneVectors& v) {
  turn(out.x, v.x);
  turn(out.y, v.y);
  turn(out.z, v.z);
}

/// `toward` along v or against it, whichever leads from the face to the origin.
PD_INLINE void look_back(NearestLaneFace& face, const Direction& v) {
  const double along = dot(face.corners[0], v);
  const double share = 1 / __builtin_sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  const double back = along > 0 ? -share : share;
  face.toward = {back * v.x, back * v.y, back * v.z};
  face.length = -(along * back);
}

PD_INLINE void take_vertex(NearestLaneFace& face, const LanePoint& s) {
  face.count = 1;
  face.corners[0] = s;
  face.weights[0] = 1;
}

/// The face of the old one and the vertex s that holds the point nearest to the origin, among those that hold s, and
/// the normal of that face there, of any length. False where the tetrahedron of all four holds the origin.
PD_INLINE bool take_nearest_face(NearestLaneFace& face, const LanePoint& s, Direction& normal) {
  // Lane i: the edge from s to corner i, and the triangle with corner i + 1. Corners that are not there repeat others,
  // and what they span is flat.
  const int second = face.count > 1 ? 1 : 0, third = face.count > 2 ? 2 : 0;
  const LanePoint p[3] = {face.corners[0], face.corners[second], face.corners[third]};
  const LaneVectors to_s = {Lanes{s.x, s.x, s.x, s.x}, Lanes{s.y, s.y, s.y, s.y}, Lanes{s.z, s.z, s.z, s.z}};
  const LaneVectors e = {Lanes{p[0].x, p[1].x, p[2].x, p[0].x} - to_s.x, Lanes{p[0].y, p[1].y, p[2].y, p[0].y} - to_s.y,
                         Lanes{p[0].z, p[1].z, p[2].z, p[0].z} - to_s.z};
  LaneVectors next_e, n, c, next_c;
  turn(next_e, e);
  cross(n, e, next_e);
  cross(c, e, to_s);
  turn(next_c, c);
  Lanes ee, along, cc, nn, level, weight, next_weight, next_ee;
  dot(ee, e, e);
  dot(along, e, to_s);
  dot(cc, c, c);
  dot(nn, n, n);
  dot(level, n, to_s);
  dot(weight, n, next_c);
  dot(next_weight, n, c);
  turn(next_ee, ee);
  along = -along;
  next_weight = -next_weight;
  const Lanes zero = {0, 0, 0, 0};
  if (face.count == 3) {
    // The origin lies on the inner side of a triangle where the third corner does.
    const double volume = n.x[0] * e.x[2] + n.y[0] * e.y[2] + n.z[0] * e.z[2];
    if ((mask_of_four(level * volume < zero) & 7U) == 7U) return false;
  }
  const Lanes own_weight = nn - weight - next_weight;
  const Flags in_triangle =
      (weight > zero) & (next_weight > zero) & (own_weight > zero) & (nn > kLeastSineSquared * (ee * next_ee));
  const Flags in_edge = (along > zero) & (along < ee);
  const Lanes none = zero + std::numeric_limits<double>::infinity();
  const Lanes triangle = in_triangle ? level * level / nn : none;
  const Lanes edge = in_edge ? cc / ee : none;
  const double nearest = least(edge < triangle ? edge : triangle);
  if (!(nearest < s.x * s.x + s.y * s.y + s.z * s.z)) {
    take_vertex(face, s);
    normal = {s.x, s.y, s.z};
    return true;
  }
  const Lanes in_lanes = zero + nearest;
  const unsigned triangles = mask_of_four(triangle == in_lanes);
  if (triangles != 0) {
    const int i = __builtin_ctz(triangles);
    face.count = 3;
    face.corners[0] = p[i];
    face.corners[1] = p[i == 2 ? 0 : i + 1];
    face.corners[2] = s;
    const double share = 1 / nn[i];
    face.weights[0] = share * weight[i];
    face.weights[1] = share * next_weight[i];
    face.weights[2] = share * own_weight[i];
    normal = {n.x[i], n.y[i], n.z[i]};
    return true;
  }
  const int i = __builtin_ctz(mask_of_four(edge == in_lanes));
  face.count = 2;
  face.corners[0] = p[i];
  face.corners[1] = s;
  face.weights[0] = along[i] / ee[i];
  face.weights[1] = 1 - face.weights[0];
  // Across the edge whatever rounding did to the weights: c x e is the nearest point times |e|^2.
  normal = {c.y[i] * e.z[i] - c.z[i] * e.y[i], c.z[i] * e.x[i] - c.x[i] * e.z[i], c.x[i] * e.y[i] - c.y[i] * e.x[i]};
  return true;
}

/// Adds a vertex. False where the origin lies inside the simplex.
PD_INLINE bool add_vertex(NearestLaneFace& face, const LanePoint& s) {
  Direction normal{s.x, s.y, s.z};
  if (face.count == 0) {
    take_vertex(face, s);
  } else if (!take_nearest_face(face, s, normal)) {
    return false;
  }
  look_back(face, normal);
  return true;
}

/// The two of an edge, where the nearest point lies inside of it. False, and nothing done, where it does not.
PD_INLINE bool take_edge(NearestLaneFace& face, const LanePoint& p, const LanePoint& s) {
  const Direction e{p.x - s.x, p.y - s.y, p.z - s.z};
  const double along = -dot(s, e), ee = e.x * e.x + e.y * e.y + e.z * e.z;
  if (!(along > 0 && along < ee)) return false;
  face.count = 2;
  face.corners[0] = p;
  face.corners[1] = s;
  face.weights[0] = along / ee;
  face.weights[1] = 1 - face.weights[0];
  // (e x s) x e, as above
  const Direction c{e.y * s.z - e.z * s.y, e.z * s.x - e.x * s.z, e.x * s.y - e.y * s.x};
  look_back(face, {c.y * e.z - c.z * e.y, c.z * e.x - c.x * e.z, c.x * e.y - c.y * e.x});
  return true;
}

/// The three of a triangle, where the nearest point lies inside of it. False, and nothing done, where it does not.
PD_INLINE bool take_triangle(NearestLaneFace& face, const LanePoint& p, const LanePoint& q, const LanePoint& s) {
  const Direction e{p.x - s.x, p.y - s.y, p.z - s.z}, f{q.x - s.x, q.y - s.y, q.z - s.z};
  const Direction n{e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
  const double nn = n.x * n.x + n.y * n.y + n.z * n.z;
  const double ee = e.x * e.x + e.y * e.y + e.z * e.z, ff = f.x * f.x + f.y * f.y + f.z * f.z;
  // <n, f x s> and <n, s x e>
  const double of_p = n.x * (f.y * s.z - f.z * s.y) + n.y * (f.z * s.x - f.x * s.z) + n.z * (f.x * s.y - f.y * s.x);
  const double of_q = n.x * (s.y * e.z - s.z * e.y) + n.y * (s.z * e.x - s.x * e.z) + n.z * (s.x * e.y - s.y * e.x);
  const double of_s = nn - of_p - of_q;
  if (!(of_p > 0 && of_q > 0 && of_s > 0 && nn > kLeastSineSquared * (ee * ff))) return false;
  const double share = 1 / nn;
  face.count = 3;
  face.corners[0] = p;
  face.corners[1] = q;
  face.corners[2] = s;
  face.weights[0] = share * of_p;
  face.weights[1] = share * of_q;
  face.weights[2] = share * of_s;
  look_back(face, n);
  return true;
}

}  // namespace pd::detail
