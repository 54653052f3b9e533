#include "depth/facets/unique_nearest_facet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "depth/difference/support_double_double.hpp"
#include "depth/expansion/pair_hull.hpp"
#include "numeric/unit_roundoff.hpp"
#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

double sum_of(const Vec3& v) { return v.cwiseAbs().sum(); }

/// In doubles; the bounds as in `PairHull::measure_finely`, with u in the place of double-double's unit.
void measure_roughly(const PairHull& hull, PairHull::Face& f) {
  const PosedPair& pair = hull.pair();
  // From an end of the shortest edge: where one body is tiny, two long edges of a sliver drown what tells them apart.
  double shortest = kUnbounded;
  for (int k = 0; k < 3; ++k) {
    const double length = pair.approximate(hull.edge(f.v[k], f.v[(k + 1) % 3])).squaredNorm();
    if (!(length < shortest)) continue;
    shortest = length;
    f.first = k;
  }
  const PairVector to_q = hull.first_edge(f), to_r = hull.second_edge(f);
  const Vec3 p = pair.approximate(hull.point(PairHull::corner(f, 0)));
  const Vec3 u = pair.approximate(to_q);
  const Vec3 v = pair.approximate(to_r);
  const Vec3 n = u.cross(v);
  const double ep = pair.vector_error(), eu = pair.vector_error(to_q), ev = pair.vector_error(to_r);
  const double a = sum_of(p) + 3 * ep, b = sum_of(u) + 3 * eu, c = sum_of(v) + 3 * ev;
  const double volume_error = 16 * kUnitRoundoff * a * b * c + 2 * (ep * b * c + eu * a * c + ev * a * b) + 0x1p-900;
  const double normal_error = 16 * kUnitRoundoff * b * c + 4 * (eu * c + ev * b) + 0x1p-900;
  const double length = n.norm();
  if (!(length > 1e3 * normal_error)) return;
  f.distance.hi = p.dot(n) / length;
  f.error = 2 * (volume_error + std::abs(f.distance.hi) * normal_error) / length + 0x1p-50 * std::abs(f.distance.hi);
}

/// Lower bound of x's distance less y's lower bound.
bool bounded_before(const PairHull::Face& x, const PairHull::Face& y) {
  if (!(x.error < kUnbounded) || !(y.error < kUnbounded)) return x.error > y.error;
  return to_double(x.distance - y.distance) < x.error - y.error;
}

class UniqueFacetSearch {
 public:
  UniqueFacetSearch(const PosedPair& pair, SupportFaces& faces, UniqueNearestFacet& out)
      : pair_(pair), faces_(faces), out_(out), hull_(pair) {}

  void run(std::span<const VertexPair> start, int budget) {
    if (!begin(start)) return;
    hull_.start([&](PairHull::Face& f) { measure_roughly(hull_, f); });
    // Each pass adds a vertex, measures a face more finely or proves one to be a facet.
    while (out_.support_calls < budget) {
      const int nearest = nearest_face();
      if (proven_ && (nearest < 0 || certainly_beyond(hull_.face(nearest)))) {
        out_.found = named();
        return;
      }
      if (nearest < 0) return;
      PairHull::Face& face = hull_.face(nearest);
      out_.ended = corners_of(face);
      if (!(face.error < kUnbounded) || contested_) {
        if (refine(face)) continue;
        if (!(face.error < kUnbounded)) return;
      }
      if (expand(nearest, support(normal_of(face))) || refine(face)) continue;
      // Nothing lies beyond the nearest face, as far as double-double tells.
      if (!(to_double(face.distance) > face.error)) return;
      if (proven_) {
        const int order = compare_with_proven(nearest);
        face.farther = order > 0;
        if (order > 0 || expand(nearest, exact_support(nearest))) continue;
        if (order == 0 || !prove(face)) return;
      } else if (!prove(face) && !expand(nearest, exact_support(nearest))) {
        return;
      }
    }
  }

