#include "structure/overlay/overlay_walk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numeric/unit_roundoff.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

/// Vertices of a higher degree are searched by halving.
constexpr int kLargeDegree = 16;

/// The fixed axis w of the symbolic rotation: short dyadic numbers (exact arithmetic stays short) in no simple ratio,
/// so that one filtered sign decides nearly every tie. The axes y and z follow; the three are independent since w_x !=
/// 0.
constexpr double kAxis[3] = {40503.0 / 65536, 52433.0 / 65536, 61169.0 / 65536};

double norm1(const double (&v)[3]) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); }

PairVector edge_vector(bool of_a, int from, int to) {
  return of_a ? PairVector::edge_a(from, to) : PairVector::edge_b(from, to);
}

}  // namespace

struct OverlayWalk::Side {
  bool is_a;
  const ConvexPolytope* body;
  PosedDiagram* diagram;
};

FacetOfDifference facet_of(const PosedPair& pair, const OverlayPiece& piece) {
  switch (piece.kind) {
    case OverlayPiece::Kind::facet_of_a:
      return FacetOfDifference::from_facet_of_a(pair.a(), piece.a, piece.b);
    case OverlayPiece::Kind::facet_of_b:
      return FacetOfDifference::from_facet_of_b(pair.b(), piece.b, piece.a);
    case OverlayPiece::Kind::edges:
      break;
  }
  return FacetOfDifference::from_edges(pair.a().half_edge(piece.a).origin, pair.a().target(piece.a),
                                       pair.b().half_edge(piece.b).origin, pair.b().target(piece.b));
}

OverlayWalk::OverlayWalk(const PosedPair& pair, OverlayBuffers& buffers) : pair_(&pair), buffers_(&buffers) {
  pose_edges(pair, true, buffers.a);
  pose_edges(pair, false, buffers.b);
  pose_facets(pair.a(), buffers.b, buffers.a);
  pose_facets(pair.b(), buffers.a, buffers.b);
}

int OverlayWalk::side_of_edge_a(int half_edge_a, int facet_b, bool symbolic) const {
  const PosedDiagram::Edge& e = buffers_->a.half_edges[static_cast<std::size_t>(half_edge_a)];
  const PosedDiagram::Facet& f = buffers_->b.facets[static_cast<std::size_t>(facet_b)];
  const double value = e.vector[0] * f.normal[0] + e.vector[1] * f.normal[1] + e.vector[2] * f.normal[2];
  if (std::abs(value) > f.bound * e.size) return value > 0 ? 1 : -1;
  return decide_exactly(true, half_edge_a, facet_b, symbolic);
}

int OverlayWalk::side_of_edge_b(int half_edge_b, int facet_a, bool symbolic) const {
  const PosedDiagram::Edge& e = buffers_->b.half_edges[static_cast<std::size_t>(half_edge_b)];
  const PosedDiagram::Facet& f = buffers_->a.facets[static_cast<std::size_t>(facet_a)];
  const double value = e.vector[0] * f.normal[0] + e.vector[1] * f.normal[1] + e.vector[2] * f.normal[2];
  if (std::abs(value) > f.bound * e.size) return value > 0 ? 1 : -1;
  return decide_exactly(false, half_edge_b, facet_a, symbolic);
}

int OverlayWalk::side(const Side& edge_body, int half_edge, const Side&, int facet) const {
  return edge_body.is_a ? side_of_edge_a(half_edge, facet) : side_of_edge_b(half_edge, facet);
}

