/// @file
/// A growing simplicial surface about the origin, every facet with the cone over it: the hull that kernels are built
/// on.
///
/// Invariants: the origin lies strictly inside every facet's plane, and the cones over the facets tile the space. So a
/// point p lies in one cone, p = sum lambda_k v_k with lambda >= 0 over that facet's vertices, and gauge = sum lambda
/// is a proof that p lies in gauge * conv(vertices). The proof needs no convexity of the surface, which rounding can
/// take away; what rounding leaves of lambda < 0 is below 1e-9 and is taken into account by whoever certifies.
///
/// Insertion is that of incremental hulls: the connected region of facets that see the point is replaced by the cone
/// from the point over the region's horizon. The start is a small cross-polytope of vertices that stand for no point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pd/dimension/vector.hpp"

namespace pd::dimension::detail {

template <int D>
class RadialHull {
 public:
  struct Facet {
    std::array<std::int32_t, D> vertex;
    std::array<std::int32_t, D> neighbour;  ///< across the ridge without vertex k
    Matrix<D> inverse;                      ///< lambda = inverse * p
    Vector<D> normal;                       ///< the plane is <normal, x> = 1; gauge(p) = <normal, p> in the cone
    std::int32_t successor;                 ///< -1 while alive, then a facet that took over a part of the cone
  };

  explicit RadialHull(double start_radius);

  [[nodiscard]] const std::vector<Facet>& facets() const { return facets_; }
  [[nodiscard]] bool alive(std::int32_t f) const { return facets_[f].successor < 0; }
  [[nodiscard]] std::int64_t num_facets() const { return alive_; }
  [[nodiscard]] const std::vector<Vector<D>>& vertices() const { return vertices_; }
  /// Vertices 0 .. 2 D - 1 are those of the start.
  static constexpr std::int32_t kStartVertices = 2 * D;

  /// The living facet whose cone holds p, walking from a facet that may be dead. Counts facets visited.
  std::int32_t locate(const Vector<D>& p, std::int32_t start, std::int64_t& visited) const;

  [[nodiscard]] double gauge(std::int32_t f, const Vector<D>& p) const { return facets_[f].normal.dot(p); }

  /// Inserts p, which lies beyond facet f. False, and nothing changed, where rounding leaves no surface with the
  /// invariants. `removed()` and `added()` then tell of the last insertion.
  bool insert(const Vector<D>& p, std::int32_t f);
  [[nodiscard]] const std::vector<std::int32_t>& removed() const { return removed_; }
  [[nodiscard]] const std::vector<std::int32_t>& added() const { return added_; }

  /// Drops dead facets, which take memory and the nearest cache. Returns each old facet's new number; of a dead one,
  /// that of a living facet that took over a part of its cone.
  std::vector<std::int32_t> compact();

  /// Distance of the nearest facet plane from the origin.
  [[nodiscard]] double inner_radius() const;

 private:
  struct Ridge {
    std::int32_t facet;  ///< seen
    int opposite;
  };
  bool complete(Facet& facet) const;
  void mark_visible(const Vector<D>& p, std::int32_t f);
  void unmark();
  bool plan_cone(std::int32_t v);
  void link_cone();

  double least_distance_;  ///< of a facet's plane from the origin, in theory at least that of the start
  std::vector<Vector<D>> vertices_;
  std::vector<Facet> facets_;
  std::int64_t alive_ = 0;
  // Of the insertion under way:
  std::vector<char> visible_;                         ///< a flag a facet
  std::vector<std::array<std::int32_t, D>> cone_of_;  ///< per facet and ridge of a seen facet: the facet over it
  std::vector<std::int32_t> removed_, added_;
  std::vector<Ridge> horizon_;
  std::vector<Facet> planned_;
};

}  // namespace pd::dimension::detail
