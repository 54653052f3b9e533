#include "depth/finish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/root_sum.hpp"

namespace pd::detail {

namespace {

/// The two nearest points of the cores, in the frame that A and B share.
struct CorePoints {
  Vec3 a;
  Vec3 b;
};

Vec3 high(const Vec3DD& v) { return {v.x.hi, v.y.hi, v.z.hi}; }

/// Whether t lies outside the interior of P swept by a ball of radius r: <normal, t> >= h_P(normal) + r |normal|,
/// exactly.
bool separates(const NearestPlane& plane, const Dyadic& r, const Vec3& t) {
  const Dyadic gap = dot(plane.normal.exact, to_dyadic(t)) * plane.weight - plane.level;
  if (gap.sign() < 0 || r.sign() == 0) return gap.sign() >= 0;
  const Dyadic reach = r * plane.weight;
  return (gap * gap - reach * reach * dot(plane.normal.exact, plane.normal.exact)).sign() >= 0;
}

bool no_longer_than(const Vec3& t, double length) {
  const Dyadic3 exact = to_dyadic(t);
  return (Dyadic(length) * Dyadic(length) - dot(exact, exact)).sign() >= 0;
}

/// A double triple t with <unit, t> >= depth and |t| <= upper. The cap between plane and sphere is less than an ulp
/// high but about 1e8 ulps wide, so it holds many triples: two coordinates walk near the exact translation, the third
/// (the one with the finest ulps) is solved for. Candidates are sifted in double-double and proved exactly.
///
/// Lengths are brought near 1 by a power of two for the sifting.
bool find_translation(const NearestPlane& plane, const Dyadic& r, const Vec3DD& unit, const DoubleDouble& true_depth,
                      double true_upper, Vec3& translation) {
  const int exponent = std::ilogb(true_upper);
  const DoubleDouble depth{std::ldexp(true_depth.hi, -exponent), std::ldexp(true_depth.lo, -exponent)};
  const double upper = std::ldexp(true_upper, -exponent);
  const Vec3 base = high({unit.x * depth, unit.y * depth, unit.z * depth});
  const auto accept = [&](const Vec3& candidate) {
    const Vec3 t(std::ldexp(candidate.x(), exponent), std::ldexp(candidate.y(), exponent),
                 std::ldexp(candidate.z(), exponent));
    if (!separates(plane, r, t) || !no_longer_than(t, true_upper)) return false;
    translation = t;
    return true;
  };
  if (accept(base)) return true;

  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return std::abs(base[i]) > std::abs(base[j]); });
  const double scale = std::abs(base[order[0]]);
  // A coordinate that is nearly a zero of the normal hardly moves the plane's side, but lengthens t: it stays, or goes.
  int live = 1;
  while (live < 3 && std::abs(base[order[live]]) > 0x1p-20 * scale) ++live;
  const DoubleDouble components[3] = {unit.x, unit.y, unit.z};
  const double height = to_double(DoubleDouble{upper, 0} - depth);
  const auto ulp = [&](int i) { return std::nextafter(std::abs(base[i]), HUGE_VAL) - std::abs(base[i]); };

  const int solved = order[live - 1];
  const auto solve = [&](Vec3 t) {
    DoubleDouble rest = depth;
    for (int i = 0; i < 3; ++i) {
      if (i != solved) rest = rest - components[i] * t[i];
    }
    t[solved] = to_double(rest / components[solved]);
    DoubleDouble excess = components[solved] * t[solved] - rest;
    if (excess.hi < 0) {
      t[solved] = std::nextafter(t[solved], components[solved].hi > 0 ? HUGE_VAL : -HUGE_VAL);
      excess = components[solved] * t[solved] - rest;
    }
    if (excess.hi > height * 1.0001) return false;
    const DoubleDouble length = two_product(t.x(), t.x()) + two_product(t.y(), t.y()) + two_product(t.z(), t.z());
    return (length - two_product(upper, upper)).hi <= 0x1p-90 * upper * upper && accept(t);
  };
  Vec3 bare = base;
  for (int i = live; i < 3; ++i) bare[order[i]] = 0;
  if (solve(bare) || solve(base)) return true;
  if (live == 1) return false;
  for (const int reach : {4, 40, 400}) {
    const int first_reach = live == 2 ? reach * reach : reach;
    const int second_reach = live == 2 ? 0 : reach;
    for (int i = -first_reach; i <= first_reach; ++i) {
      for (int j = -second_reach; j <= second_reach; ++j) {
        Vec3 t = base;
        t[order[0]] += i * ulp(order[0]);
        if (live == 3) t[order[1]] += j * ulp(order[1]);
        if (solve(t)) return true;
      }
    }
    // An exact depth that is a double leaves a cap of no height: only the exact translation itself could do.
    if (!(height > 0)) return false;
  }
  return false;
}

Feature feature_of(const ConvexPolytope& body, const SupportFace& face) {
  if (face.size() == 1) return {Feature::Kind::vertex, face[0], -1};
  if (face.size() == 2) return {Feature::Kind::edge, face[0], face[1]};
  return {Feature::Kind::facet, common_facet(body, face), -1};
}

/// The supporting features in a direction where the cores do not overlap: at most one of them a facet, its partner a
/// vertex.
void set_features(const PosedPair& pair, const ExactDirection& normal, PenetrationDepth& out) {
  const SupportFace on_a = support_face_a(pair, normal);
  const SupportFace on_b = support_face_b(pair, normal);
  out.feature_a = feature_of(pair.a(), on_a);
  out.feature_b = feature_of(pair.b(), on_b);
  if (out.feature_a.kind == Feature::Kind::facet) {
    out.feature_b = {Feature::Kind::vertex, on_b.front(), -1};
  } else if (out.feature_b.kind == Feature::Kind::facet) {
    out.feature_a = {Feature::Kind::vertex, on_a.front(), -1};
  }
}

