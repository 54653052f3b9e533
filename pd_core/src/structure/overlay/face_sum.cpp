#include "structure/overlay/face_sum.hpp"

#include <array>
#include <cmath>
#include <span>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

double absolute_sum(const Vec3& v) { return v.cwiseAbs().sum(); }

double coordinate(const Vec3& v, int axis) { return v[axis]; }
const Dyadic& coordinate(const Dyadic3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

int facet_of_half_edge(const ConvexPolytope& body, int h) { return body.half_edge(h).facet; }
int other_facet_of_half_edge(const ConvexPolytope& body, int h) { return body.half_edge(body.half_edge(h).twin).facet; }

Feature edge_feature(const ConvexPolytope& body, int h) {
  const std::int32_t from = body.half_edge(h).origin, to = body.target(h);
  return {Feature::Kind::edge, std::min(from, to), std::max(from, to)};
}

/// The face of `body` in the supporting plane through its vertex v, given which edges at v lie in that plane.
/// `same_side(f)` tells a polygon's facet that faces the right way from its twin.
template <class InThePlane, class SameSide>
Feature face_at(const ConvexPolytope& body, int v, InThePlane&& in_plane, SameSide&& same_side) {
  int found[2] = {-1, -1};
  int count = 0;
  const int begin = body.first_half_edge(v);
  const int end = begin + static_cast<int>(body.neighbours(v).size());
  for (int h = begin; h < end && count < 2; ++h) {
    if (in_plane(h)) found[count++] = h;
  }
  if (count == 0) return {Feature::Kind::vertex, v, -1};
  if (count == 1) return edge_feature(body, found[0]);
  // Two edges at v in one supporting plane bound the facet in it.
  for (const int f : {facet_of_half_edge(body, found[0]), facet_of_half_edge(body, found[1])}) {
    const bool bounded_by_both =
        (facet_of_half_edge(body, found[0]) == f || other_facet_of_half_edge(body, found[0]) == f) &&
        (facet_of_half_edge(body, found[1]) == f || other_facet_of_half_edge(body, found[1]) == f);
    if (bounded_by_both && (body.affine_dimension() == 3 || same_side(f))) return {Feature::Kind::facet, f, -1};
  }
  return {Feature::Kind::none, -1, -1};  // unreachable: the two edges are consecutive round v
}

/// The corners of a face, in the order of the facet's loop.
void corners_of(const ConvexPolytope& body, const Feature& face, std::vector<std::int32_t>& corners) {
  corners.clear();
  switch (face.kind) {
    case Feature::Kind::facet: {
      const auto loop = body.facet_vertices(face.first);
      corners.assign(loop.begin(), loop.end());
      break;
    }
    case Feature::Kind::edge:
      corners = {face.first, face.second};
      break;
    default:
      corners = {face.first};
  }
}

Feature whole_body(const ConvexPolytope& body, int facet) {
  if (body.affine_dimension() == 2) return {Feature::Kind::facet, facet, -1};
  if (body.affine_dimension() == 1) return {Feature::Kind::edge, 0, 1};
  return {Feature::Kind::vertex, 0, -1};
}

}  // namespace

InPlane::InPlane(const PosedPair& pair, const PairVector& u, const PairVector& v) : pair_(&pair) {
  const Vec3 x = pair.approximate(u), y = pair.approximate(v);
  const double e = pair.vector_error();
  const double a = absolute_sum(x), b = absolute_sum(y);
  const Vec3 n = x.cross(y);
  const double size = n.cwiseAbs().maxCoeff(&axis_);
  if (size > (e * (a + b + 2 * e) + 3 * kUnitRoundoff * a * b) * (1 + 16 * kUnitRoundoff) + 0x1p-900) {
    sign_ = n[axis_] > 0 ? 1 : -1;
    return;
  }
  const Dyadic3 exact = cross(pair.exact(u), pair.exact(v));
  for (axis_ = 0; axis_ < 3 && sign_ == 0; ++axis_) sign_ = coordinate(exact, axis_).sign();
  --axis_;
}

