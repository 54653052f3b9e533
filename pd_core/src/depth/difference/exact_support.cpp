#include "depth/difference/exact_support.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "numeric/unit_roundoff.hpp"
#include "structure/exact_climb.hpp"

namespace pd::detail {

namespace {

/// The three values brought to one power of two, up to 2, each within 2^-102 of the exact ratio; its upper half within
/// 2u.
Vec3DD leading_digits(const Dyadic3& v) {
  const auto bits = [](const Dyadic& d) { return static_cast<int>(msb(boost::multiprecision::abs(d.mantissa()))); };
  const auto top = [&](const Dyadic& d) {
    return d.sign() == 0 ? std::numeric_limits<int>::min() : d.exponent() + bits(d);
  };
  const int largest = std::max({top(v.x), top(v.y), top(v.z)});
  const auto digits = [&](const Dyadic& d) -> DoubleDouble {
    if (d.sign() == 0) return {};
    const Dyadic scaled = d.scaled(-largest);
    const double high = scaled.to_double();
    return {high, bits(d) < 53 ? 0 : (scaled - Dyadic(high)).to_double()};
  };
  return {digits(v.x), digits(v.y), digits(v.z)};
}

/// `extremal` of a solid in time of the climb and of the face.
template <class Sign>
SupportFace face_climbed_to(const ConvexPolytope& body, const Vec3& local, Sign&& sign) {
  SupportFace face;
  level_face(body, climb_exactly(body, support_vertex(body, local, -1), sign), sign, face);
  std::sort(face.begin(), face.end());
  return face;
}

/// Sign of <direction, to - from> in the body's frame by double-double; 0 where it does not tell.
/// @param local  R^T of the direction's leading digits.
/// @param size   the sum of those digits, absolute.
int sign_by_double_double(const ConvexPolytope& body, const Vec3DD& local, double size, double scale, int from,
                          int to) {
  const auto difference = [&](const double* x) { return two_sum(x[to] * scale, -(x[from] * scale)); };
  const Vec3DD edge{difference(body.x()), difference(body.y()), difference(body.z())};
  const double value = dot(local, edge).hi;
  // Of a product of one: the leading digits 3 * 2^-102, their turn 2^-100, products and sums 2^-101. Twice that.
  if (!(std::abs(value) > 0x1p-98 * size * norm1(edge) + 0x1p-900)) return 0;
  return value > 0 ? 1 : -1;
}

bool in_loop(const ConvexPolytope& body, int facet, std::int32_t v) {
  const auto loop = body.facet_vertices(facet);
  return std::find(loop.begin(), loop.end(), v) != loop.end();
}

/// The facet of a solid that holds the three vertices, -1 where there is none: no three vertices lie on a line, so what
/// is level with them is all of it.
int facet_through(const ConvexPolytope& body, const SupportFace& three) {
  if (body.affine_dimension() != 3) return -1;
  const int first = body.first_half_edge(three[0]);
  for (std::size_t k = 0; k < body.neighbours(three[0]).size(); ++k) {
    const int f = body.half_edge(first + static_cast<int>(k)).facet;
    if (in_loop(body, f, three[1]) && in_loop(body, f, three[2])) return f;
  }
  return -1;
}

/// Vertices that maximise `sign` times <R v, direction>, where `edge(from, to)` is the rotated difference.
/// @param turned_back  R^T x in double-double.
template <class Edge>
SupportFace extremal(const PosedPair& pair, const ConvexPolytope& body, const Mat3& rotation,
                     const ExactDirection& direction, Vec3DD (PosedPair::*turned_back)(const Vec3DD&) const,
                     double sign, Edge&& edge) {
  const Vec3 local = sign * (rotation.transpose() * direction.unit);
  // The local direction errs by 12u per coordinate (unit 4u, rotation 4u, product 3u), the dot product by 3u |v|: twice
  // 32u covers both values that are compared. Products of subnormal coordinates lose half of the least double each.
  const double slack = 64 * kUnitRoundoff * body.radius() + 0x1p-1070;
  const int n = body.num_vertices();
  const double scale = std::ldexp(1.0, -pair.scale_exponent());
  const double size = norm1(direction.leading);
  const int turned = sign > 0 ? 1 : -1;
  std::optional<Vec3DD> local_dd;
  const auto exactly = [&](int from, int to) {
    // Bodies that are turned against each other by noise have ties by the hundred that doubles leave open and
    // double-double tells; where all of the pair's vectors were doubles so far, ties are exact.
    if (pair.exact_work() > 0) {
      if (!local_dd) local_dd = (pair.*turned_back)(direction.leading);
      if (const int told = sign_by_double_double(body, *local_dd, size, scale, from, to)) return told * turned;
    }
    return dot(direction.exact, pair.exact(edge(from, to))).sign() * turned;
  };
  if (n > kScannedVertices && body.affine_dimension() == 3) {
    return face_climbed_to(body, local, [&](int from, int to) {
      const double value = body.vertex(to).dot(local) - body.vertex(from).dot(local);
      return std::abs(value) > slack ? (value > 0 ? 1 : -1) : exactly(from, to);
    });
  }
  double best = -std::numeric_limits<double>::infinity();
  for (int v = 0; v < n; ++v) best = std::max(best, body.vertex(v).dot(local));
  SupportFace face;
  int level_facet = -1;  // that all of the face lies in, once three of its vertices are known
  for (int v = 0; v < n; ++v) {
    if (body.vertex(v).dot(local) < best - slack) continue;
    if (face.empty() || (level_facet >= 0 && in_loop(body, level_facet, v))) {
      face.push_back(v);
      continue;
    }
    const int compared = exactly(face.front(), v);
    if (compared > 0) {
      face.clear();
      level_facet = -1;
    }
    if (compared >= 0) face.push_back(v);
    if (compared == 0 && face.size() == 3) level_facet = facet_through(body, face);
  }
  return face;
}

}  // namespace

ExactDirection::ExactDirection(Dyadic3 direction)
    : exact(std::move(direction)), unit(Vec3::Zero()), leading(leading_digits(exact)) {
  unit = Vec3(leading.x.hi, leading.y.hi, leading.z.hi).normalized();
}

SupportFace support_face_b(const PosedPair& pair, const ExactDirection& direction) {
  return extremal(pair, pair.b(), pair.pose_b().rotation(), direction, &PosedPair::in_frame_of_b, 1.0,
                  PairVector::edge_b);
}

SupportFace support_face_a(const PosedPair& pair, const ExactDirection& direction) {
  return extremal(pair, pair.a(), pair.pose_a().rotation(), direction, &PosedPair::in_frame_of_a, -1.0,
                  PairVector::edge_a);
}

int common_facet(const ConvexPolytope& body, const SupportFace& vertices) {
  const int v = vertices.front();
  const int first = body.first_half_edge(v);
  for (std::size_t k = 0; k < body.neighbours(v).size(); ++k) {
    const int f = body.half_edge(first + static_cast<int>(k)).facet;
    const auto loop = body.facet_vertices(f);
    if (loop.size() != vertices.size()) continue;
    const bool all = std::all_of(loop.begin(), loop.end(), [&](std::int32_t w) {
      return std::binary_search(vertices.begin(), vertices.end(), w);
    });
    if (all) return f;
  }
  return -1;
}

int facing_facet(const ConvexPolytope& body, const SupportFace& vertices, const Mat3& rotation, const Vec3& outward) {
  const int facet = common_facet(body, vertices);
  // A doubly covered polygon has two facets with the same vertices.
  if (body.affine_dimension() != 2) return facet;
  return (rotation * body.facet_normal(facet)).dot(outward) > 0 ? facet : 1 - facet;
}

FacetOfDifference facet_of_faces(const PosedPair& pair, const SupportFace& on_a, const SupportFace& on_b,
                                 const Vec3& outward) {
  if (on_b.size() >= 3) {
    const int facet = facing_facet(pair.b(), on_b, pair.pose_b().rotation(), outward);
    return FacetOfDifference::from_facet_of_b(pair.b(), facet, on_a.front());
  }
  const int facet = facing_facet(pair.a(), on_a, pair.pose_a().rotation(), -outward);
  return FacetOfDifference::from_facet_of_a(pair.a(), facet, on_b.front());
}

FacetOfDifference facet_of_direction(const PosedPair& pair, const ExactDirection& normal) {
  const SupportFace on_a = support_face_a(pair, normal);
  const SupportFace on_b = support_face_b(pair, normal);
  if (on_a.size() >= 3 || on_b.size() >= 3) return facet_of_faces(pair, on_a, on_b, normal.unit);
  assert(on_a.size() == 2 && on_b.size() == 2);
  const Dyadic3 u = pair.exact(PairVector::edge_b(on_b[0], on_b[1]));
  const Dyadic3 v = pair.exact(PairVector::edge_a(on_a[0], on_a[1]));
  const bool outward = dot(cross(u, v), normal.exact).sign() > 0;
  return outward ? FacetOfDifference::from_edges(on_a[0], on_a[1], on_b[0], on_b[1])
                 : FacetOfDifference::from_edges(on_a[1], on_a[0], on_b[0], on_b[1]);
}

}  // namespace pd::detail
