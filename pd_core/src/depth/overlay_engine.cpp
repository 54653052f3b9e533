#include "depth/overlay_engine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace pd::detail {

namespace {

constexpr double kU = 0x1p-53;
constexpr double kUdd = 0x1p-104;  ///< relative error unit of double-double operations, each < 5u^2 < 2 kUdd
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double norm1(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }
Vec3 high(const Vec3DD& v) { return {v.x.hi, v.y.hi, v.z.hi}; }

/// A facet's plane: offset <point, n> and normal n, neither normalised, with errors of `offset` and of each coordinate
/// of the normal.
struct Plane {
  Vec3 normal;
  double normal_error;
  double offset;
  double offset_error;
};

/// Error of <point, normal> when their coordinates err by `point_error` and `normal_error` and the sum by `relative`.
double offset_error(double point_norm1, double normal_norm1, double point_error, double normal_error, double relative) {
  return (point_norm1 * normal_error + normal_norm1 * point_error + 3 * point_error * normal_error +
          relative * point_norm1 * normal_norm1) *
         (1 + 16 * kU);
}

/// The order of pieces that lie at exactly the same distance.
std::array<std::int32_t, 5> rank(const PosedPair& pair, const OverlayPiece& piece) {
  const FacetOfDifference f = facet_of(pair, piece);
  return {static_cast<std::int32_t>(piece.kind), f.on_a.first, f.on_a.second, f.on_b.first, f.on_b.second};
}

/// The search: the nearest plane so far, in as many stages as were needed.
class NearestPlane {
 public:
  NearestPlane(const PosedPair& pair, const OverlayDepthBuffers& buffers)
      : pair_(pair), buffers_(buffers), point_error_((2 * pair.vector_error()) * (1 + 8 * kU)) {}

  /// False when the origin lies strictly outside some facet (`separating` names it).
  bool consume(std::span<const OverlayPiece> pieces) {
    for (const OverlayPiece& piece : pieces) {
      ++visited_;
      const Plane plane = evaluate(piece);
      const double length = std::sqrt(plane.normal.squaredNorm());
      // Rejected when the plane is certainly farther than the nearest one: offset / |normal| > upper.
      const double longest = (length * (1 + 8 * kU) + 2 * plane.normal_error);
      if (plane.offset - plane.offset_error > upper_ * longest) continue;
      if (!consider(piece, plane, length)) return false;
    }
    return true;
  }

  [[nodiscard]] std::int64_t visited() const { return visited_; }
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] bool outside() const { return outside_; }
  [[nodiscard]] bool zero() const { return zero_; }
  [[nodiscard]] const OverlayPiece& piece() const { return best_; }

 private:
  /// A distance as a double-double with an error bound, or infinitely uncertain.
  struct Distance {
    DoubleDouble value;
    double error;
  };
  /// offset |offset| / |normal|^2 as a fraction of exact numbers.
  struct Squared {
    Dyadic numerator;
    Dyadic denominator;
  };