 private:
  /// Of the outward normal: doubles for a face measured in doubles.
  [[nodiscard]] Vec3DD normal_of(const PairHull::Face& f) const {
    const PairVector u = hull_.first_edge(f), v = hull_.second_edge(f);
    if (!f.fine) return widened(pair_.approximate(u).cross(pair_.approximate(v)).normalized());
    const Vec3DD n = cross(pair_.approximate_dd(u), pair_.approximate_dd(v));
    return scaled(n, {1 / high(n).norm(), 0});
  }

  VertexPair support(const Vec3DD& direction) {
    ++out_.support_calls;
    return support_double_double(pair_, direction);
  }

  /// A vertex of P that is farthest, exactly.
  VertexPair exact_support(int f) {
    ++out_.support_calls;
    const PairHull::Face& face = hull_.face(f);
    const PairVector u = hull_.first_edge(face), v = hull_.second_edge(face);
    const RoundedDirection rounded =
        rounded_cross(pair_.approximate(u), pair_.vector_error(u), pair_.approximate(v), pair_.vector_error(v));
    return support_exactly(pair_, rounded, hull_.vertex(PairHull::corner(face, 0)),
                           [&](const PairVector& edge) { return pair_.sign_determinant(edge, u, v); });
  }

  /// Whether the vertex of P lies beyond the face, and was inserted.
  bool expand(int f, const VertexPair& s) {
    const PairHull::Face& face = hull_.face(f);
    for (const std::int32_t v : face.v) {
      if (hull_.vertex(v).a == s.a && hull_.vertex(v).b == s.b) return false;
    }
    const int v = hull_.add_vertex(s);
    if (hull_.side(f, v) <= 0) {
      hull_.drop_last_vertex();
      return false;
    }
    hull_.insert(f, v, [&](PairHull::Face& made) { measure_roughly(hull_, made); });
    return true;
  }

  /// False where double-double has measured it already.
  bool refine(PairHull::Face& f) const {
    if (f.fine) return false;
    hull_.measure_finely(f);
    return true;
  }

  /// The face with the least bound, those in the proven facet's plane left out; `contested_` where doubles do not tell
  /// whether the next one is nearer.
  [[nodiscard]] int nearest_face() {
    int nearest = -1, next = -1;
    for (int f = 0; f < static_cast<int>(hull_.faces().size()); ++f) {
      const PairHull::Face& face = hull_.face(f);
      if (!face.alive || (next >= 0 && !bounded_before(face, hull_.face(next)))) continue;
      if (proven_ && (face.farther || lies_in_plane(face))) continue;
      next = f;
      if (nearest < 0 || bounded_before(face, hull_.face(nearest))) std::swap(nearest, next);
    }
    contested_ = false;
    if (next >= 0) {
      const PairHull::Face &x = hull_.face(nearest), &y = hull_.face(next);
      contested_ = !(to_double(y.distance - x.distance) > x.error + y.error);
    }
    return nearest;
  }

  [[nodiscard]] bool lies_in_plane(const PairHull::Face& f) const {
    return std::all_of(std::begin(f.v), std::end(f.v), [&](std::int32_t v) {
      const VertexPair& p = hull_.vertex(v);
      return std::binary_search(faces_.on_a.begin(), faces_.on_a.end(), p.a) &&
             std::binary_search(faces_.on_b.begin(), faces_.on_b.end(), p.b);
    });
  }

  [[nodiscard]] bool certainly_beyond(const PairHull::Face& f) const {
    const FacetPlane& plane = proven_->plane;
    return f.error < kUnbounded &&
           to_double(f.distance - plane.distance) > (f.error + plane.distance_error) * (1 + 0x1p-40);
  }

  /// Sign of the face's distance less the proven facet's, by fractions.
  int compare_with_proven(int f) {
    if (!least_) least_ = squared_distance(pair_, proven_->facet);
    const Dyadic3& normal = hull_.exact_normal(f);
    const Dyadic height = dot(normal, hull_.exact_point(hull_.face(f).v[0]));
    ++out_.facets_visited;
    return compare(SquaredFacetDistance{height * height, dot(normal, normal)}, *least_);
  }

