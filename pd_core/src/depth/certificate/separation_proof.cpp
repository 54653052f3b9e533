#include <algorithm>
#include <cmath>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "numeric/double_double.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

PairVector point(const VertexPair& p) { return PairVector::point(p.a, p.b); }
PairVector edge(const VertexPair& p, const VertexPair& q) { return PairVector::difference(p.a, p.b, q.a, q.b); }

/// Outward normal = minus the nearest point, exact: of a vertex, or of a segment (times its squared length).
class NearestSign final : public NormalSign {
 public:
  NearestSign(const PosedPair& pair, std::span<const VertexPair> simplex) : pair_(pair), simplex_(simplex) {}

  [[nodiscard]] int along(const PairVector& w) const override {
    const PairVector p = point(simplex_[0]);
    if (simplex_.size() == 1) return -pair_.sign_dot(w, p);
    const PairVector e = edge(simplex_[0], simplex_[1]);
    if (simplex_.size() == 3) {
      const PairVector f = edge(simplex_[0], simplex_[2]);
      return pair_.sign_determinant(w, e, f) * -pair_.sign_determinant(p, e, f);
    }
    const Dyadic3 x = pair_.exact(w), y = pair_.exact(p), z = pair_.exact(e);
    return (dot(x, z) * dot(y, z) - dot(x, y) * dot(z, z)).sign();
  }

 private:
  const PosedPair& pair_;
  std::span<const VertexPair> simplex_;
};

/// The plane normal to y through y, for a vector y known to `error` a coordinate.
FacetPlane plane_of(const Vec3DD& y, double error) {
  FacetPlane plane;
  const DoubleDouble squared = dot(y, y);
  const double length = std::sqrt(squared.hi);
  if (!(length > 8 * error) || !(length > 0x1p-400)) return plane;
  const DoubleDouble root = sqrt(squared);
  plane.unit = {-(y.x / root), -(y.y / root), -(y.z / root)};
  plane.distance = -root;
  plane.distance_error = (2 * error + 64 * kUdd * length) * (1 + 16 * kUnitRoundoff);
  plane.unit_error = (4 * error / length + 64 * kUdd) * (1 + 16 * kUnitRoundoff);
  return plane;
}

}  // namespace

std::optional<ProvenSeparation> prove_separation(const PosedPair& pair, std::span<const VertexPair> simplex,
                                                 SupportFaces& faces) {
  ProvenSeparation found;
  if (simplex.empty() || simplex.size() > 3) return std::nullopt;
  found.count = static_cast<int>(simplex.size());
  std::copy(simplex.begin(), simplex.end(), found.simplex.begin());
  const double e = pair.vector_error_dd();
  const Vec3DD p = pair.approximate_dd(point(simplex[0]));
  if (found.count == 1) {
    found.weights[0] = 1;
    found.plane = plane_of(p, e);
  } else if (found.count == 2) {
    const PairVector d = edge(simplex[0], simplex[1]);
    if (pair.sign_dot(point(simplex[0]), d) >= 0 || pair.sign_dot(point(simplex[1]), d) <= 0) return std::nullopt;
    const Vec3DD v = pair.approximate_dd(d);
    const DoubleDouble squared = dot(v, v);
    const DoubleDouble t = -(dot(p, v) / squared);
    found.weights = {1 - to_double(t), to_double(t), 0};
    // y = p - v <p, v> / <v, v>: a projection along v, which turns by at most e / |v| a coordinate of v.
    const double size = norm1(v);
    const double shortest = std::sqrt(squared.hi) * (1 - 8 * kUnitRoundoff);
    if (!(shortest > 16 * e)) return std::nullopt;
    const double error = 4 * e + 8 * norm1(p) * (e / shortest) + 64 * kUdd * (norm1(p) + size * std::abs(to_double(t)));
    found.plane = plane_of(p + scaled(v, t), error * (1 + 16 * kUnitRoundoff));
  } else {
    const PairVector du = edge(simplex[0], simplex[1]), dv = edge(simplex[0], simplex[2]);
    FacetOfDifference facet{{}, {}, du, dv, simplex[0].a, simplex[0].b};
    found.plane = measure_facet(pair, facet);
    if (!found.plane.known()) return std::nullopt;
    // The normal that faces the origin.
    if (found.plane.distance.hi > 0) {
      std::swap(facet.u, facet.v);
      found.plane = measure_facet(pair, facet);
    }
    if (!(to_double(found.plane.distance) < -found.plane.distance_error)) return std::nullopt;
    // Barycentric coordinates of the projection: twice the areas that the origin's projection spans with two corners.
    const Vec3DD x[3] = {p, pair.approximate_dd(point(simplex[1])), pair.approximate_dd(point(simplex[2]))};
    DoubleDouble area[3];
    double largest = 0;
    for (const Vec3DD& c : x) largest = std::max(largest, norm1(c));
    for (int i = 0; i < 3; ++i) area[i] = dot(found.plane.unit, cross(x[(i + 1) % 3], x[(i + 2) % 3]));
    const double sense = facet.u.a_to == du.a_to && facet.u.b_to == du.b_to ? 1 : -1;
    const double error =
        (largest * largest * (3 * found.plane.unit_error + 64 * kUdd) + 8 * e * largest) * (1 + 16 * kUnitRoundoff);
    double total = 0;
    for (int i = 0; i < 3; ++i) {
      const double value = sense * to_double(area[i]);
      if (!(value > error)) return std::nullopt;
      found.weights[static_cast<std::size_t>(i)] = value;
      total += value;
    }
    for (double& w : found.weights) w /= total;
  }
  if (!found.plane.known()) return std::nullopt;
  const NearestSign sign(pair, simplex);
  if (!collect_faces(pair, found.plane, sign, simplex, faces)) return std::nullopt;
  return found;
}

}  // namespace pd::detail
