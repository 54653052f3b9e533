#include "depth/expansion/pair_hull.hpp"

#include <cmath>

namespace pd::detail {

namespace {

/// Whether s closes a parallelogram with three corners of a face: p + q - r in the ids of both bodies.
bool closes_parallelogram(const VertexPair& p, const VertexPair& q, const VertexPair& r, const VertexPair& s) {
  return (p.a == s.a && q.b == s.b && q.a == r.a && p.b == r.b) ||
         (q.a == s.a && p.b == s.b && p.a == r.a && q.b == r.b);
}

}  // namespace

PairVector PairHull::edge(const VertexPair& from, const VertexPair& to) {
  PairVector v = PairVector::difference(from.a, from.b, to.a, to.b);
  if (from.a == to.a) v.a_from = v.a_to = -1;
  if (from.b == to.b) v.b_from = v.b_to = -1;
  return v;
}

bool PairHull::is_independent(const VertexPair& id) const {
  const int known = num_vertices();
  if (known == 0) return true;
  const PairVector d = edge(vertices_[0], id);
  if (known == 2) return !pair_.parallel(d, edge(0, 1));
  if (known == 3) return pair_.sign_determinant(d, edge(0, 1), edge(0, 2)) != 0;
  if (pair_.approximate(d).cwiseAbs().sum() > 8 * pair_.vector_error(d)) return true;
  const Dyadic3 e = pair_.exact(d);
  return e.x.sign() != 0 || e.y.sign() != 0 || e.z.sign() != 0;
}

void PairHull::begin(std::span<const VertexPair> given) {
  for (const VertexPair& id : given) {
    if (num_vertices() < 4 && is_independent(id)) add_vertex(id);
  }
}

const Dyadic3& PairHull::exact_point(int v) {
  std::optional<Dyadic3>& exact = vertices_[v].exact;
  if (!exact) exact = pair_.exact(point(v));
  return *exact;
}

const Dyadic3& PairHull::exact_normal(int f) {
  normals_.resize(faces().size());
  std::optional<Dyadic3>& normal = normals_[f];
  if (!normal) {
    const Face& face = this->face(f);
    const Dyadic3& from = exact_point(face.v[0]);
    normal = cross(exact_point(face.v[1]) - from, exact_point(face.v[2]) - from);
  }
  return *normal;
}

int PairHull::side(int f, int v) {
  const Face& face = this->face(f);
  const VertexPair &p = vertices_[face.v[0]], &q = vertices_[face.v[1]], &r = vertices_[face.v[2]], &s = vertices_[v];
  if (closes_parallelogram(p, q, r, s) || closes_parallelogram(q, r, p, s) || closes_parallelogram(r, p, q, s)) {
    return 0;
  }
  const std::optional<int> rounded =
      pair_.sign_determinant_rounded(edge(corner(face, 0), v), first_edge(face), second_edge(face));
  return rounded ? *rounded : dot(exact_normal(f), exact_point(v) - exact_point(face.v[0])).sign();
}

void PairHull::measure_finely(Face& f) const {
  const PairVector to_q = first_edge(f), to_r = second_edge(f);
  const Vec3DD p = pair_.approximate_dd(point(corner(f, 0)));
  const Vec3DD u = pair_.approximate_dd(to_q);
  const Vec3DD v = pair_.approximate_dd(to_r);
  const Vec3DD n = cross(u, v);
  const DoubleDouble squared = dot(n, n);
  const double length = std::sqrt(squared.hi);
  f.fine = true;
  f.distance = squared.hi > 0 ? dot(p, n) / sqrt(squared) : DoubleDouble{};
  const double value = to_double(f.distance);
  // The determinant <p, u x v> and the normal, each with the errors of its arguments and of double-double products.
  const double e = pair_.vector_error_dd();
  {
    // The bounds by which the exact search orders faces: which of equal facets it meets first hangs on their last bits.
    const double a = norm1(p) + 3 * e, b = norm1(u) + 3 * e, c = norm1(v) + 3 * e;
    const double volume_error = 64 * 0x1p-104 * a * b * c + 2 * e * (b * c + a * c + a * b) + 0x1p-900;
    const double normal_error = 64 * 0x1p-104 * b * c + 4 * e * (b + c) + 0x1p-900;
    const double error = 2 * (volume_error + std::abs(f.distance.hi) * normal_error) / length;
    const double slack = error + std::abs(value) * 0x1p-52;
    const bool known = length > 1e6 * normal_error;
    f.lower = known ? value - slack : -std::numeric_limits<double>::infinity();
    f.upper = known ? value + slack : std::numeric_limits<double>::infinity();
  }
  const double eu = pair_.vector_error_dd(to_q), ev = pair_.vector_error_dd(to_r);
  const double a = norm1(p) + 3 * e, b = norm1(u) + 3 * eu, c = norm1(v) + 3 * ev;
  const double volume_error = 64 * 0x1p-104 * a * b * c + 2 * (e * b * c + eu * a * c + ev * a * b) + 0x1p-900;
  const double normal_error = 64 * 0x1p-104 * b * c + 4 * (eu * c + ev * b) + 0x1p-900;
  f.error = length > 1e6 * normal_error
                ? 2 * (volume_error + std::abs(value) * normal_error) / length + 0x1p-96 * std::abs(value)
                : std::numeric_limits<double>::infinity();
}

}  // namespace pd::detail