/// Class, bracket, normal and translation from the plane and the margins.
void finish(const NearestPlane& plane, const Margins& margins, PenetrationDepth& out) {
  const Dyadic r = Dyadic(margins.a) + Dyadic(margins.b);
  const RootSum value(r, plane.level.sign() < 0 ? -1 : 1, plane.level * plane.level,
                      plane.weight * plane.weight * dot(plane.normal.exact, plane.normal.exact));
  const Vec3DD unit = unit_double_double(plane.normal.exact);
  out.normal = high(unit);
  out.translation = Vec3::Zero();
  out.depth = out.lower = out.upper = 0;
  out.distance = out.distance_lower = out.distance_upper = 0;

  const int sign = value.compare(Dyadic());
  if (sign == 0) {
    out.contact = ContactClass::touching;
  } else if (sign < 0) {
    out.contact = ContactClass::separated;
    const RootSum distance = value.negated();
    out.distance_lower = distance.round_down();
    out.distance_upper = distance.round_up(out.distance_lower);
    out.distance = out.distance_upper;
  } else {
    out.contact = ContactClass::overlapping;
    out.lower = value.round_down();
    out.upper = value.round_up(out.lower);
    const DoubleDouble depth = value.approximate();
    // Strides grow, so that subnormal lengths, whose coordinates are coarse, end too.
    for (double ulps = 1; !find_translation(plane, r, unit, depth, out.upper, out.translation); ulps *= 2) {
      out.upper += ulps * (std::nextafter(out.upper, HUGE_VAL) - out.upper);
    }
    out.depth = out.upper;
  }
}

/// Where the perpendicular from the origin meets the facet, split into its two points.
CorePoints split_overlapping(const PosedPair& pair, const FacetOfDifference& facet, const Vec3& translation) {
  if (facet.on_a.kind == Feature::Kind::vertex) {
    const Vec3 a = pair.pose_a().apply(pair.a().vertex(facet.on_a.first));
    return {a, a + translation};
  }
  if (facet.on_b.kind == Feature::Kind::vertex) {
    const Vec3 b = pair.pose_b().apply(pair.b().vertex(facet.on_b.first));
    return {b - translation, b};
  }
  // translation = (b0 + s e_b) - (a0 + q e_a): solve for q on A's edge.
  const double scale = std::ldexp(1.0, -pair.scale_exponent());
  const Vec3 edge_b = pair.approximate(facet.u);
  const Vec3 edge_a = pair.approximate(facet.v);
  const Vec3 normal = edge_b.cross(edge_a);
  const Vec3 rest = translation * scale - pair.approximate(facet.point());
  const double q = std::clamp(edge_b.cross(rest).dot(normal) / -normal.squaredNorm(), 0.0, 1.0);
  // facet.v runs from the facet's own vertex of A along its edge.
  const int far = facet.on_a.first == facet.a ? facet.on_a.second : facet.on_a.first;
  const Vec3 from = pair.a().vertex(facet.a);
  const Vec3 a = pair.pose_a().apply(Vec3(from + q * (pair.a().vertex(far) - from)));
  return {a, a + translation};
}

/// The nearest points of cores that are apart or touch, from the weights of the simplex.
CorePoints split_apart(const PosedPair& pair, const ExactNearest& nearest) {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  for (int i = 0; i < nearest.count; ++i) {
    a += nearest.weights[i] * pair.a().vertex(nearest.simplex[i].a);
    b += nearest.weights[i] * pair.b().vertex(nearest.simplex[i].b);
  }
  return {pair.pose_a().apply(a), pair.pose_b().apply(b)};
}

void set_witnesses(const CorePoints& core, const Margins& margins, PenetrationDepth& out) {
  out.witness_a = core.a - margins.a * out.normal;
  out.witness_b = core.b + margins.b * out.normal;
}

}  // namespace

NearestPlane plane_of_facet(const PosedPair& pair, const ExactDirection& normal, const FacetOfDifference& facet) {
  return {normal, pair.homogeneous_factor(), dot(normal.exact, pair.exact(facet.point()))};
}

void finish_overlapping(const PosedPair& pair, const ExactDirection& normal, const Margins& margins,
                        PenetrationDepth& out) {
  const FacetOfDifference facet = facet_of_direction(pair, normal);
  finish(plane_of_facet(pair, normal, facet), margins, out);
  out.feature_a = facet.on_a;
  out.feature_b = facet.on_b;
  const Vec3 core_translation = out.translation - (margins.a + margins.b) * out.normal;
  set_witnesses(split_overlapping(pair, facet, core_translation), margins, out);
}

void finish_touching(const PosedPair& pair, const ExactDirection& normal, const ExactNearest& nearest,
                     const Margins& margins, PenetrationDepth& out) {
  finish({normal, Dyadic(1.0), Dyadic()}, margins, out);
  set_features(pair, normal, out);
  CorePoints core = split_apart(pair, nearest);
  core.b = core.a;  // one point, computed on A
  set_witnesses(core, margins, out);
}

void finish_apart(const PosedPair& pair, const ExactNearest& nearest, const Margins& margins, PenetrationDepth& out) {
  const Dyadic3& y = nearest.point;
  const ExactDirection normal(Dyadic3{-y.x, -y.y, -y.z});
  // The plane through the nearest point y / scale, normal to it.
  finish({normal, nearest.scale, -dot(y, y)}, margins, out);
  set_features(pair, normal, out);
  set_witnesses(split_apart(pair, nearest), margins, out);
}

}  // namespace pd::detail