int InPlane::turn(const PairVector& x, const PairVector& y) const {
  const Vec3 p = pair_->approximate(x), q = pair_->approximate(y);
  const double e = pair_->vector_error();
  const double a = absolute_sum(p), b = absolute_sum(q);
  const double value = coordinate(Vec3(p.cross(q)), axis_);
  if (std::abs(value) > (e * (a + b + 2 * e) + 3 * kUnitRoundoff * a * b) * (1 + 16 * kUnitRoundoff) + 0x1p-900) {
    return value > 0 ? sign_ : -sign_;
  }
  return sign_ * coordinate(cross(pair_->exact(x), pair_->exact(y)), axis_).sign();
}

std::optional<FacePair> whole_facet(const OverlayWalk& walk, const OverlayPiece& piece) {
  const PosedPair& pair = walk.pair();
  const ConvexPolytope& a = pair.a();
  const ConvexPolytope& b = pair.b();
  switch (piece.kind) {
    case OverlayPiece::Kind::facet_of_a: {
      // The facet of A stands for the facet of P whatever else lies in its plane.
      const int f = piece.a;
      const auto corner = FacetOfDifference::corners(a, f);
      const Feature on_b = face_at(
          b, piece.b, [&](int h) { return walk.side_of_edge_b(h, f, false) == 0; },
          [&](int g) {
            // P's outward normal v x u of the facet of A, and g's own, turn alike.
            const InPlane plane(pair, PairVector::edge_a(corner[0], corner[2]),
                                PairVector::edge_a(corner[0], corner[1]));
            const auto other = FacetOfDifference::corners(b, g);
            return plane.turn(PairVector::edge_b(other[0], other[1]), PairVector::edge_b(other[0], other[2])) > 0;
          });
      return FacePair{{Feature::Kind::facet, f, -1}, on_b};
    }
    case OverlayPiece::Kind::facet_of_b: {
      const int g = piece.b;
      bool facet_of_a_in_the_plane = false;
      int in_plane = 0;
      const Feature on_a = face_at(
          a, piece.a,
          [&](int h) {
            const bool zero = walk.side_of_edge_a(h, g, false) == 0;
            in_plane += zero ? 1 : 0;
            return zero;
          },
          [&](int) { return true; });
      facet_of_a_in_the_plane = in_plane == 2;
      if (facet_of_a_in_the_plane) return std::nullopt;
      return FacePair{on_a, {Feature::Kind::facet, g, -1}};
    }
    case OverlayPiece::Kind::edges:
      break;
  }
  // A facet of one body that holds its edge and is parallel to the other edge lies in this facet's plane (or the two
  // edges are parallel and the piece has no area).
  for (const int f : {facet_of_half_edge(a, piece.a), other_facet_of_half_edge(a, piece.a)}) {
    if (f >= 0 && walk.side_of_edge_b(piece.b, f, false) == 0) return std::nullopt;
  }
  for (const int g : {facet_of_half_edge(b, piece.b), other_facet_of_half_edge(b, piece.b)}) {
    if (g >= 0 && walk.side_of_edge_a(piece.a, g, false) == 0) return std::nullopt;
  }
  return FacePair{edge_feature(a, piece.a), edge_feature(b, piece.b)};
}

void sum_loop(const PosedPair& pair, const FacePair& faces, const InPlane& plane, std::vector<DifferencePoint>& loop) {
  std::vector<std::int32_t> of_a, of_b;
  corners_of(pair.a(), faces.on_a, of_a);
  corners_of(pair.b(), faces.on_b, of_b);
  // A facet's loop is counter-clockwise about its own normal, the opposite of P's; a point reflection keeps turns.
  std::reverse(of_a.begin(), of_a.end());
  const std::size_t na = of_a.size(), nb = of_b.size();
  loop.clear();
  if (na == 1 || nb == 1) {
    for (const std::int32_t a : of_a) {
      for (const std::int32_t b : of_b) loop.push_back({a, b});
    }
    return;
  }

  const auto step_a = [&](std::size_t i) {
    return PairVector::edge_a(of_a[(i + 1) % na], of_a[i % na]);
  };  // -(next - this)
  const auto step_b = [&](std::size_t j) { return PairVector::edge_b(of_b[j % nb], of_b[(j + 1) % nb]); };
  // Angles from the first step of B's loop: [0, pi) before [pi, 2 pi). A's loop starts at its first step past 0.
  const PairVector zero = step_b(0);
  const auto second_half = [&](const PairVector& x) {
    const int turn = plane.turn(zero, x);
    return turn < 0 || (turn == 0 && pair.sign_dot(zero, x) < 0);
  };
  std::size_t start = 0;
  while (start < na && !(second_half(step_a(start + na - 1)) && !second_half(step_a(start)))) ++start;
  start %= na;

  std::size_t i = 0, j = 0;
  while (i < na || j < nb) {
    loop.push_back({of_a[(start + i) % na], of_b[j % nb]});
    if (i == na) {
      ++j;
      continue;
    }
    if (j == nb) {
      ++i;
      continue;
    }
    const PairVector x = step_a(start + i), y = step_b(j);
    const bool late_x = second_half(x), late_y = second_half(y);
    const int order = late_x != late_y ? (late_x ? -1 : 1) : plane.turn(x, y);
    if (order >= 0) ++i;
    if (order <= 0) ++j;
  }
}