  [[nodiscard]] SurfaceCorners corners_of(const PairHull::Face& f) const {
    SurfaceCorners corners;
    for (int i = 0; i < 3; ++i) corners.v[i] = hull_.vertex(PairHull::corner(f, i));
    return corners;
  }

  bool prove(const PairHull::Face& f) {
    ++out_.facets_visited;
    least_.reset();
    const SurfaceCorners corners = corners_of(f);
    proven_ = prove_nearest_facet(pair_, std::span(&corners, 1), kUnbounded, false, faces_);
    return proven_.has_value();
  }

  /// The proven facet by the features that an exact search would name it by.
  [[nodiscard]] std::optional<ProvenFacet> named() const {
    const Vec3 unit = high(proven_->plane.unit);
    if (faces_.on_a.size() != 2 || faces_.on_b.size() != 2) {
      const FacetOfDifference facet = facet_of_faces(pair_, faces_.on_a, faces_.on_b, unit);
      return ProvenFacet{facet, measure_facet(pair_, facet)};
    }
    for (const bool turned : {false, true}) {
      const std::int32_t from = faces_.on_a[turned ? 1 : 0], to = faces_.on_a[turned ? 0 : 1];
      const FacetOfDifference facet = FacetOfDifference::from_edges(from, to, faces_.on_b[0], faces_.on_b[1]);
      const FacetPlane plane = measure_facet(pair_, facet);
      if (plane.known() && to_double(plane.distance) > plane.distance_error) return ProvenFacet{facet, plane};
    }
    return std::nullopt;
  }

  /// Four vertices of P that do not lie in one plane, for certain: those given, then the farthest in directions towards
  /// the origin across what they span, or any other.
  bool begin(std::span<const VertexPair> start) {
    hull_.begin(start);
    if (hull_.num_vertices() == 0) hull_.add_vertex({0, 0});
    while (hull_.num_vertices() < 4) {
      if (!grow()) return false;
    }
    return true;
  }

  bool grow() {
    const int known = hull_.num_vertices();
    const Vec3 p = pair_.approximate(hull_.point(0));
    // Each about as long as a unit vector, or none.
    std::array<Vec3, 4> directions{-p.stableNormalized(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    std::size_t count = 4;
    if (known == 2) {
      const Vec3 e = pair_.approximate(hull_.edge(0, 1)).normalized();
      for (Vec3& d : directions) d -= d.dot(e) * e;
    } else if (known == 3) {
      const Vec3 n =
          pair_.approximate(hull_.edge(0, 1)).normalized().cross(pair_.approximate(hull_.edge(0, 2)).normalized());
      directions[0] = n.dot(p) > 0 ? Vec3(-n) : n;
      count = 1;
    }
    for (const Vec3& d : std::span(directions).first(count)) {
      const double length = d.norm();
      if (!(length > 0x1p-40)) continue;
      for (const double sign : {1.0, -1.0}) {
        const VertexPair s = support(widened(sign / length * d));
        if (!hull_.is_independent(s)) continue;
        hull_.add_vertex(s);
        return true;
      }
    }
    return false;
  }

  const PosedPair& pair_;
  SupportFaces& faces_;
  UniqueNearestFacet& out_;
  PairHull hull_;
  std::optional<ProvenFacet> proven_;
  std::optional<SquaredFacetDistance> least_;  ///< of the proven facet, once it was asked for
  bool contested_ = false;
};

}  // namespace

UniqueNearestFacet unique_nearest_facet(const PosedPair& pair, std::span<const VertexPair> start, int budget,
                                        SupportFaces& faces) {
  UniqueNearestFacet out;
  UniqueFacetSearch(pair, faces, out).run(start, budget);
  return out;
}

}  // namespace pd::detail
