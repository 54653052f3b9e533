#include "depth/certificate/witness_points.hpp"

#include <algorithm>
#include <cmath>

#include "depth/distance/lane_simplex.hpp"
#include "numeric/double_double_lanes.hpp"
#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

/// Farther than any point of a pair, whose largest coordinate inside is at most 2^100.
constexpr double kFar = 0x1p110;

/// t + 2^exponent (first + sum of weight * (vertex - first)), rounded once: local coordinates and translations may both
/// be large and cancel.
Vec3 world_point(const PosedPair& pair, const Vec3& translation, const Vec3DD& first, const Vec3& rest) {
  const double scale = pair.outwards();
  const auto coordinate = [&](double t, const DoubleDouble& f, double r) {
    const DoubleDouble local = r == 0 ? f : f + DoubleDouble{r, 0};
    return to_double(DoubleDouble{t, 0} + DoubleDouble{local.hi * scale, local.lo * scale});
  };
  return {coordinate(translation.x(), first.x, rest.x()), coordinate(translation.y(), first.y, rest.y()),
          coordinate(translation.z(), first.z, rest.z())};
}

/// -R_A v.
PairVector opposite_of_a(std::int32_t v) { return {v, -1, -1, -1, false}; }
Vec3DD negated_vertex_a(const PosedPair& pair, std::int32_t v) { return pair.approximate_dd(opposite_of_a(v)); }
/// R_B v.
PairVector place_of_b(std::int32_t v) { return {-1, -1, v, -1, false}; }
Vec3DD vertex_b(const PosedPair& pair, std::int32_t v) { return pair.approximate_dd(place_of_b(v)); }

/// The last few rotated vertices of a body: a search comes back to them, and each takes nine products.
class RecentVertices {
 public:
  /// @param vertex  of the body, as a vector of the pair.
  RecentVertices(const PosedPair& pair, PairVector (*vertex)(std::int32_t)) : pair_(pair), vertex_(vertex) {}

  const FourDoubleDoubles& operator()(std::int32_t v) {
    for (int i = 0; i < kMost; ++i) {
      if (ids_[i] == v) return points_[i];
    }
    const int i = next_;
    next_ = (next_ + 1) % kMost;
    ids_[i] = v;
    pair_.approximate_dd(vertex_(v), points_[i]);
    return points_[i];
  }

 private:
  static constexpr int kMost = 4;

  const PosedPair& pair_;
  PairVector (*vertex_)(std::int32_t);
  std::int32_t ids_[kMost] = {-1, -1, -1, -1};
  FourDoubleDoubles points_[kMost];
  int next_ = 0;
};

/// A face's vertices as seen from the first of them, turned once: every step of a search asks for the farthest.
class FaceEdges {
 public:
  /// @param along  turns the edge from the face's first vertex to another one.
  template <class Along>
  FaceEdges(const SupportFace& face, const Along& along) : face_(face), kept_(std::min(face.size(), kMost)) {
    for (std::size_t i = 1; i < kept_; ++i) edges_[i] = along(face[i]);
  }

  /// The first one of those farthest along `direction`.
  template <class Along>
  [[nodiscard]] std::int32_t farthest(const Vec3& direction, const Along& along) const {
    std::size_t found = 0;
    double most = 0;
    for (std::size_t i = 1; i < face_.size(); ++i) {
      const double height = (i < kept_ ? edges_[i] : along(face_[i])).dot(direction);
      if (!(most < height)) continue;
      most = height;
      found = i;
    }
    return face_[found];
  }

 private:
  static constexpr std::size_t kMost = 32;  ///< further ones are turned again

  const SupportFace& face_;
  std::size_t kept_;
  Vec3 edges_[kMost];  ///< but the first
};

Vec3 point_of_a(const PosedPair& pair, const VertexPair* ids, const double* weights, int count, const Vec3DD& negated) {
  Vec3 rest = Vec3::Zero();
  for (int i = 1; i < count; ++i) rest += weights[i] * pair.approximate(PairVector::edge_a(ids[0].a, ids[i].a));
  return world_point(pair, pair.pose_a().translation(), {-negated.x, -negated.y, -negated.z}, rest);
}

Vec3 point_of_b(const PosedPair& pair, const VertexPair* ids, const double* weights, int count) {
  Vec3 rest = Vec3::Zero();
  for (int i = 1; i < count; ++i) rest += weights[i] * pair.approximate(PairVector::edge_b(ids[0].b, ids[i].b));
  return world_point(pair, pair.pose_b().translation(), vertex_b(pair, ids[0].b), rest);
}

