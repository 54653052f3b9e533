#include "depth/facets/gauss_ties.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "depth/facets/gauss_foot.hpp"

namespace pd::detail {

namespace {

/// An angle that is larger than any small one; it stands for a direction of which nothing is known.
constexpr double kAnyTurn = 1;
/// Facets turned by more are compared by their distances.
constexpr double kSmallTurn = 0x1p-20;

class Ties {
 public:
  Ties(const PosedPair& pair, const PolytopeDifference& difference, const NearGaussPieces& near)
      : pair_(pair), difference_(difference), near_(near), turned_(pair.pose_a(), pair.pose_b()) {}

  /// Finds the nearest facet. Up to rounding several vertices, or parallel edges, are as far along a piece's normal,
  /// and any of them may be the farthest.
  [[nodiscard]] std::optional<ProvenFacet> nearest(SupportFaces& faces) const {
    std::optional<ProvenFacet> proven;
    const auto proves = [&](int i, Piece& holder, int a, int b) {
      holder.corner = difference_.vertex(a, b);
      proven = prove(i, holder, faces);
      return proven.has_value();
    };
    for (int i = 0; i < near_.count && !proven; ++i) {
      Piece holder = at(i);
      const DifferenceVertex corner = holder.corner;
      if (holder.kind == NearFacetsBuffers::Kind::edges) {
        const Edge first_a{holder.edge_a[0], holder.edge_a[1]}, first_b{holder.edge_b[0], holder.edge_b[1]};
        any_edge(difference_.a(), difference_.posed_a(), first_a, holder.normal, [&](const Edge& of_a) {
          return any_edge(difference_.b(), difference_.posed_b(), first_b, holder.normal, [&](const Edge& of_b) {
            std::copy_n(of_a.begin(), 2, holder.edge_a);
            std::copy_n(of_b.begin(), 2, holder.edge_b);
            return proves(i, holder, of_a[0], of_b[0]);
          });
        });
        continue;
      }
      const bool of_a = holder.kind == NearFacetsBuffers::Kind::facet_of_a;
      any_vertex(of_a ? difference_.posed_b() : difference_.posed_a(), holder.vertex, holder.normal, [&](int v) {
        holder.vertex = v;
        return proves(i, holder, of_a ? corner.a : v, of_a ? v : corner.b);
      });
    }
    return proven;
  }

 private:
  /// A piece has its features, its unit normal and a corner.
  struct Piece : NearFacets {
    DifferenceVertex corner;
  };
  [[nodiscard]] Piece at(int i) const {
    Piece out;
    const GaussPiece& piece = near_.pieces[i].piece;
    out.corner = difference_.vertex(piece.a[0], piece.b[0]);
    out.normal = normal_of_piece(piece, turned_, difference_).normalized();
    name_piece(piece, out.corner, out);
    return out;
  }

  /// Returns the facet of a piece, if it holds the foot, supports P and is the nearest.
  std::optional<ProvenFacet> prove(int i, Piece& holder, SupportFaces& faces) const {
    const double flush = flush_turn(holder);
    if (!(flush > 0)) return std::nullopt;
    const FacetOfDifference facet = facet_of(pair_, holder);
    const FacetPlane plane = measure_facet(pair_, facet);
    if (!plane.known() || !(to_double(plane.distance) > plane.distance_error)) return std::nullopt;
    if (!others_are_farther(i, holder, flush, plane)) return std::nullopt;
    return prove_facet(pair_, facet, near_.beyond * pair_.inwards(), faces);
  }

