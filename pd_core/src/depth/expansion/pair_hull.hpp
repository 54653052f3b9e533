/// @file
/// The exact convex hull of some vertices of P, grown one vertex at a time: what the searches for a nearest facet share
/// where doubles have failed.
///
/// Vertices are pairs of ids whose exact differences are never rounded; sides are exact. How far a face is from the
/// origin is measured by whoever asks, in doubles or in double-double.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "depth/expansion/growing_hull.hpp"
#include "numeric/double_double.hpp"
#include "shape/posed_pair.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

struct PairHullFace {
  std::int32_t v[3] = {-1, -1, -1};
  std::int32_t adj[3] = {-1, -1, -1};
  std::int32_t first = 0;  ///< index in `v` of the corner from which its plane is measured
  /// Signed distance of the plane from the origin, positive where the origin lies behind it (scaled lengths), within
  /// `error`; infinite: the normal drowned in rounding.
  DoubleDouble distance;
  double error = std::numeric_limits<double>::infinity();
  double lower = 0;  ///< the same as bounds in doubles
  double upper = 0;
  bool alive = true;
  bool facet = false;    ///< known to support P
  bool fine = false;     ///< measured in double-double
  bool farther = false;  ///< than the facet found, exactly
};

class PairHull : public GrowingHull<PairHull, PairHullFace> {
 public:
  using Face = PairHullFace;

  explicit PairHull(const PosedPair& pair) : pair_(pair) {}

  [[nodiscard]] const PosedPair& pair() const { return pair_; }
  [[nodiscard]] int num_vertices() const { return static_cast<int>(vertices_.size()); }
  [[nodiscard]] const VertexPair& vertex(int v) const { return vertices_[v]; }
  int add_vertex(const VertexPair& id) {
    vertices_.emplace_back(id);
    return num_vertices() - 1;
  }
  void drop_last_vertex() { vertices_.pop_back(); }
  /// Returns true if a vertex of P adds a dimension to the first ones, of which there are at most three.
  [[nodiscard]] bool is_independent(const VertexPair& id) const;
  /// Takes the given vertices for the first ones, at most four that span what they can.
  void begin(std::span<const VertexPair> given);

  /// From one vertex to another; of one body alone where they share the other's vertex.
  [[nodiscard]] PairVector edge(int from, int to) const { return edge(vertices_[from], vertices_[to]); }
  [[nodiscard]] static PairVector edge(const VertexPair& from, const VertexPair& to);
  /// The corners in their order, the one first from which the plane is measured.
  [[nodiscard]] static std::int32_t corner(const Face& f, int i) { return f.v[(f.first + i) % 3]; }
  /// The two edges there.
  [[nodiscard]] PairVector first_edge(const Face& f) const { return edge(corner(f, 0), corner(f, 1)); }
  [[nodiscard]] PairVector second_edge(const Face& f) const { return edge(corner(f, 0), corner(f, 2)); }
  [[nodiscard]] PairVector point(int v) const { return PairVector::point(vertices_[v].a, vertices_[v].b); }

  /// Times the pair's homogeneous factor.
  [[nodiscard]] const Dyadic3& exact_point(int v);
  /// Of a face that is alive; outward.
  [[nodiscard]] const Dyadic3& exact_normal(int f);
  /// Side of vertex v against the plane of face f: +1 outside.
  [[nodiscard]] int side(int f, int v);

  /// The tetrahedron of vertices 0 to 3, which must not lie in one plane.
  /// @param measure  of a new face: sets its distance.
  template <class Measure>
  void start(Measure&& measure) {
    if (pair_.sign_determinant(edge(0, 3), edge(0, 1), edge(0, 2)) > 0) std::swap(vertices_[1], vertices_[2]);
    start_tetrahedron(measure);
  }

  /// Replaces the faces strictly below vertex v, `from` among them.
  template <class Measure>
  void insert(int from, int v, Measure&& measure) {
    replace_below(from, v, measure);
  }

  /// In double-double. Leaves what drowned in rounding unbounded.
  void measure_finely(Face& f) const;

 private:
  /// A vertex of P and, once it was asked for, its exact place.
  struct Vertex : VertexPair {
    explicit Vertex(const VertexPair& id) : VertexPair(id) {}
    std::optional<Dyadic3> exact;
  };
  friend class GrowingHull<PairHull, PairHullFace>;
  /// The slot has another face now.
  void forget(int slot) {
    if (slot < static_cast<int>(normals_.size())) normals_[static_cast<std::size_t>(slot)].reset();
  }

  const PosedPair& pair_;
  std::vector<Vertex> vertices_;
  std::vector<std::optional<Dyadic3>> normals_;  ///< of faces, once they were asked for
};

}  // namespace pd::detail
