#include "depth/remembered_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace pd::detail {

namespace {

/// More faces that may be near are dearer than all planes at once.
constexpr int kMaxNear = 8;
static_assert(kMaxNear % kPlaneBlock == 0);

/// Errors of points, planes and of the movement itself, in units of the reach: the first two are below 19u each, the
/// movement errs by the rounding of two rotations and of the offset (4u sqrt(3) each, twice) and of its sum.
constexpr double kSlack = 0x1p-45;
/// Of a plane's level, in units of reach^3: the normal errs by 6u |edge|^2 (edges up to twice the reach) in every
/// component, the products by 3u |normal| |x|.
constexpr double kLevelSlack = 0x1p-45;

double cube(double x) { return x * x * x; }

/// No point of the remembered surface has moved farther than this since the reference.
double movement(const WarmCertificate::Reference& since, const PolytopeDifference& now) {
  const double turn_a = (now.rotation_a() - since.rotation_a).norm() * now.a().radius();
  const double turn_b = (now.rotation_b() - since.rotation_b).norm() * now.b().radius();
  return (turn_a + turn_b + (now.offset() - since.offset).norm()) * (1 + 0x1p-40) + kSlack * now.reach();
}

struct NearFaces {
  std::int32_t faces[kMaxNear];
  std::int32_t p[kMaxNear], q[kMaxNear], r[kMaxNear];
  double nx[kMaxNear], ny[kMaxNear], nz[kMaxNear], levels[kMaxNear], keys[kMaxNear];
  int count = 0;
};

}  // namespace

void project_origin(const DifferenceVertex (&corners)[3], const Vec3& normal, double (&weights)[3]) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    weights[i] = normal.dot(corners[(i + 1) % 3].x.cross(corners[(i + 2) % 3].x));
    sum += weights[i];
  }
  for (double& w : weights) w /= sum;
}

void set_reference(WarmCertificate::State& state, Surface& surface, const PolytopeDifference& difference) {
  WarmCertificate::Reference& r = state.reference;
  if (!r.a || !r.a->same_storage(difference.a())) r.a = difference.a();
  if (!r.b || !r.b->same_storage(difference.b())) r.b = difference.b();
  r.rotation_a = difference.rotation_a();
  r.rotation_b = difference.rotation_b();
  r.offset = difference.offset();
  r.nearest = std::sqrt(surface.key(surface.nearest()));
  r.largest = 0;
  for (const DifferenceVertex& v : surface.vertices) r.largest = std::max(r.largest, v.x.cwiseAbs().maxCoeff());
  const double reach = difference.reach();
  const double clearance = surface.clearance(difference.centre(), kLevelSlack * cube(reach));
  // Deep inside, or else the origin itself.
  if (clearance > r.nearest * r.nearest) {
    r.inner = difference.centre();
    r.clearance = std::sqrt(clearance) - kSlack * reach;
  } else {
    r.inner = Vec3::Zero();
    r.clearance = r.nearest - kSlack * reach;
  }
}

bool nearest_remembered(const WarmCertificate::State& state, const PolytopeDifference& difference,
                        RememberedFace& out) {
  const WarmCertificate::Reference& r = state.reference;
  if (!(r.clearance > 0)) return false;
  const double moved = movement(r, difference);
  if (!(moved < r.clearance)) return false;

  NearFaces near;
  const double limit = r.nearest + 2 * moved;
  const int face_count = static_cast<int>(state.faces.size());
  for (int from = 0; from < face_count; from += 64) {
    std::uint64_t bits = keys_up_to(r.keys.data() + from, std::min(64, face_count - from), limit * limit);
    if (near.count + std::popcount(bits) > kMaxNear) return false;
    for (; bits != 0; bits &= bits - 1) near.faces[near.count++] = from + std::countr_zero(bits);
  }
  if (near.count == 0) return false;

  DifferenceVertex vertices[3 * kMaxNear];
  std::int32_t ids[3 * kMaxNear];
  int vertex_count = 0;
  const auto posed = [&](std::int16_t id) {
    for (int i = 0; i < vertex_count; ++i) {
      if (ids[i] == id) return i;
    }
    const WarmCertificate::CachedVertex& v = state.vertices[static_cast<std::size_t>(id)];
    ids[vertex_count] = id;
    vertices[vertex_count] = difference.turned_vertex(v.a, v.b);
    return vertex_count++;
  };
  for (int i = 0; i < near.count; ++i) {
    const WarmCertificate::CachedFace& face = state.faces[static_cast<std::size_t>(near.faces[i])];
    near.p[i] = posed(face.vertex[0]);
    near.q[i] = posed(face.vertex[1]);
    near.r[i] = posed(face.vertex[2]);
  }
  for (int i = near.count; i < kMaxNear; ++i) near.p[i] = near.q[i] = near.r[i] = 0;
  triangle_planes(vertices[0].x.data(), {near.p, near.q, near.r}, 0, near.count,
                  {near.nx, near.ny, near.nz, near.levels, near.keys});

  const double level_slack = kLevelSlack * cube(difference.reach());
  int nearest = 0;
  for (int i = 0; i < near.count; ++i) {
    const double inner_level = near.nx[i] * r.inner.x() + near.ny[i] * r.inner.y() + near.nz[i] * r.inner.z();
    if (!(near.levels[i] - inner_level > level_slack)) return false;
    if (near.keys[i] < near.keys[nearest]) nearest = i;
  }
  if (!(near.keys[nearest] > 0)) return false;
  out.distance = std::sqrt(near.keys[nearest]);
  if (out.distance > r.nearest + moved) return false;
  out.normal = Vec3(near.nx[nearest], near.ny[nearest], near.nz[nearest]);
  out.largest = r.largest - moved;
  out.faces_seen = near.count;

  const auto take = [&](int i) {
    out.corners[0] = vertices[near.p[i]];
    out.corners[1] = vertices[near.q[i]];
    out.corners[2] = vertices[near.r[i]];
    project_origin(out.corners, out.normal, out.weights);
    return std::min({out.weights[0], out.weights[1], out.weights[2]}) >= 0;
  };
  if (take(nearest)) return true;
  const double level = out.distance + 64 * 0x1p-53 * difference.reach();
  for (int i = 0; i < near.count; ++i) {
    if (i != nearest && near.keys[i] <= level * level && take(i)) return true;
  }
  take(nearest);
  return true;
}

}  // namespace pd::detail
