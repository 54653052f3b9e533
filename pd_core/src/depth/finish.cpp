#include "depth/finish.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/nearest.hpp"
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
/// It stays within 4 ulp of L, a coordinate, of the exact one.
bool find_translation(const NearestPlane& plane, const Dyadic& r, const Vec3DD& unit, const DoubleDouble& true_depth,
                      double true_upper, double true_extent, Vec3& translation) {
  const int exponent = std::ilogb(true_upper);
  const double extent = std::ldexp(true_extent, -exponent);
  const double leeway = 4 * (std::nextafter(extent, HUGE_VAL) - extent);
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
    if (std::abs(t[solved] - base[solved]) > leeway) t[solved] = base[solved];
    DoubleDouble excess = components[solved] * t[solved] - rest;
    if (excess.hi < 0) {
      t[solved] = std::nextafter(t[solved], components[solved].hi > 0 ? HUGE_VAL : -HUGE_VAL);
      excess = components[solved] * t[solved] - rest;
    }
    if (excess.hi > height * 1.0001) return false;
    const DoubleDouble length = two_product(t.x(), t.x()) + two_product(t.y(), t.y()) + two_product(t.z(), t.z());
    if ((length - two_product(upper, upper)).hi > 0x1p-90 * upper * upper) return false;
    if (accept(t)) return true;
    // Below what double-double resolves (a body of size 1 and one of 1e-300), the plane may lie an ulp further out.
    if (excess.hi > 0x1p-95) return false;
    t[solved] = std::nextafter(t[solved], components[solved].hi > 0 ? HUGE_VAL : -HUGE_VAL);
    return accept(t);
  };
  Vec3 bare = base;
  for (int i = live; i < 3; ++i) {
    if (std::abs(bare[order[i]]) <= leeway) bare[order[i]] = 0;
  }
  if (solve(bare) || solve(base)) return true;
  if (live == 1) return false;
  // An exact depth that is a double leaves a cap of no height: only the exact translation itself could do.
  if (!(height > 0)) return false;
  const auto reach = [&](int i) { return std::clamp(static_cast<int>(leeway / ulp(i)), 4, 64); };
  const int first = reach(order[0]);
  const int second = live == 3 ? reach(order[1]) : 0;
  for (int i = -first; i <= first; ++i) {
    for (int j = -second; j <= second; ++j) {
      Vec3 t = base;
      t[order[0]] += i * ulp(order[0]);
      if (live == 3) t[order[1]] += j * ulp(order[1]);
      if (solve(t)) return true;
    }
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

/// L, rounded: the largest |coordinate| of b - a over the posed vertices.
double largest_coordinate(const PosedPair& pair) {
  const auto box = [](const ConvexPolytope& body, const Pose& pose) {
    Eigen::AlignedBox3d bounds;
    for (int v = 0; v < body.num_vertices(); ++v) bounds.extend(Vec3(pose.rotation() * body.vertex(v)));
    return bounds;
  };
  const Eigen::AlignedBox3d a = box(pair.a(), pair.pose_a());
  const Eigen::AlignedBox3d b = box(pair.b(), pair.pose_b());
  const Vec3 offset = pair.pose_b().translation() - pair.pose_a().translation();
  return std::max((b.max() - a.min() + offset).cwiseAbs().maxCoeff(),
                  (b.min() - a.max() + offset).cwiseAbs().maxCoeff());
}

/// Class, bracket, normal and translation from the plane and the margins.
void finish(const PosedPair& pair, const NearestPlane& plane, const Margins& margins, PenetrationDepth& out) {
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
    const double extent = largest_coordinate(pair) + margins.a + margins.b;
    for (double ulps = 1; !find_translation(plane, r, unit, depth, out.upper, extent, out.translation); ulps *= 2) {
      out.upper += ulps * (std::nextafter(out.upper, HUGE_VAL) - out.upper);
    }
    out.depth = out.upper;
  }
}

/// t + 2^exponent (first + sum of weight * (vertex - first)), rounded once: local coordinates and translations may both
/// be large and cancel.
Vec3 world_point(const PosedPair& pair, const Vec3& translation, const Vec3DD& first, const Vec3& rest) {
  const double scale = std::ldexp(1.0, pair.scale_exponent());
  const auto coordinate = [&](double t, const DoubleDouble& f, double r) {
    return to_double(DoubleDouble{t, 0} + (f + DoubleDouble{r, 0}) * scale);
  };
  return {coordinate(translation.x(), first.x, rest.x()), coordinate(translation.y(), first.y, rest.y()),
          coordinate(translation.z(), first.z, rest.z())};
}

Vec3 point_of_a(const PosedPair& pair, const PairId* ids, const double* weights, int count) {
  Vec3 rest = Vec3::Zero();
  for (int i = 1; i < count; ++i) rest += weights[i] * pair.approximate(PairVector::edge_a(ids[0].a, ids[i].a));
  const Vec3DD negated = pair.approximate_dd({ids[0].a, -1, -1, -1, false});
  return world_point(pair, pair.pose_a().translation(), {-negated.x, -negated.y, -negated.z}, rest);
}

