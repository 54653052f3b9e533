#include "depth/expansion/surface_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "numeric/double_double.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

using SnapshotFace = SurfaceSnapshot::Face;

constexpr std::int32_t next(std::int32_t e) { return e == 2 ? 0 : e + 1; }
constexpr std::int32_t last(std::int32_t e) { return e == 0 ? 2 : e - 1; }

class Check {
 public:
  explicit Check(const SurfaceSnapshot& surface) : surface_(surface) {
    for (const Vec3& x : surface.points) radius_ = std::max(radius_, x.norm());
  }

  [[nodiscard]] bool links(int f) const {
    for (std::int32_t e = 0; e < 3; ++e) {
      const std::int32_t beyond = face(f).adj[e];
      if (face(f).v[e] < 0 || face(f).v[e] >= static_cast<std::int32_t>(surface_.points.size())) return false;
      if (beyond < 0 || beyond >> 2 >= static_cast<std::int32_t>(surface_.faces.size()) || (beyond & 3) == 3) {
        return false;
      }
      if (face(beyond >> 2).adj[beyond & 3] != 4 * f + e) return false;
    }
    return true;
  }

  /// Requires links.
  [[nodiscard]] bool senses(int f) const {
    for (std::int32_t e = 0; e < 3; ++e) {
      const std::int32_t from = face(f).v[e], to = face(f).v[next(e)];
      const SnapshotFace& other = face(face(f).adj[e] >> 2);
      const std::int32_t h = face(f).adj[e] & 3;
      if (from == to || other.v[h] != to || other.v[next(h)] != from) return false;
    }
    return true;
  }

  /// A lower bound without a normal says nothing, so it cannot be wrong.
  [[nodiscard]] bool keys(int f) const {
    const Vec3& n = face(f).normal;
    if (std::isnan(face(f).distance)) return false;
    if (!(n.squaredNorm() > 0)) return face(f).distance < -radius_ / 2;
    const DoubleDouble length = sqrt(dot(n, n));
    double least = std::numeric_limits<double>::infinity();
    for (const std::int32_t v : face(f).v) least = std::min(least, to_double(dot(point(v), n) / length));
    // Distances are kept as squares, made from squares of <n, p>, which underflow where cores are as small beside their
    // margins as 1e-70: nothing beside these, but not beside the cores.
    const double underflow = 0x1p-511 / to_double(length);
    return face(f).distance <= least + rounding() + underflow;
  }

  [[nodiscard]] bool nearest() const {
    const int f = surface_.nearest;
    if (f < 0 || f >= static_cast<int>(surface_.faces.size())) return false;
    return std::none_of(surface_.faces.begin(), surface_.faces.end(),
                        [&](const SnapshotFace& other) { return other.distance < face(f).distance; });
  }

  /// The solid angles of the faces (Van Oosterom and Strackee 1983) over that of the sphere.
  [[nodiscard]] bool winding() const {
    double angles = 0;
    for (const SnapshotFace& f : surface_.faces) {
      if (!(f.distance > rounding())) return true;
      const Vec3 &p = point(f.v[0]), &q = point(f.v[1]), &r = point(f.v[2]);
      const double a = p.norm(), b = q.norm(), c = r.norm();
      // The origin lies behind the face, as its distance says; beside it, the product may have lost its sign.
      const double volume = p.dot(q.cross(r));
      const double sure = std::abs(volume) > 16 * kUnitRoundoff * a * b * c ? volume : std::abs(volume);
      angles += 2 * std::atan2(sure, a * b * c + p.dot(q) * c + q.dot(r) * a + r.dot(p) * b);
    }
    return std::round(angles / (4 * std::numbers::pi)) >= 1;
  }

  /// Convex along every edge; closed, and once around the origin, that makes it convex.
  [[nodiscard]] bool convex(int f) const {
    for (std::int32_t e = 0; e < 3; ++e) {
      const std::int32_t beyond = face(f).adj[e];
      const std::int32_t apex = face(beyond >> 2).v[last(beyond & 3)];
      if (orient3d(point(face(f).v[0]), point(face(f).v[1]), point(face(f).v[2]), point(apex)) > 0) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] const SnapshotFace& face(int f) const { return surface_.faces[static_cast<std::size_t>(f)]; }
  [[nodiscard]] const Vec3& point(std::int32_t v) const { return surface_.points[static_cast<std::size_t>(v)]; }
  static DoubleDouble dot(const Vec3& x, const Vec3& y) {
    return two_product(x.x(), y.x()) + two_product(x.y(), y.y()) + two_product(x.z(), y.z());
  }
  /// Of a distance computed from stored points, see `face_error`.
  [[nodiscard]] double rounding() const { return 8 * kUnitRoundoff * radius_; }

  const SurfaceSnapshot& surface_;
  double radius_ = 0;
};

}  // namespace

std::string_view to_string(SurfaceRule rule) {
  switch (rule) {
    case SurfaceRule::links:
      return "links of neighbours";
    case SurfaceRule::senses:
      return "opposite senses along an edge";
    case SurfaceRule::keys:
      return "distances are lower bounds";
    case SurfaceRule::nearest:
      return "the nearest face";
    case SurfaceRule::winding:
      return "winding number of the origin";
    case SurfaceRule::convex:
      return "convexity";
  }
  return "";
}

std::optional<SurfaceFault> find_fault(const SurfaceSnapshot& surface, bool convex) {
  const Check check(surface);
  const int count = static_cast<int>(surface.faces.size());
  const auto first_broken = [&](SurfaceRule rule, bool (Check::*keeps)(int) const) -> std::optional<SurfaceFault> {
    for (int f = 0; f < count; ++f) {
      if (!(check.*keeps)(f)) return SurfaceFault{rule, f};
    }
    return std::nullopt;
  };
  if (const auto fault = first_broken(SurfaceRule::links, &Check::links)) return fault;
  if (const auto fault = first_broken(SurfaceRule::senses, &Check::senses)) return fault;
  if (const auto fault = first_broken(SurfaceRule::keys, &Check::keys)) return fault;
  if (!check.nearest()) return SurfaceFault{SurfaceRule::nearest, surface.nearest};
  if (!check.winding()) return SurfaceFault{SurfaceRule::winding, -1};
  if (convex) return first_broken(SurfaceRule::convex, &Check::convex);
  return std::nullopt;
}

void report_fault(const SurfaceSnapshot& surface, const SurfaceFault& fault) {
  const std::string_view rule = to_string(fault.rule);
  std::fprintf(stderr, "pdepth: an expanding polytope breaks the rule \"%.*s\" at face %d of %zu\n",
               static_cast<int>(rule.size()), rule.data(), fault.face, surface.faces.size());
  for (const SnapshotFace& f : surface.faces) {
    std::fprintf(stderr, "  face");
    for (const std::int32_t v : f.v) {
      const Vec3& x = surface.points[static_cast<std::size_t>(v)];
      std::fprintf(stderr, " %d (%.17g, %.17g, %.17g)", v, x.x(), x.y(), x.z());
    }
    std::fprintf(stderr, " beyond %d %d %d distance %.17g\n", f.adj[0], f.adj[1], f.adj[2], f.distance);
  }
  std::abort();
}

}  // namespace pd::detail
