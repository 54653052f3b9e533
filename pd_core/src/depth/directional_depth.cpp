#include "pd/depth/directional_depth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "depth/certificate/rounded_ray_crossing.hpp"
#include "depth/certificate/support_faces.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "depth/pair/scratch_buffers.hpp"
#include "depth/rays/hierarchy_descent.hpp"
#include "depth/rays/portal.hpp"
#include "depth/rays/ray_shooting.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "numeric/root_sum.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/refused_vector.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::ExactDirection;
using detail::PairVector;
using detail::PosedPair;

/// A supporting plane of P and where the ray meets it: t = offset / slope, in units of |d| and up to one common factor.
struct Crossing {
  Dyadic3 normal;
  Dyadic offset;  ///< <point, normal>, > 0
  Dyadic slope;   ///< <d, normal>, > 0
};

Crossing crossing_of(const PosedPair& pair, const Dyadic3& direction, const PairVector& point, const PairVector& u,
                     const PairVector& v) {
  Crossing c;
  c.normal = cross(pair.exact(u), pair.exact(v));
  c.offset = dot(pair.exact(point), c.normal);
  c.slope = dot(direction, c.normal);
  return c;
}

/// The least crossing over every facet of P that faces along the ray.
class NearestCrossing {
 public:
  NearestCrossing(const detail::OverlayWalk& walk, const detail::DirectionSigns& ray)
      : walk_(walk), pair_(walk.pair()), ray_(ray) {}

  void consume(std::span<const detail::OverlayPiece> pieces) {
    for (const detail::OverlayPiece& piece : pieces) {
      ++visited_;
      const detail::FacetOfDifference facet = facet_of(pair_, piece);
      const Vec3 u = pair_.approximate(facet.u), v = pair_.approximate(facet.v);
      const Vec3 n = u.cross(v);
      const Vec3 p = pair_.approximate(facet.point());
      const double e = pair_.vector_error();
      const double su = u.cwiseAbs().sum(), sv = v.cwiseAbs().sum(), sp = p.cwiseAbs().sum();
      // Errors of a normal's coordinate, and with it of both products (3 coordinates, 1-norms, as in the overlay
      // engine).
      const double en = (e * (su + sv + 2 * e) + 0x1p-51 * su * sv) * (1 + 0x1p-40);
      const double sn = n.cwiseAbs().sum() + 3 * en;
      const double slope = n.dot(ray_.scaled()), slope_error = 3 * en * 2 + 0x1p-48 * sn;
      const double offset = n.dot(p), offset_error = en * (sp + 3 * e) + sn * e + 0x1p-48 * sp * sn + 0x1p-900;
      // Out of the question: facing away for certain, or certainly farther than the best.
      if (slope < -slope_error) continue;
      const double farthest_slope = std::max(0.0, slope + slope_error);
      if (found_ && offset - offset_error > upper_ * farthest_slope * (1 + 0x1p-40)) continue;
      consider(piece, facet, (offset + offset_error) * (1 + 0x1p-50), slope - slope_error);
    }
  }

  [[nodiscard]] const Crossing& best() const { return best_; }
  [[nodiscard]] std::int64_t visited() const { return visited_; }

 private:
  void consider(const detail::OverlayPiece& piece, const detail::FacetOfDifference& facet, double offset_upper,
                double slope_lower) {
    if (piece.kind != detail::OverlayPiece::Kind::facet_of_a && !whole_facet(walk_, piece)) return;
    const Crossing c = crossing_of(pair_, ray_.exact(), facet.point(), facet.u, facet.v);
    if (c.slope.sign() <= 0) return;
    if (found_ && (c.offset * best_.slope - best_.offset * c.slope).sign() >= 0) return;
    best_ = c;
    upper_ = slope_lower > 0 ? offset_upper / slope_lower * (1 + 0x1p-50) : HUGE_VAL;
    found_ = true;
  }

  const detail::OverlayWalk& walk_;
  const PosedPair& pair_;
  const detail::DirectionSigns& ray_;
  Crossing best_;
  double upper_ = HUGE_VAL;
  bool found_ = false;
  std::int64_t visited_ = 0;
};