Vec3 point_of_b(const PosedPair& pair, const PairId* ids, const double* weights, int count) {
  Vec3 rest = Vec3::Zero();
  for (int i = 1; i < count; ++i) rest += weights[i] * pair.approximate(PairVector::edge_b(ids[0].b, ids[i].b));
  return world_point(pair, pair.pose_b().translation(), pair.approximate_dd({-1, -1, ids[0].b, -1, false}), rest);
}

/// The point of the nearest facet at the core's translation, split into a point of A's face and one of B's: the convex
/// combination of their vertices' differences nearest to it, found in the facet's plane (Gilbert, Johnson, Keerthi on
/// two polygons). Parallel facets and edges need no case of their own.
CorePoints split_overlapping(const PosedPair& pair, const ExactDirection& normal, const Vec3& translation) {
  const SupportFace on_a = support_face_a(pair, normal);
  const SupportFace on_b = support_face_b(pair, normal);
  const Vec3 target = translation * std::ldexp(1.0, -pair.scale_exponent());
  const auto difference = [&](std::int32_t a, std::int32_t b) {
    const Vec3DD p = pair.approximate_dd(PairVector::point(a, b));  // local coordinates may be large and cancel
    const Vec3 x = high(p - Vec3DD{{target.x(), 0}, {target.y(), 0}, {target.z(), 0}});
    return DifferenceVertex{x - x.dot(normal.unit) * normal.unit, a, b};
  };
  const auto extreme = [&](const SupportFace& face, const Vec3& direction, const auto& value) {
    return *std::max_element(face.begin(), face.end(), [&](std::int32_t v, std::int32_t w) {
      return value(v).dot(direction) < value(w).dot(direction);
    });
  };
  const auto edge_b = [&](std::int32_t v) { return pair.approximate(PairVector::edge_b(on_b.front(), v)); };
  const auto edge_a = [&](std::int32_t v) { return Vec3(-pair.approximate(PairVector::edge_a(on_a.front(), v))); };

  DifferenceVertex simplex[4] = {difference(on_a.front(), on_b.front())};
  double weights[4] = {1, 0, 0, 0};
  int count = 1;
  double best = std::numeric_limits<double>::infinity();
  for (Vec3 point = simplex[0].x; point.squaredNorm() < best;) {
    best = point.squaredNorm();
    DifferenceVertex next[4];
    double next_weights[4];
    int next_count = count;
    std::copy(simplex, simplex + count, next);
    next[next_count++] = difference(extreme(on_a, -point, edge_a), extreme(on_b, -point, edge_b));
    point = nearest_of_simplex(next, next_count, next_weights, true);
    if (!(point.squaredNorm() < best)) break;
    count = next_count;
    std::copy(next, next + count, simplex);
    std::copy(next_weights, next_weights + count, weights);
  }
  PairId ids[3];
  for (int i = 0; i < count; ++i) ids[i] = {simplex[i].a, simplex[i].b};
  const Vec3 a = point_of_a(pair, ids, weights, count);
  return {a, a + translation};
}

/// The nearest points of cores that are apart or touch, from the weights of the simplex.
CorePoints split_apart(const PosedPair& pair, const ExactNearest& nearest) {
  return {point_of_a(pair, nearest.simplex.data(), nearest.weights.data(), nearest.count),
          point_of_b(pair, nearest.simplex.data(), nearest.weights.data(), nearest.count)};
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
  finish(pair, plane_of_facet(pair, normal, facet), margins, out);
  out.feature_a = facet.on_a;
  out.feature_b = facet.on_b;
  const Vec3 core_translation = out.translation - (margins.a + margins.b) * out.normal;
  set_witnesses(split_overlapping(pair, normal, core_translation), margins, out);
}

void finish_touching(const PosedPair& pair, const ExactDirection& normal, const ExactNearest& nearest,
                     const Margins& margins, PenetrationDepth& out) {
  finish(pair, {normal, Dyadic(1.0), Dyadic()}, margins, out);
  set_features(pair, normal, out);
  CorePoints core = split_apart(pair, nearest);
  core.b = core.a;  // one point, computed on A
  set_witnesses(core, margins, out);
}

void finish_apart(const PosedPair& pair, const ExactNearest& nearest, const Margins& margins, PenetrationDepth& out) {
  const Dyadic3& y = nearest.point;
  const ExactDirection normal(Dyadic3{-y.x, -y.y, -y.z});
  // The plane through the nearest point y / scale, normal to it.
  finish(pair, {normal, nearest.scale, -dot(y, y)}, margins, out);
  set_features(pair, normal, out);
  set_witnesses(split_apart(pair, nearest), margins, out);
}

}  // namespace pd::detail
