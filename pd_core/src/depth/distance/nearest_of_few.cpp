#include "depth/distance/nearest_of_few.hpp"

#include "depth/distance/simplex_lanes.hpp"

namespace pd::detail {

namespace {

constexpr int kMostSupports = 32;

PD_INLINE bool is_corner(const NearestLaneFace& face, const LanePoint& s) {
  for (int i = 0; i < 3; ++i) {
    if (i < face.count && face.corners[i].a == s.a && face.corners[i].b == s.b) return true;
  }
  return false;
}

PD_INLINE LanePoint vertex(const FewVertices& bodies, int a, int b) {
  return {(bodies.b.x[b] + bodies.a.x[a]) + bodies.offset[0], (bodies.b.y[b] + bodies.a.y[a]) + bodies.offset[1],
          (bodies.b.z[b] + bodies.a.z[a]) + bodies.offset[2], a, b};
}

PD_INLINE Direction turned(const double* r, double x, double y, double z) {
  return {r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z, r[2] * x + r[5] * y + r[8] * z};
}
PD_INLINE Direction into_frame(const double* r, const Direction& d) {
  return {r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
          r[6] * d.x + r[7] * d.y + r[8] * d.z};
}
PD_INLINE VertexPair farthest_in_frames(const FewVerticesInFrames& bodies, const Direction& d) {
  return {farthest(bodies.a, into_frame(bodies.rotation_a, {-d.x, -d.y, -d.z})),
          farthest(bodies.b, into_frame(bodies.rotation_b, d))};
}

PD_INLINE void put(double (&out)[3], double x, double y, double z) {
  out[0] = x;
  out[1] = y;
  out[2] = z;
}
/// The plane of a support.
PD_INLINE void put_plane(NearestOfFew& out, const LanePoint& s, const Direction& d) {
  put(out.direction, d.x, d.y, d.z);
  out.height = -dot(s, d);
  out.support = {s.a, s.b};
}
PD_INLINE void put_ids(NearestOfFew& out, const NearestLaneFace& face) {
  out.count = face.count;
  for (int i = 0; i < face.count; ++i) out.simplex[i] = {face.corners[i].a, face.corners[i].b};
}
PD_INLINE void put_face(NearestOfFew& out, const NearestLaneFace& face) {
  out.status = NearestOfFew::Status::nearest;
  out.count = face.count;
  for (int i = 0; i < face.count; ++i) {
    const LanePoint& p = face.corners[i];
    out.simplex[i] = {p.a, p.b};
    put(out.points[i], p.x, p.y, p.z);
    out.weights[i] = face.weights[i];
  }
}

}  // namespace

PD_CLONES NearestOfFew nearest_of_few(const FewVertices& bodies, const VertexPair* start, int count,
                                      const NearestGoal& goal) {
  NearestOfFew out;
  NearestLaneFace face{};
  for (int step = 0; step < kMostSupports; ++step) {
    LanePoint s;
    if (step < count) {
      s = vertex(bodies, start[step].a, start[step].b);
    } else {
      const Direction d = face.toward;
      s = vertex(bodies, farthest(bodies.a, d), farthest(bodies.b, d));
      ++out.supports;
      put_plane(out, s, d);
      if (out.height > goal.beyond) {
        out.status = NearestOfFew::Status::beyond;
        put_ids(out, face);
        return out;
      }
      if (face.length - out.height <= goal.gap || is_corner(face, s)) break;
    }
    const double length = face.length;
    if (!add_vertex(face, s)) {
      out.status = NearestOfFew::Status::enclosed;
      put_ids(out, face);
      out.simplex[out.count++] = {s.a, s.b};
      return out;
    }
    // Supports that rounding takes for farther ones.
    if (step >= count && !(face.length < length)) break;
    if (!(face.length > goal.within)) return out;
  }
  put_face(out, face);
  return out;
}

PD_CLONES bool add_to_face(NearestLaneFace& face, const LanePoint& s) { return add_vertex(face, s); }

NearestOfFew nearest_on_simplex(const LanePoint* corners, int count) {
  NearestOfFew out;
  NearestLaneFace face{};
  // What most frames find again, else from the start.
  const bool inside = count == 3   ? take_triangle(face, corners[0], corners[1], corners[2])
                      : count == 2 ? take_edge(face, corners[0], corners[1])
                                   : false;
  if (!inside) {
    for (int i = 0; i < count; ++i) (void)add_to_face(face, corners[i]);
  }
  put_face(out, face);
  put(out.direction, face.toward.x, face.toward.y, face.toward.z);
  return out;
}

PD_CLONES SupportOfFew support_of_few(const FewVerticesInFrames& bodies, const double (&direction)[3]) {
  SupportOfFew out;
  out.ids = farthest_in_frames(bodies, {direction[0], direction[1], direction[2]});
  const auto [a, b] = out.ids;
  const Direction on_a = turned(bodies.rotation_a, bodies.a.x[a], bodies.a.y[a], bodies.a.z[a]);
  const Direction on_b = turned(bodies.rotation_b, bodies.b.x[b], bodies.b.y[b], bodies.b.z[b]);
  put(out.on_a, on_a.x, on_a.y, on_a.z);
  put(out.on_b, on_b.x, on_b.y, on_b.z);
  return out;
}

}  // namespace pd::detail