void fill_depth(const PosedPair& pair, const Dyadic3& direction, const Crossing& c, DirectionalDepth& out) {
  // offset carries the pair's homogeneous factor once more than slope; times |d| it is a length.
  const Dyadic denominator = c.slope * pair.homogeneous_factor();
  const detail::RootSum exact(Dyadic(0.0), 1, c.offset * c.offset * dot(direction, direction),
                              denominator * denominator);
  out.lower = exact.round_down();
  out.upper = exact.round_up(out.lower);
  out.depth = std::clamp(detail::to_double(exact.approximate()), out.lower, out.upper);
}

/// The unit vector, rounded; whatever the length of v, the same bits.
Vec3 rounded_unit(const Dyadic3& v) {
  const detail::Vec3DD unit = detail::unit_double_double(v);
  return {to_double(unit.x), to_double(unit.y), to_double(unit.z)};
}

void fill(const PosedPair& pair, const Dyadic3& direction, const Crossing& c, DirectionalDepth& out) {
  fill_depth(pair, direction, c, out);
  const ExactDirection normal(c.normal);
  out.normal = rounded_unit(c.normal);
  const detail::FacetOfDifference facet = facet_of_direction(pair, normal);
  out.feature_a = facet.on_a;
  out.feature_b = facet.on_b;
}

using Corners = std::array<detail::VertexPair, 3>;

Crossing crossing_of(const PosedPair& pair, const Dyadic3& direction, const Corners& corners) {
  const detail::VertexPair& p = corners[0];
  const auto to = [&](const detail::VertexPair& q) { return PairVector::difference(p.a, p.b, q.a, q.b); };
  return crossing_of(pair, direction, PairVector::point(p.a, p.b), to(corners[1]), to(corners[2]));
}

/// Swept and smooth bodies: a portal search in doubles.
void swept_depth(const PosedShape& a, const PosedShape& b, const Vec3& direction, double inner_radius,
                 detail::ScratchBuffers& buffers, DirectionalDepth& out) {
  constexpr double kRelative = 1e-13;
  if (const int exponent = detail::extreme_exponent(a, b); exponent != 0) {
    const detail::ScaledPair near(a, b, exponent);
    swept_depth(near.a(), near.b(), direction, std::ldexp(inner_radius, -exponent), buffers, out);
    out.lower = detail::times_power_down(out.lower, exponent);
    out.upper = detail::times_power_up(out.upper, exponent);
    out.depth = out.upper;
    return;
  }
  detail::SweptShooter shooter(a, b, buffers.points, inner_radius, kRelative);
  const detail::RayShot shot = shooter.shoot(detail::unit_vector(direction));
  out.lower = shot.lower;
  out.upper = shot.upper;
  out.depth = shot.upper;
  out.normal = shot.normal;
  out.statistics.support_calls += shooter.support_calls();
}

/// Where the ray leaves P, by the pieces of the overlay.
Crossing by_overlay(const PosedPair& pair, const detail::DirectionSigns& ray, Scratch& scratch, DirectionalDepth& out) {
  detail::OverlayWalk walk(pair, scratch.buffers().overlay.overlay);
  NearestCrossing nearest(walk, ray);
  walk.run([&](std::span<const detail::OverlayPiece> pieces) {
    nearest.consume(pieces);
    return true;
  });
  out.statistics.facets_visited += nearest.visited();
  return nearest.best();
}

/// The same by a portal.
Crossing by_portal(const PosedPair& pair, const detail::DirectionSigns& ray, DirectionalDepth& out) {
  const detail::Portal portal = find_portal(ray);
  out.statistics.support_calls += portal.support_calls;
  return crossing_of(pair, ray.exact(), portal.corners);
}