int OverlayWalk::decide_exactly(bool edge_of_a, int half_edge, int facet, bool symbolic) const {
  const ConvexPolytope& edge_body = edge_of_a ? pair_->a() : pair_->b();
  const ConvexPolytope& facet_body = edge_of_a ? pair_->b() : pair_->a();
  const PairVector e = edge_vector(edge_of_a, edge_body.half_edge(half_edge).origin, edge_body.target(half_edge));
  const auto corner = FacetOfDifference::corners(facet_body, facet);
  const PairVector u = edge_vector(!edge_of_a, corner[0], corner[1]);
  const PairVector v = edge_vector(!edge_of_a, corner[0], corner[2]);
  // First what is read off the stored numbers: the edges along a prism lie in each of its sides.
  const int sign = pair_->vanishes_term_by_term(e, u, v) ? 0 : pair_->sign_determinant(e, u, v);
  if (sign != 0 || !symbolic) return sign;

  // <e, n> = 0. Turning A moves <e, n> by <omega, e x n> when e is of A, and by -<omega, e x n> when n is.
  const int direction = edge_of_a ? 1 : -1;
  const PosedDiagram& edges = edge_of_a ? buffers_->a : buffers_->b;
  const PosedDiagram& facets = edge_of_a ? buffers_->b : buffers_->a;
  const PosedDiagram::Edge& x = edges.half_edges[static_cast<std::size_t>(half_edge)];
  const PosedDiagram::Facet& y = facets.facets[static_cast<std::size_t>(facet)];
  const double c[3] = {x.vector[1] * y.normal[2] - x.vector[2] * y.normal[1],
                       x.vector[2] * y.normal[0] - x.vector[0] * y.normal[2],
                       x.vector[0] * y.normal[1] - x.vector[1] * y.normal[0]};
  const double value = kAxis[0] * c[0] + kAxis[1] * c[1] + kAxis[2] * c[2];
  // |w|_inf < 1: the error of the cross product's coordinates (as in `pose_facets`) summed, and 4u for the sum.
  const double sn = norm1(y.normal);
  const double edge_error = edges.edge_error;
  const double normal_error = facets.normal_errors[static_cast<std::size_t>(facet)];
  const double bound =
      3 * (x.size * normal_error + sn * edge_error + 3 * edge_error * normal_error + 3 * kUnitRoundoff * x.size * sn) +
      4 * kUnitRoundoff * norm1(c);
  if (std::abs(value) > bound * (1 + 16 * kUnitRoundoff) + 0x1p-900) return value > 0 ? direction : -direction;

  const Dyadic3 moved = cross(pair_->exact(e), cross(pair_->exact(u), pair_->exact(v)));
  const Dyadic first = dot(to_dyadic(Vec3(kAxis[0], kAxis[1], kAxis[2])), moved);
  for (const int s : {first.sign(), moved.y.sign(), moved.z.sign()}) {
    if (s != 0) return direction * s;
  }
  assert(false && "an edge and a normal both orthogonal and parallel");
  return 0;
}

bool OverlayWalk::flush() {
  const bool wanted = filled_ == 0 || sink_(context_, std::span<const OverlayPiece>(buffers_->block.data(), filled_));
  filled_ = 0;
  return wanted;
}

bool OverlayWalk::emit(OverlayPiece::Kind kind, std::int32_t a, std::int32_t b) {
  buffers_->block[filled_++] = {kind, a, b};
  return filled_ < OverlayBuffers::kBlock || flush();
}

bool OverlayWalk::emit(const Side& moving, std::int32_t of_moving, std::int32_t of_fixed, OverlayPiece::Kind kind) {
  return moving.is_a ? emit(kind, of_moving, of_fixed) : emit(kind, of_fixed, of_moving);
}

bool OverlayWalk::run_all() {
  filled_ = 0;
  const Side a{true, &pair_->a(), &buffers_->a};
  const Side b{false, &pair_->b(), &buffers_->b};
  const int dimension_a = a.body->affine_dimension();
  const int dimension_b = b.body->affine_dimension();
  if (dimension_a < 2 && dimension_b < 2) return true;
  if (dimension_a == 1) return walk_segment(a, b) && flush();
  if (dimension_b == 1) return walk_segment(b, a) && flush();

  locate_facets(a, b);
  locate_facets(b, a);
  for (int f = 0; f < a.body->num_facets(); ++f) {
    if (!emit(OverlayPiece::Kind::facet_of_a, f, a.diagram->cell[static_cast<std::size_t>(f)])) return false;
  }
  for (int f = 0; f < b.body->num_facets(); ++f) {
    if (!emit(OverlayPiece::Kind::facet_of_b, b.diagram->cell[static_cast<std::size_t>(f)], f)) return false;
  }
  if (dimension_a == 0 || dimension_b == 0) return flush();

  // Entering a cell costs its degree, so the arcs of the body with the greater largest degree do the moving.
  const auto largest_degree = [](const ConvexPolytope& body) {
    int largest = 0;
    for (int v = 0; v < body.num_vertices(); ++v) {
      largest = std::max(largest, static_cast<int>(body.neighbours(v).size()));
    }
    return largest;
  };
  const bool b_moves = largest_degree(*b.body) > largest_degree(*a.body);
  return (b_moves ? walk_arcs(b, a) : walk_arcs(a, b)) && flush();
}

