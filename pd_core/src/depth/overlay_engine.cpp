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
  explicit NearestPlane(const OverlayWalk& walk)
      : walk_(walk), pair_(walk.pair()), a_(walk.buffers().a), b_(walk.buffers().b) {
    PairVector translation;
    translation.translated = true;
    offset_ = pair_.approximate(translation);
    const double error = pair_.vector_error();
    reach_ = (a_.reach + b_.reach + norm1(offset_) + 3 * error) * (1 + 8 * kU);
    point_error_ = (3 * error + 2 * kU * reach_) * (1 + 8 * kU);
    // For edges x, y and n = x x y the error of n is e (|x| + |y| + 2e) + 3u |x||y| per coordinate (1-norms), and that
    // of <point, n> is reach error(n) + |n|_1 (error(point) + 4u reach) + 3 error(n) error(point). With 2 reach
    // error(n) for the length of n, all of it is a polynomial in |x| and |y| whose coefficients belong to the pair.
    const double edge_error = std::max(a_.edge_error, b_.edge_error);
    const double per_normal_error = 3 * reach_ + 3 * point_error_;
    constant_ = (2 * edge_error * edge_error * per_normal_error) * (1 + 16 * kU) + 0x1p-900;
    linear_ = edge_error * per_normal_error * (1 + 16 * kU);
    bilinear_ = (3 * kU * per_normal_error + point_error_ + 4 * kU * reach_) * (1 + 16 * kU);
  }

  /// False when the origin lies strictly outside some facet (`piece` is it).
  bool consume(std::span<const OverlayPiece> pieces) {
    visited_ += static_cast<std::int64_t>(pieces.size());
    for (const OverlayPiece& piece : pieces) {
      if (piece.kind == OverlayPiece::Kind::edges && far_edges(piece)) continue;
      const Plane plane = evaluate(piece);
      const double length = std::sqrt(plane.normal.squaredNorm());
      // Rejected when the plane is certainly farther than the nearest one: offset / |normal| > upper.
      const double longest = length * (1 + 8 * kU) + 2 * plane.normal_error;
      if (plane.offset - plane.offset_error > upper_ * longest) continue;
      if (!consider(piece, plane)) return false;
    }
    return true;
  }

  [[nodiscard]] std::int64_t visited() const { return visited_; }
  [[nodiscard]] std::int64_t exact_comparisons() const { return exact_comparisons_; }
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

  /// Whether an edge-edge plane is certainly farther than the nearest one, by one comparison of squares.
  bool far_edges(const OverlayPiece& piece) const {
    const PosedDiagram::Edge& x = b_.half_edges[static_cast<std::size_t>(piece.b)];
    const PosedDiagram::Edge& y = a_.half_edges[static_cast<std::size_t>(piece.a)];
    const Vec3& on_b = b_.points[static_cast<std::size_t>(pair_.b().half_edge(piece.b).origin)];
    const Vec3& on_a = a_.points[static_cast<std::size_t>(pair_.a().half_edge(piece.a).origin)];
    const double n0 = x.vector[1] * y.vector[2] - x.vector[2] * y.vector[1];
    const double n1 = x.vector[2] * y.vector[0] - x.vector[0] * y.vector[2];
    const double n2 = x.vector[0] * y.vector[1] - x.vector[1] * y.vector[0];
    const double offset = (on_b.x() - on_a.x() + offset_.x()) * n0 + (on_b.y() - on_a.y() + offset_.y()) * n1 +
                          (on_b.z() - on_a.z() + offset_.z()) * n2;
    const double least = offset - (constant_ + linear_ * (x.size + y.size) + bilinear_ * (x.size * y.size));
    return least > 0 && least * least > upper_squared_ * (n0 * n0 + n1 * n1 + n2 * n2) + 0x1p-900;
  }

  Plane evaluate(const OverlayPiece& piece) const {
    Plane plane;
    int va = piece.a, vb = piece.b;
    switch (piece.kind) {
      case OverlayPiece::Kind::facet_of_a: {
        const PosedDiagram::Facet& f = a_.facets[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(-f.normal[0], -f.normal[1], -f.normal[2]);
        plane.normal_error = a_.normal_errors[static_cast<std::size_t>(piece.a)];
        va = pair_.a().facet_vertices(piece.a)[0];
        break;
      }
      case OverlayPiece::Kind::facet_of_b: {
        const PosedDiagram::Facet& f = b_.facets[static_cast<std::size_t>(piece.b)];
        plane.normal = Vec3(f.normal[0], f.normal[1], f.normal[2]);
        plane.normal_error = b_.normal_errors[static_cast<std::size_t>(piece.b)];
        vb = pair_.b().facet_vertices(piece.b)[0];
        break;
      }
      case OverlayPiece::Kind::edges: {
        const PosedDiagram::Edge& x = b_.half_edges[static_cast<std::size_t>(piece.b)];
        const PosedDiagram::Edge& y = a_.half_edges[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(x.vector[1] * y.vector[2] - x.vector[2] * y.vector[1],
                            x.vector[2] * y.vector[0] - x.vector[0] * y.vector[2],
                            x.vector[0] * y.vector[1] - x.vector[1] * y.vector[0]);
        const double e = std::max(a_.edge_error, b_.edge_error);
        plane.normal_error = (e * (x.size + y.size + 2 * e) + 3 * kU * x.size * y.size) * (1 + 8 * kU);
        va = pair_.a().half_edge(piece.a).origin;
        vb = pair_.b().half_edge(piece.b).origin;
      }
    }
    const Vec3 point = b_.points[static_cast<std::size_t>(vb)] - a_.points[static_cast<std::size_t>(va)] + offset_;
    plane.offset = point.dot(plane.normal);
    plane.offset_error =
        offset_error(norm1(point), norm1(plane.normal), point_error_, plane.normal_error, 4 * kU) + 0x1p-900;
    return plane;
  }

  bool consider(const OverlayPiece& piece, const Plane& plane) {
    // A piece that only cuts another one's plane (or has no area) adds nothing, and its tie would cost exact
    // arithmetic.
    if (piece.kind != OverlayPiece::Kind::facet_of_a && !whole_facet(walk_, piece)) return true;
    const FacetOfDifference facet = facet_of(pair_, piece);
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
      set_upper(0);
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
    set_upper(std::isfinite(best_distance_.error)
                  ? (to_double(best_distance_.value) + best_distance_.error) * (1 + 4 * kU)
                  : kInfinity);
    return true;
  }

  /// Upper bound of the nearest plane's distance. Below the reach, as the error polynomial of `far_edges` requires.
  void set_upper(double upper) {
    upper_ = upper;
    upper_squared_ = upper <= reach_ ? upper * upper * (1 + 64 * kU) : kInfinity;
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
    ++exact_comparisons_;
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

  const OverlayWalk& walk_;
  const PosedPair& pair_;
  const PosedDiagram& a_;
  const PosedDiagram& b_;
  Vec3 offset_;
  double reach_;
  double point_error_;
  double constant_;
  double linear_;
  double bilinear_;
  double upper_ = kInfinity;
  double upper_squared_ = kInfinity;
  bool found_ = false;
  bool outside_ = false;
  bool zero_ = false;
  bool best_squared_known_ = false;
  OverlayPiece best_{};
  FacetOfDifference best_facet_;
  Distance best_distance_{{0, 0}, kInfinity};
  Squared best_squared_;
  std::int64_t visited_ = 0;
  std::int64_t exact_comparisons_ = 0;
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

  OverlayWalk walk(pair, buffers.overlay);
  NearestPlane nearest(walk);
  walk.run([&](std::span<const OverlayPiece> pieces) { return nearest.consume(pieces); });

  result.facets_visited = nearest.visited();
  result.exact_comparisons = nearest.exact_comparisons();
  result.has_facet = nearest.found();
  if (nearest.found()) result.facet = facet_of(pair, nearest.piece());
  result.contact = nearest.outside() ? ContactClass::separated
                   : nearest.zero()  ? ContactClass::touching
                                     : ContactClass::overlapping;
  return result;
}

}  // namespace pd::detail