/// The sign of an edge along the normal of a plane through three points of P.
class CornersSign final : public detail::NormalSign {
 public:
  CornersSign(const PosedPair& pair, const Corners& v)
      : pair_(pair),
        u_(PairVector::difference(v[0].a, v[0].b, v[1].a, v[1].b)),
        w_(PairVector::difference(v[0].a, v[0].b, v[2].a, v[2].b)) {}
  [[nodiscard]] int along(const PairVector& edge) const override { return pair_.sign_determinant(edge, u_, w_); }

 private:
  const PosedPair& pair_;
  PairVector u_, w_;
};

/// Depth, normal and features at a portal: rounded where the error bound allows it, else exact; the same bits.
void fill(const detail::DirectionSigns& ray, const Corners& corners, DirectionalDepth& out) {
  const PosedPair& pair = ray.pair();
  detail::SupportFaces faces;
  const auto rounded = rounded_ray_crossing(ray, corners);
  if (!rounded || !collect_faces(pair, rounded->plane, CornersSign(pair, corners), corners, faces)) {
    fill(pair, ray.exact(), crossing_of(pair, ray.exact(), corners), out);
    return;
  }
  out.lower = rounded->lower;
  out.upper = rounded->upper;
  out.depth = rounded->depth;
  out.normal = rounded->normal;
  const detail::FacetFeatures features = features_of(pair, faces, out.normal);
  out.feature_a = features.on_a;
  out.feature_b = features.on_b;
}

/// [D] Compute-Depth-3D. False where the origin is not inside P: then only the counts are filled.
bool descend(const PosedPair& pair, const Vec3& direction, const DirectionalHierarchies& hierarchies,
             DirectionalDepth& out) {
  std::array<Corners, 2> corners{};
  for (const std::size_t way : {std::size_t{0}, std::size_t{1}}) {
    const detail::DirectionSigns ray(pair, way == 0 ? direction : Vec3(-direction));
    const detail::HierarchyDescentResult result = descend_hierarchies(ray, {hierarchies.a}, {hierarchies.b});
    out.descent.steps += result.steps;
    out.descent.certificate += result.certificate;
    out.descent.caps += result.caps;
    out.descent.repairs += result.repairs;
    if (!result.crosses) return false;
    corners[way] = *result.corners;
    if (crossing_of(pair, ray.exact(), corners[way]).offset.sign() <= 0) return false;
  }
  out.contact = ContactClass::overlapping;
  fill(detail::DirectionSigns(pair, direction), corners[0], out);
  return true;
}

/// Compute-Depth-3D, in hierarchies made for this query where the caller has none. False where the descent ends without
/// an answer.
Expected<bool> by_hierarchies(const PosedPair& pair, const ConvexPolytope& a, const ConvexPolytope& b,
                              const Vec3& direction, const DirectionalHierarchies* hierarchies, DirectionalDepth& out) {
  if (hierarchies != nullptr) {
    if (const auto error = detail::refuse_hierarchy(hierarchies->a, a, "hierarchies.a")) return *error;
    if (const auto error = detail::refuse_hierarchy(hierarchies->b, b, "hierarchies.b")) return *error;
    return descend(pair, direction, *hierarchies, out);
  }
  Expected<PolyhedralHierarchy> built_a = PolyhedralHierarchy::build(a, HierarchyKind::inner);
  if (!built_a) return built_a.error();
  Expected<PolyhedralHierarchy> built_b = PolyhedralHierarchy::build(b, HierarchyKind::inner);
  if (!built_b) return built_b.error();
  return descend(pair, direction, DirectionalHierarchies{&*built_a, &*built_b}, out);
}

/// The ends of a portal as the caller keeps them; not known where a vertex is none of these bodies'.
detail::PortalEnds ends_of(const PosedPair& pair, const DirectionalCertificate& certificate) {
  detail::PortalEnds ends;
  if (certificate.triangles < 1 || certificate.triangles > DirectionalCertificate::kMostTriangles) return ends;
  for (std::int32_t k = 0; k < certificate.triangles; ++k) {
    const auto& ids = certificate.vertices[static_cast<std::size_t>(k)];
    Corners v;
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = {ids[2 * i], ids[2 * i + 1]};
      if (v[i].a < 0 || v[i].b < 0 || v[i].a >= pair.a().num_vertices() || v[i].b >= pair.b().num_vertices()) return {};
    }
    if (k == 0) {
      ends.back = v;
    } else {
      ends.push(v);
    }
  }
  ends.known = true;
  return ends;
}

