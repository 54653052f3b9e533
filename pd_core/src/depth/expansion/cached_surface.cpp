#include "depth/expansion/cached_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "depth/difference/barycentric.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// More faces that may be near are dearer than all planes at once.
constexpr int kMaxNear = 16;
static_assert(kMaxNear % kPlaneBlock == 0);

/// Errors of points, planes and of the movement itself, in units of the reach: the first two are below 19u each, the
/// movement errs by the rounding of two rotations and of the offset (4u sqrt(3) each, twice) and of its sum.
constexpr double kSlack = 0x1p-45;
/// Of comparisons in single precision, in units of the reach: each operand is within 2^-23 of itself.
constexpr double kFloatSlack = 0x1p-20;
/// Of a plane's level, in units of reach^3: the normal errs by 6u |edge|^2 (edges up to twice the reach) in every
/// component, the products by 3u |normal| |x|.
constexpr double kLevelSlack = 0x1p-45;

double cube(double x) { return x * x * x; }

/// No point of the remembered surface whose spread is s has moved farther than base + turn * s since the reference.
struct Movement {
  double base;
  double turn;
};

Movement movement(const WarmReference& since, const PolytopeDifference& now) {
  const Mat3 turn_a = now.rotation_a() - since.rotation_a;
  const Mat3 turn_b = now.rotation_b() - since.rotation_b;
  const Vec3 base =
      (turn_b * now.b().vertex(since.base.b) - turn_a * now.a().vertex(since.base.a)) + (now.offset() - since.offset);
  return {base.norm() + kSlack * now.reach(), std::sqrt(std::max(turn_a.squaredNorm(), turn_b.squaredNorm()))};
}

struct NearFaces {
  std::int32_t faces[kMaxNear];
  std::int32_t p[kMaxNear], q[kMaxNear], r[kMaxNear];
  double nx[kMaxNear], ny[kMaxNear], nz[kMaxNear], levels[kMaxNear], keys[kMaxNear];
  int count = 0;
};

}  // namespace

void set_reference(WarmState& state, InnerSurface& surface, const PolytopeDifference& difference) {
  WarmReference& r = state.reference;
  if (!r.a || !r.a->same_storage(difference.a())) r.a = difference.a();
  if (!r.b || !r.b->same_storage(difference.b())) r.b = difference.b();
  r.rotation_a = difference.rotation_a();
  r.rotation_b = difference.rotation_b();
  r.offset = difference.offset();
  r.uses = 0;
  r.nearest = surface.nearest();
  r.base = state.vertices[static_cast<std::size_t>(surface.face(r.nearest).v[0])];

  // (|a - base| + |b - base|)^2 <= 2 (|a - base|^2 + |b - base|^2)
  double spreads[kMaxRememberedVertices];
  const Vec3 base_a = difference.a().vertex(r.base.a);
  const Vec3 base_b = difference.b().vertex(r.base.b);
  for (std::size_t i = 0; i < state.vertices.size(); ++i) {
    const VertexPair& v = state.vertices[i];
    spreads[i] =
        2 * ((difference.a().vertex(v.a) - base_a).squaredNorm() + (difference.b().vertex(v.b) - base_b).squaredNorm());
  }
  const int count = surface.slots();
  const auto padded = static_cast<std::size_t>(padded_to_block(count));
  r.distances.resize(padded);
  r.spreads.resize(padded);
  r.widest = 0;
  for (int f = 0; f < count; ++f) {
    const SurfaceTriangle& face = surface.face(f);
    const double spread = std::sqrt(std::max({spreads[face.v[0]], spreads[face.v[1]], spreads[face.v[2]]}));
    r.distances[static_cast<std::size_t>(f)] = static_cast<float>(std::sqrt(surface.key(f)));
    r.spreads[static_cast<std::size_t>(f)] = static_cast<float>(spread);
    r.widest = std::max(r.widest, spread);
  }
  std::fill(r.distances.begin() + count, r.distances.end(), std::numeric_limits<float>::infinity());
  std::fill(r.spreads.begin() + count, r.spreads.end(), 0.0F);

  // Deep inside, or else the origin itself.
  const double reach = difference.reach();
  const double clearance = surface.clearance(difference.centre(), kLevelSlack * cube(reach));
  const double nearest = surface.key(r.nearest);
  r.inner = clearance > nearest ? difference.centre() : Vec3::Zero();
  r.clearance = std::sqrt(std::max(clearance, nearest)) - kFloatSlack * reach;
}