  Plane evaluate(const OverlayPiece& piece) const {
    const PosedDiagram& a = buffers_.overlay.a;
    const PosedDiagram& b = buffers_.overlay.b;
    Plane plane;
    int va = piece.a, vb = piece.b;
    switch (piece.kind) {
      case OverlayPiece::Kind::facet_of_a: {
        const PosedDiagram::Facet& f = a.facets[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(-f.normal[0], -f.normal[1], -f.normal[2]);
        plane.normal_error = f.error;
        va = pair_.a().facet_vertices(piece.a)[0];
        break;
      }
      case OverlayPiece::Kind::facet_of_b: {
        const PosedDiagram::Facet& f = b.facets[static_cast<std::size_t>(piece.b)];
        plane.normal = Vec3(f.normal[0], f.normal[1], f.normal[2]);
        plane.normal_error = f.error;
        vb = pair_.b().facet_vertices(piece.b)[0];
        break;
      }
      case OverlayPiece::Kind::edges: {
        const PosedDiagram::Edge& x = b.half_edges[static_cast<std::size_t>(piece.b)];
        const PosedDiagram::Edge& y = a.half_edges[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(x.vector[1] * y.vector[2] - x.vector[2] * y.vector[1],
                            x.vector[2] * y.vector[0] - x.vector[0] * y.vector[2],
                            x.vector[0] * y.vector[1] - x.vector[1] * y.vector[0]);
        const double e = pair_.vector_error();
        plane.normal_error = (e * (x.norm1 + y.norm1 + 2 * e) + 3 * kU * x.norm1 * y.norm1) * (1 + 8 * kU);
        va = pair_.a().half_edge(piece.a).origin;
        vb = pair_.b().half_edge(piece.b).origin;
      }
    }
    const Vec3 point = buffers_.posed_b[static_cast<std::size_t>(vb)] + buffers_.posed_a[static_cast<std::size_t>(va)];
    plane.offset = point.dot(plane.normal);
    const double size = norm1(point);
    plane.offset_error =
        offset_error(size, norm1(plane.normal), point_error_ + kU * size, plane.normal_error, 4 * kU) + 0x1p-900;
    return plane;
  }

  bool consider(const OverlayPiece& piece, const Plane& plane, double length) {
    const FacetOfDifference facet = facet_of(pair_, piece);
    // Two exactly parallel edges span no plane.
    if (piece.kind == OverlayPiece::Kind::edges && length <= 2 * plane.normal_error &&
        pair_.parallel(facet.u, facet.v)) {
      return true;
    }
    int sign = 1;
    if (!(plane.offset > plane.offset_error)) {
      sign = pair_.sign_determinant(facet.point(), facet.u, facet.v);
    }
    if (sign < 0) {
      outside_ = found_ = true;
      best_ = piece;
      return false;
    }
    if (sign == 0) {
      if (!found_ || !zero_ || rank(pair_, piece) < rank(pair_, best_)) best_ = piece;
      found_ = zero_ = true;
      upper_ = 0;
      return true;
    }
    if (zero_) return true;
    const Distance distance = measure(facet);
    if (!found_ || nearer(piece, facet, distance)) {
      best_ = piece;
      best_facet_ = facet;
      best_distance_ = distance;
      best_squared_known_ = false;
      found_ = true;
    }
    // The bound is that of the best plane in double-double, rounded up.
    upper_ = std::isfinite(best_distance_.error)
                 ? (to_double(best_distance_.value) + best_distance_.error) * (1 + 4 * kU)
                 : kInfinity;
    return true;
  }

  Distance measure(const FacetOfDifference& facet) const {
    const Vec3DD u = pair_.approximate_dd(facet.u), v = pair_.approximate_dd(facet.v);
    const Vec3DD p = pair_.approximate_dd(facet.point());
    const Vec3DD n = cross(u, v);
    const double e = pair_.vector_error_dd();
    const double su = norm1(high(u)), sv = norm1(high(v));
    const double normal_error = (e * (su + sv + 2 * e) + 8 * kUdd * su * sv) * (1 + 16 * kU) + 0x1p-900;
    const DoubleDouble squared = dot(n, n);
    const double length = std::sqrt(squared.hi);
    if (!(length > 4 * normal_error)) return {{0, 0}, kInfinity};
    const DoubleDouble value = dot(p, n) / sqrt(squared);
    // value = N / |n|: dN / |n| + |value| d|n| / |n|, both over the least possible |n|; operations' own rounding last.
    const double least = length * (1 - 8 * kU) - 2 * normal_error;
    const double numerator = offset_error(norm1(high(p)), norm1(high(n)), e, normal_error, 16 * kUdd);
    const double magnitude = std::abs(to_double(value));
    return {value, ((numerator + 2 * normal_error * magnitude) / least + 64 * kUdd * magnitude) * (1 + 16 * kU)};
  }

  /// Whether the piece replaces the best one.
  bool nearer(const OverlayPiece& piece, const FacetOfDifference& facet, const Distance& distance) {
    const double gap = to_double(distance.value - best_distance_.value);
    if (std::abs(gap) > (distance.error + best_distance_.error) * (1 + 4 * kU)) return gap < 0;
    if (!best_squared_known_) best_squared_ = squared(best_facet_);
    best_squared_known_ = true;
    const Squared s = squared(facet);
    const int order = (s.numerator * best_squared_.denominator - best_squared_.numerator * s.denominator).sign();
    if (order != 0) return order < 0;
    return rank(pair_, piece) < rank(pair_, best_);
  }

  /// Of a plane with a positive offset; the common factor of the two homogeneous vectors drops out of comparisons.
  Squared squared(const FacetOfDifference& facet) const {
    const Dyadic3 n = cross(pair_.exact(facet.u), pair_.exact(facet.v));
    const Dyadic offset = dot(pair_.exact(facet.point()), n);
    return {offset * offset, dot(n, n)};
  }

  const PosedPair& pair_;
  const OverlayDepthBuffers& buffers_;
  double point_error_;
  double upper_ = kInfinity;
  bool found_ = false;
  bool outside_ = false;
  bool zero_ = false;
  bool best_squared_known_ = false;
  OverlayPiece best_{};
  FacetOfDifference best_facet_;
  Distance best_distance_{{0, 0}, kInfinity};
  Squared best_squared_;
  std::int64_t visited_ = 0;
};

}  // namespace

OverlayDepth overlay_depth(const PosedPair& pair, OverlayDepthBuffers& buffers) {
  OverlayDepth result;
  const std::optional<FlatDifference> flat = flat_difference(pair);
  if (flat && !contains_origin(pair, *flat, buffers.loop)) return result;
  if (flat && flat->affine_dimension < 2) {
    result.contact = ContactClass::touching;
    return result;
  }
  if (flat && pair.a().affine_dimension() < 2 && pair.b().affine_dimension() < 2) {
    // Two crossing segments: the parallelogram has no overlay, only its plane.
    result.contact = ContactClass::touching;
    result.has_facet = true;
    result.facet = FacetOfDifference::from_edges(0, 1, 0, 1);
    return result;
  }

  buffers.posed_a.resize(static_cast<std::size_t>(pair.a().num_vertices()));
  for (int v = 0; v < pair.a().num_vertices(); ++v) {
    PairVector minus_a;
    minus_a.a_to = v;
    buffers.posed_a[static_cast<std::size_t>(v)] = pair.approximate(minus_a);
  }
  buffers.posed_b.resize(static_cast<std::size_t>(pair.b().num_vertices()));
  for (int v = 0; v < pair.b().num_vertices(); ++v) {
    PairVector b;
    b.b_to = v;
    b.translated = true;
    buffers.posed_b[static_cast<std::size_t>(v)] = pair.approximate(b);
  }
  OverlayWalk walk(pair, buffers.overlay);
  NearestPlane nearest(pair, buffers);
  walk.run([&](std::span<const OverlayPiece> pieces) { return nearest.consume(pieces); });

  result.facets_visited = nearest.visited();
  result.has_facet = nearest.found();
  if (nearest.found()) result.facet = facet_of(pair, nearest.piece());
  result.contact = nearest.outside() ? ContactClass::separated
                   : nearest.zero()  ? ContactClass::touching
                                     : ContactClass::overlapping;
  return result;
}

}  // namespace pd::detail