/// A segment's diagram is one great circle: the other body's facets and arcs on its two sides and across.
bool OverlayWalk::walk_segment(const Side& segment, const Side& other) {
  const ConvexPolytope& body = *other.body;
  const int half_edge = segment.body->half_edge(0).origin == 0 ? 0 : 1;  // from vertex 0 to vertex 1
  for (int f = 0; f < body.num_facets(); ++f) {
    // The plane of f is supported from the other side by the end of the segment with the least <., n_f>.
    const int s = side(segment, half_edge, other, f);
    other.diagram->cell[static_cast<std::size_t>(f)] = s > 0 ? 0 : 1;
    if (!emit(other, f, s > 0 ? 0 : 1, other.is_a ? OverlayPiece::Kind::facet_of_a : OverlayPiece::Kind::facet_of_b)) {
      return false;
    }
  }
  for (int h = 0; h < body.num_half_edges(); ++h) {
    // From the left facet to the right one the normal turns about the edge e. Where <segment, n> falls through 0,
    // n = e x segment up to a positive factor; with both bodies' signs (P's normal is minus A's) this is always
    // (edge of B) x (edge of A) when h is the one of the two half-edges whose left facet has the sign +.
    const HalfEdge e = body.half_edge(h);
    const int left = other.diagram->cell[static_cast<std::size_t>(e.facet)];
    const int right = other.diagram->cell[static_cast<std::size_t>(body.half_edge(e.twin).facet)];
    if (left == 0 && right == 1 && !emit(other, h, half_edge, OverlayPiece::Kind::edges)) return false;
  }
  return true;
}

/// Finds for every facet of `moving` the vertex of `fixed` that is extreme against its normal: hill climbing from the
/// vertex of a neighbouring facet, neighbours with near normals first, so that the climbs are short. By convexity an
/// exact local maximum is the maximum.
void OverlayWalk::locate_facets(const Side& moving, const Side& fixed) {
  const ConvexPolytope& body = *moving.body;
  const ConvexPolytope& target = *fixed.body;
  if (body.num_facets() == 0) return;
  constexpr int kLevels = 4;
  constexpr double kCosine[kLevels - 1] = {0.99, 0.9, 0.5};
  std::int32_t head[kLevels] = {-1, -1, -1, -1};
  std::vector<OverlayBuffers::Visit>& visits = buffers_->visits;
  visits.clear();
  visits.reserve(static_cast<std::size_t>(body.num_half_edges()) + 1);

  const PosedDiagram::Facet& first = moving.diagram->facets[0];
  const Vec3 against(-first.normal[0], -first.normal[1], -first.normal[2]);
  const Pose& pose = fixed.is_a ? pair_->pose_a() : pair_->pose_b();
  visits.push_back({0, support_vertex(target, pose.rotation().transpose() * against, -1), -1});
  head[0] = 0;
  for (;;) {
    int level = 0;
    while (level < kLevels && head[level] < 0) ++level;
    if (level == kLevels) return;
    const OverlayBuffers::Visit visit = visits[static_cast<std::size_t>(head[level])];
    head[level] = visit.next;
    std::int32_t& cell = moving.diagram->cell[static_cast<std::size_t>(visit.facet)];
    if (cell >= 0) continue;

    int at = visit.start;
    for (bool improved = true; improved;) {
      improved = false;
      const int begin = target.first_half_edge(at);
      const int end = begin + static_cast<int>(target.neighbours(at).size());
      for (int h = begin; h < end; ++h) {
        if (side(fixed, h, moving, visit.facet) < 0) {
          at = target.target(h);
          improved = true;
          break;
        }
      }
    }
    cell = at;

    const int start = body.facet_half_edge(visit.facet);
    for (int h = start;;) {
      const HalfEdge half_edge = body.half_edge(h);
      const int next = body.half_edge(half_edge.twin).facet;
      if (moving.diagram->cell[static_cast<std::size_t>(next)] < 0) {
        const double cosine = body.facet_normal(visit.facet).dot(body.facet_normal(next));
        int near = 0;
        while (near < kLevels - 1 && cosine <= kCosine[near]) ++near;
        visits.push_back({next, cell, head[near]});
        head[near] = static_cast<std::int32_t>(visits.size()) - 1;
      }
      h = half_edge.next;
      if (h == start) break;
    }
  }
}