namespace {

/// The faces of then whose planes may have come within `limit` of the origin, by number. False where none has, or more
/// than fit.
bool gather_near(const WarmState& state, float turn, double limit, NearFaces& near) {
  const WarmReference& r = state.reference;
  const int face_count = static_cast<int>(state.faces.size());
  for (int from = 0; from < face_count; from += 64) {
    std::uint64_t bits = near_faces(r.distances.data() + from, r.spreads.data() + from, std::min(64, face_count - from),
                                    turn, static_cast<float>(limit));
    for (; bits != 0; bits &= bits - 1) {
      if (near.count == kMaxNear) return false;
      near.faces[near.count++] = from + std::countr_zero(bits);
    }
  }
  return near.count > 0;
}

/// Their corners, each once, at the present poses, and their planes.
void pose_near(const WarmState& state, const PolytopeDifference& difference, NearFaces& near,
               DifferenceVertex* vertices) {
  std::int8_t places[kMaxRememberedVertices];
  std::fill(std::begin(places), std::end(places), std::int8_t{-1});
  VertexPair pairs[3 * kMaxNear];
  int vertex_count = 0;
  const auto place = [&](std::int16_t id) {
    if (places[id] < 0) {
      places[id] = static_cast<std::int8_t>(vertex_count);
      pairs[vertex_count++] = state.vertices[static_cast<std::size_t>(id)];
    }
    return places[id];
  };
  for (int i = 0; i < near.count; ++i) {
    const CachedFace& face = state.faces[static_cast<std::size_t>(near.faces[i])];
    near.p[i] = place(face.vertex[0]);
    near.q[i] = place(face.vertex[1]);
    near.r[i] = place(face.vertex[2]);
  }
  difference.posed_vertices(pairs, vertex_count, vertices);
  for (int i = near.count; i < padded_to_lanes(near.count); ++i) near.p[i] = near.q[i] = near.r[i] = 0;
  triangle_planes(vertices[0].x.data(), {near.p, near.q, near.r}, 0, near.count,
                  {near.nx, near.ny, near.nz, near.levels, near.keys});
}

}  // namespace

bool nearest_remembered(const WarmState& state, const PolytopeDifference& difference, RememberedFace& out) {
  const WarmReference& r = state.reference;
  if (!(r.clearance > 0)) return false;
  const Movement moved = movement(r, difference);
  if (!(moved.base + moved.turn * r.widest < r.clearance)) return false;
  const auto nearest_index = static_cast<std::size_t>(r.nearest);
  // The nearest face of then is no farther now, where the origin still projects into it.
  const double farthest = static_cast<double>(r.distances[nearest_index]) + moved.base +
                          moved.turn * static_cast<double>(r.spreads[nearest_index]) + kFloatSlack * difference.reach();

  NearFaces near;
  const double limit = farthest + moved.base + kFloatSlack * difference.reach();
  if (!gather_near(state, static_cast<float>(moved.turn), limit, near)) return false;
  DifferenceVertex vertices[3 * kMaxNear];
  pose_near(state, difference, near, vertices);

  const double level_slack = kLevelSlack * cube(difference.reach());
  int nearest = 0;
  for (int i = 0; i < near.count; ++i) {
    const double inner_level = near.nx[i] * r.inner.x() + near.ny[i] * r.inner.y() + near.nz[i] * r.inner.z();
    if (!(near.levels[i] - inner_level > level_slack)) return false;
    if (near.keys[i] < near.keys[nearest]) nearest = i;
  }
  if (!(near.keys[nearest] > 0)) return false;
  out.distance = std::sqrt(near.keys[nearest]);
  if (!(out.distance <= farthest)) return false;
  out.normal = Vec3(near.nx[nearest], near.ny[nearest], near.nz[nearest]);
  out.faces_seen = near.count;

  const auto take = [&](int i) {
    out.corners[0] = vertices[near.p[i]];
    out.corners[1] = vertices[near.q[i]];
    out.corners[2] = vertices[near.r[i]];
    project_origin(out.corners, out.normal, out.weights);
    return std::min({out.weights[0], out.weights[1], out.weights[2]}) >= 0;
  };
  if (take(nearest)) return true;
  const double level = out.distance + 64 * kUnitRoundoff * difference.reach();
  for (int i = 0; i < near.count; ++i) {
    if (i != nearest && near.keys[i] <= level * level && take(i)) return true;
  }
  take(nearest);
  return true;
}

}  // namespace pd::detail