  /// Returns an angle up to which other facets are no nearer; not above 0 if the piece does not hold the foot for
  /// certain.
  [[nodiscard]] double flush_turn(Piece& holder) const {
    const double height = holder.corner.x.dot(holder.normal);
    if (!(height > 0)) return 0;
    const std::optional<double> inside = foot_inside(difference_, holder.corner, height, holder);
    if (!inside) return 0;
    // Rounding counts for more by how long the sides are over the piece's least width.
    const double sharpness = 1 + slenderness(holder);
    // In this order a NaN stays one, and the piece is refused.
    return std::min((*inside - foot_rounding(difference_) * sharpness * sharpness) / height, kSmallTurn);
  }
  /// Bounds the lengths of a piece's sides over its least width.
  [[nodiscard]] double slenderness(const NearFacets& piece) const {
    if (piece.kind == NearFacetsBuffers::Kind::edges) {
      const Vec3 e = turned_edge(difference_.posed_a(), piece.edge_a),
                 f = turned_edge(difference_.posed_b(), piece.edge_b);
      return difference_.reach() * std::max(e.norm(), f.norm()) / e.cross(f).norm();
    }
    const ConvexPolytope& body = piece.kind == NearFacetsBuffers::Kind::facet_of_a ? difference_.a() : difference_.b();
    const auto loop = body.facet_vertices(piece.facet);
    Vec3 last = body.vertex(loop.back());
    double shortest = body.radius();
    for (const std::int32_t v : loop) {
      const Vec3 next = body.vertex(v);
      shortest = std::min(shortest, (next - last).norm());
      last = next;
    }
    return 2 * body.radius() / shortest;
  }
  /// Visits vertices as far along a normal as `first`, up to rounding, until a visit returns true.
  template <class Visit>
  bool any_vertex(const VertexArrays& posed, int first, const Vec3& normal, Visit&& visit) const {
    const double level = turned_vertex(posed, first).dot(normal) - foot_rounding(difference_);
    for (int v = 0; v < posed.count; ++v) {
      if (turned_vertex(posed, v).dot(normal) >= level && visit(v)) return true;
    }
    return false;
  }
  using Edge = std::array<std::int32_t, 2>;
  /// Visits edges as far along a normal as `first`, and parallel to that edge, up to rounding.
  template <class Visit>
  bool any_edge(const ConvexPolytope& body, const VertexArrays& posed, const Edge& first, const Vec3& normal,
                Visit&& visit) const {
    const Vec3 along = turned_vertex(posed, first[1]) - turned_vertex(posed, first[0]);
    const double level = turned_vertex(posed, first[0]).dot(normal) - foot_rounding(difference_);
    return any_vertex(posed, first[0], normal, [&](int v) {
      const auto next = body.neighbours(v);
      return std::any_of(next.begin(), next.end(), [&](std::int32_t w) {
        const Vec3 other = turned_vertex(posed, w) - turned_vertex(posed, v);
        const double cosine = other.dot(along), sine_squared = other.cross(along).squaredNorm();
        return cosine > 0 && sine_squared <= kSmallTurn * kSmallTurn * cosine * cosine &&
               turned_vertex(posed, w).dot(normal) >= level && visit(Edge{v, w});
      });
    });
  }

  /// Bounds the angle between the holder's normal and that of a piece from above; `kAnyTurn` if it is large.
  [[nodiscard]] double turn_from(const NearFacets& holder, const NearFacets& other) const {
    if (!(other.normal.dot(holder.normal) > 0)) return kAnyTurn;
    const double turn = other.normal.cross(holder.normal).norm() + normal_error(holder) + normal_error(other);
    return turn * (1 + 0x1p-10);
  }
  /// Bounds the error of a normal. The normals of facets err by 33u when they are turned. Edges err by 14u of their
  /// body's radius each, and their product by 4u.
  [[nodiscard]] double normal_error(const NearFacets& piece) const {
    if (piece.kind != NearFacetsBuffers::Kind::edges) return 0x1p-46;
    const Vec3 e = turned_edge(difference_.posed_a(), piece.edge_a),
               f = turned_edge(difference_.posed_b(), piece.edge_b);
    const double error =
        32 * kUnitRoundoff * (difference_.a().radius() * f.norm() + difference_.b().radius() * e.norm());
    const double length = e.cross(f).norm();
    return length > 2 * error ? 2 * error / length : kAnyTurn;
  }

  [[nodiscard]] bool others_are_farther(int of, const NearFacets& holder, double flush, const FacetPlane& plane) const {
    for (int i = 0; i < near_.count; ++i) {
      if (i == of) continue;
      const Piece other = at(i);
      if (turn_from(holder, other) < flush) continue;
      const FacetPlane farther = measure_facet(pair_, facet_of(pair_, other));
      const double error = (farther.distance_error + plane.distance_error) * (1 + 0x1p-40);
      if (!farther.known() || !(to_double(farther.distance - plane.distance) > error)) return false;
    }
    return true;
  }

  const PosedPair& pair_;
  const PolytopeDifference& difference_;
  const NearGaussPieces& near_;
  TurnedNormals turned_;
};

}  // namespace

FacetOfDifference facet_of(const PosedPair& pair, const NearFacets& piece) {
  switch (piece.kind) {
    case NearFacetsBuffers::Kind::facet_of_a:
      return FacetOfDifference::from_facet_of_a(pair.a(), piece.facet, piece.vertex);
    case NearFacetsBuffers::Kind::facet_of_b:
      return FacetOfDifference::from_facet_of_b(pair.b(), piece.facet, piece.vertex);
    case NearFacetsBuffers::Kind::edges:
      break;
  }
  return FacetOfDifference::from_edges(piece.edge_a[0], piece.edge_a[1], piece.edge_b[0], piece.edge_b[1]);
}

std::optional<ProvenFacet> nearest_of_ties(const PosedPair& pair, const PolytopeDifference& difference,
                                           const NearGaussPieces& near, SupportFaces& faces) {
  return Ties(pair, difference, near).nearest(faces);
}

}  // namespace pd::detail