void keep(const detail::PortalEnds& ends, DirectionalCertificate& certificate) {
  static_assert(DirectionalCertificate::kMostTriangles == detail::PortalEnds::kMost + 1);
  certificate.triangles = ends.known ? ends.count + 1 : 0;
  for (std::int32_t k = 0; k < certificate.triangles; ++k) {
    const Corners& v = k == 0 ? ends.back : ends.portals[static_cast<std::size_t>(k - 1)];
    for (std::size_t i = 0; i < 3; ++i) {
      certificate.vertices[static_cast<std::size_t>(k)][2 * i] = v[i].a;
      certificate.vertices[static_cast<std::size_t>(k)][2 * i + 1] = v[i].b;
    }
  }
}

/// Solids by a portal whose ends tell the class. False where they do not; then nothing is filled but the counts.
bool inside_by_portal(const PosedPair& pair, const Vec3& direction, DirectionalCertificate* certificate,
                      DirectionalDepth& out) {
  const detail::DirectionSigns ray(pair, direction);
  detail::PortalEnds ends;
  if (certificate != nullptr) ends = ends_of(pair, *certificate);
  const std::optional<detail::Portal> portal = find_inside_portal(ray, direction, ends);
  if (certificate != nullptr) keep(ends, *certificate);
  if (!portal) return false;
  out.contact = ContactClass::overlapping;
  out.statistics.support_calls += portal->support_calls;
  fill(ray, portal->corners, out);
  return true;
}

}  // namespace

Expected<DirectionalDepth> directional_depth(const PosedShape& a, const PosedShape& b, const Vec3& direction,
                                             Scratch& scratch, DirectionalMethod method,
                                             const DirectionalHierarchies* hierarchies,
                                             DirectionalCertificate* certificate) {
  const detail::FloatingPointGuard guard;
  if (const auto error = detail::refuse_direction(direction)) return *error;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  const bool exact = polytope_a && polytope_b && a.shape->margin() == 0 && b.shape->margin() == 0;
  if (!exact && method != DirectionalMethod::portal) {
    return Error{ErrorCode::unsupported, "this method is for polytopes without a margin; portal answers for all", ""};
  }

  DirectionalDepth out;
  if (method == DirectionalMethod::hierarchy) {
    const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose);
    const Expected<bool> answered = by_hierarchies(pair, *polytope_a, *polytope_b, direction, hierarchies, out);
    if (!answered) return answered.error();
    if (*answered) {
      out.statistics.exact_signs += pair.stages().double_double + pair.stages().exact;
      return out;
    }
  }
  if (exact && method == DirectionalMethod::portal && polytope_a->affine_dimension() == 3 &&
      polytope_b->affine_dimension() == 3) {
    const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose);
    if (inside_by_portal(pair, direction, certificate, out)) {
      out.statistics.exact_signs += pair.stages().double_double + pair.stages().exact;
      return out;
    }
  }
  // The class alone: a factor of two of the depth is enough, and the class is exact in any case.
  DepthSettings roughly;
  roughly.delta = 1;
  const PenetrationDepth overlap = penetration_depth(a, b, scratch, roughly);
  out.contact = overlap.contact;
  out.statistics = overlap.statistics;

  if (out.contact != ContactClass::overlapping) return out;
  if (!exact) {
    swept_depth(a, b, direction, overlap.lower, scratch.buffers(), out);
    return out;
  }

  const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose);
  const detail::DirectionSigns ray(pair, direction);
  const Crossing crossing =
      method == DirectionalMethod::overlay ? by_overlay(pair, ray, scratch, out) : by_portal(pair, ray, out);
  fill(pair, ray.exact(), crossing, out);
  out.statistics.exact_signs += pair.stages().double_double + pair.stages().exact;
  return out;
}

}  // namespace pd