/// Where the edges of two faces of two vertices come nearest, A's moved by the translation: as a point of A's.
Vec3 point_on_edge_of_a(const PosedPair& pair, const SupportFaces& faces, const Vec3& target) {
  const VertexPair ids[2] = {{faces.on_a[0], faces.on_b[0]}, {faces.on_a[1], faces.on_b[1]}};
  const Vec3 e = pair.approximate(PairVector::edge_a(ids[0].a, ids[1].a));
  const Vec3 f = pair.approximate(PairVector::edge_b(ids[0].b, ids[1].b));
  const Vec3DD first = pair.approximate_dd(PairVector::point(ids[0].a, ids[0].b));
  const Vec3 gap = high(first - Vec3DD{{target.x(), 0}, {target.y(), 0}, {target.z(), 0}});
  // |gap + t f - s e| is least: as the lines cross, and at an end where they cross beyond it.
  const Vec3 n = e.cross(f);
  const double squared = n.squaredNorm();
  double s = squared > 0 ? std::clamp(gap.cross(f).dot(n) / squared, 0.0, 1.0) : 0.5;
  const double t = (s * e - gap).dot(f) / f.squaredNorm();
  const double along = e.squaredNorm();  // 0 where an edge is too short for its square
  if ((t < 0 || t > 1) && along > 0) s = std::clamp((gap + (t > 1 ? f : Vec3(Vec3::Zero()))).dot(e) / along, 0.0, 1.0);
  const double weights[2] = {1 - s, s};
  return point_of_a(pair, ids, weights, 2, negated_vertex_a(pair, ids[0].a));
}

}  // namespace

/// The faces on_a and on_b lie in one supporting plane of P, and so does the translation, up to rounding: it is the
/// difference of two of their points. Those are read off the convex combination of the vertices' differences that is
/// closest to it, found in the facet's plane (Gilbert, Johnson, Keerthi on two polygons). Parallel facets and edges
/// need no case of their own.
CorePoints witness_points_overlapping(const PosedPair& pair, const SupportFaces& faces, const Vec3& unit,
                                      const Vec3& translation) {
  const SupportFace& on_a = faces.on_a;
  const SupportFace& on_b = faces.on_b;
  // Beside margins many powers of ten larger, what is left of a translation is their rounding.
  const Vec3 target = (translation * pair.inwards()).cwiseMax(-kFar).cwiseMin(kFar);
  // A vertex is where it is, whatever it lies on.
  const VertexPair first{on_a.front(), on_b.front()};
  const double whole = 1;
  if (on_a.size() == 1) {
    const Vec3 a = point_of_a(pair, &first, &whole, 1, negated_vertex_a(pair, first.a));
    return {a, a + translation};
  }
  if (on_b.size() == 1) {
    const Vec3 b = point_of_b(pair, &first, &whole, 1);
    return {b - translation, b};
  }
  if (on_a.size() == 2 && on_b.size() == 2) {
    const Vec3 a = point_on_edge_of_a(pair, faces, target);
    return {a, a + translation};
  }
  RecentVertices negated_a(pair, opposite_of_a), of_b(pair, place_of_b);
  FourDoubleDoubles offset;
  pair.approximate_dd({-1, -1, -1, -1, true}, offset);
  const auto difference = [&](std::int32_t a, std::int32_t b) {
    // Local coordinates may be large and cancel.
    DoubleDoubleLanes sum, more;
    load(sum, of_b(b));
    load(more, negated_a(a));
    add(sum, sum, more);
    load(more, offset);
    add(sum, sum, more);
    subtract(sum, sum, DoubleDoubleLanes{{target.x(), target.y(), target.z(), 0}, {0, 0, 0, 0}});
    const Vec3 x(sum.hi[0], sum.hi[1], sum.hi[2]);
    return DifferenceVertex{x - x.dot(unit) * unit, a, b};
  };
  const auto edge_b = [&](std::int32_t v) { return pair.approximate(PairVector::edge_b(on_b.front(), v)); };
  const auto edge_a = [&](std::int32_t v) { return Vec3(-pair.approximate(PairVector::edge_a(on_a.front(), v))); };
  const FaceEdges edges_a(on_a, edge_a), edges_b(on_b, edge_b);

  LaneSimplex simplex;
  simplex.add(difference(on_a.front(), on_b.front()));
  // All of it lies in a plane through the origin, which a triangle holds for certain.
  while (simplex.count() < 3 && simplex.point().squaredNorm() > 0) {
    const Vec3 toward = simplex.toward();
    if (!simplex.add(difference(edges_a.farthest(toward, edge_a), edges_b.farthest(toward, edge_b)))) break;
  }
  VertexPair ids[3];
  double weights[3];
  const int count = simplex.count();
  for (int k = 0; k < count; ++k) {
    ids[k] = {simplex.corner(k).a, simplex.corner(k).b};
    weights[k] = simplex.weight(k);
  }
  const Vec3 a = point_of_a(pair, ids, weights, count, vector_of(negated_a(ids[0].a)));
  return {a, a + translation};
}

CorePoints witness_points_separated(const PosedPair& pair, const VertexPair* simplex, const double* weights,
                                    int count) {
  return {point_of_a(pair, simplex, weights, count, negated_vertex_a(pair, simplex[0].a)),
          point_of_b(pair, simplex, weights, count)};
}

}  // namespace pd::detail