std::optional<FlatDifference> flat_difference(const PosedPair& pair) {
  if (pair.a().affine_dimension() == 3 || pair.b().affine_dimension() == 3) return std::nullopt;
  std::array<PairVector, 4> spanning;
  std::size_t count = 0;
  for (const bool of_a : {false, true}) {
    const ConvexPolytope& body = of_a ? pair.a() : pair.b();
    const auto edge = [&](int from, int to) {
      spanning[count++] = of_a ? PairVector::edge_a(from, to) : PairVector::edge_b(from, to);
    };
    if (body.affine_dimension() == 1) edge(0, 1);
    if (body.affine_dimension() == 2) {
      const auto corner = FacetOfDifference::corners(body, 0);
      edge(corner[0], corner[1]);
      edge(corner[0], corner[2]);
    }
  }
  FlatDifference flat;
  flat.faces = {whole_body(pair.a(), 0), whole_body(pair.b(), 0)};
  if (count == 0) return flat;
  flat.u = spanning[0];
  flat.affine_dimension = 1;
  for (std::size_t i = 1; i < count; ++i) {
    const PairVector& w = spanning[i];
    if (flat.affine_dimension == 1) {
      if (pair.parallel(flat.u, w)) continue;
      flat.v = w;
      flat.affine_dimension = 2;
    } else if (pair.sign_determinant(flat.u, flat.v, w) != 0) {
      return std::nullopt;
    }
  }
  if (flat.affine_dimension == 1) return flat;
  // The sides of doubly covered bodies that face along u x v (B's) and against it (A's).
  const InPlane plane(pair, flat.u, flat.v);
  if (pair.b().affine_dimension() == 2) {
    const auto corner = FacetOfDifference::corners(pair.b(), 0);
    const int turn = plane.turn(PairVector::edge_b(corner[0], corner[1]), PairVector::edge_b(corner[0], corner[2]));
    flat.faces.on_b.first = turn > 0 ? 0 : 1;
  }
  if (pair.a().affine_dimension() == 2) {
    const auto corner = FacetOfDifference::corners(pair.a(), 0);
    const int turn = plane.turn(PairVector::edge_a(corner[0], corner[1]), PairVector::edge_a(corner[0], corner[2]));
    flat.faces.on_a.first = turn < 0 ? 0 : 1;
  }
  return flat;
}

bool contains_origin(const PosedPair& pair, const FlatDifference& flat, std::vector<DifferencePoint>& loop) {
  if (flat.affine_dimension < 2) {
    // At most two vertices each: P is the hull of their differences, on one line or at one point.
    bool before = false, after = false;
    for (int a = 0; a < pair.a().num_vertices(); ++a) {
      for (int b = 0; b < pair.b().num_vertices(); ++b) {
        const PairVector p = PairVector::point(a, b);
        const int size = pair.sign_dot(p, p);
        if (size == 0) return true;
        if (flat.affine_dimension == 0 || !pair.parallel(p, flat.u)) return false;
        (pair.sign_dot(p, flat.u) < 0 ? before : after) = true;
      }
    }
    return before && after;
  }
  if (pair.sign_determinant(PairVector::point(0, 0), flat.u, flat.v) != 0) return false;
  const InPlane plane(pair, flat.u, flat.v);
  sum_loop(pair, flat.faces, plane, loop);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const DifferencePoint& p = loop[i];
    const DifferencePoint& q = loop[(i + 1) % loop.size()];
    // The origin lies to the left of p -> q: turn(q - p, -p) >= 0.
    if (plane.turn(PairVector::difference(p.a, p.b, q.a, q.b), PairVector::point(p.a, p.b)) > 0) return false;
  }
  return true;
}

}  // namespace pd::detail