/// Walks every arc of `moving` through the cells of `fixed`, from the cell of one end to the cell of the other.
///
/// Let e be the half-edge of the arc. As n goes from the left facet's normal to the right one's it turns about e, and
/// so does p = -n, which is the direction whose cell in the diagram of `fixed` counts. A cell is convex, its boundary
/// runs counter-clockwise from the normal of the right facet of each half-edge k to that of its left facet, and +e is
/// to the left of p's motion: p leaves through the one arc k with <e, right normal> < 0 < <e, left normal>, where it is
/// parallel to k x e. An arc of less than half a circle between two points of one convex cell stays in it.
bool OverlayWalk::walk_arcs(const Side& moving, const Side& fixed) {
  const ConvexPolytope& body = *moving.body;
  const ConvexPolytope& target = *fixed.body;
  const auto degree = [&](int v) { return static_cast<int>(target.neighbours(v).size()); };
  for (int h = 0; h < body.num_half_edges(); ++h) {
    const int twin = body.half_edge(h).twin;
    if (twin < h) continue;
    int e = h;
    int at = moving.diagram->cell[static_cast<std::size_t>(body.half_edge(h).facet)];
    int goal = moving.diagram->cell[static_cast<std::size_t>(body.half_edge(twin).facet)];
    if (at == goal) continue;
    // The first cell is gone round, so the walk begins at the end with the smaller one.
    if (degree(at) > kLargeDegree && degree(goal) < degree(at)) {
      std::swap(at, goal);
      e = twin;
    }

    int begin = target.first_half_edge(at);
    const int end = begin + degree(at);
    int exit = begin;
    int before = side(moving, e, fixed, target.half_edge(target.half_edge(begin).twin).facet);
    for (; exit < end; ++exit) {
      const int after = side(moving, e, fixed, target.half_edge(exit).facet);
      if (before < 0 && after > 0) break;
      before = after;
    }
    assert(exit < end);
    for (;;) {
      if (!emit(moving, e, exit, OverlayPiece::Kind::edges)) return false;
      const int entry = target.half_edge(exit).twin;
      at = target.half_edge(entry).origin;
      if (at == goal) break;
      // Counter-clockwise from the entry the left facets lie on the negative side first, then on the positive one up to
      // the entry's right facet: the exit is the first of those.
      begin = target.first_half_edge(at);
      const int count = degree(at);
      const auto positive = [&](int k) { return side(moving, e, fixed, target.half_edge(k).facet) > 0; };
      if (count <= kLargeDegree) {
        exit = entry;
        do {
          if (++exit == begin + count) exit = begin;
        } while (!positive(exit));
        continue;
      }
      const auto after_entry = [&](int k) { return begin + (entry - begin + k) % count; };
      int first = 1;
      for (int last = count - 1; first < last;) {
        const int middle = (first + last) / 2;
        if (positive(after_entry(middle))) {
          last = middle;
        } else {
          first = middle + 1;
        }
      }
      exit = after_entry(first);
    }
  }
  return true;
}

}  // namespace pd::detail
