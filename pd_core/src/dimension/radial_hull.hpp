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
#include <span>
#include <vector>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

class RadialHull {
 public:
  struct Facet {
    std::array<std::int32_t, kMaxDimension> vertex;     ///< as many as the dimension
    std::array<std::int32_t, kMaxDimension> neighbour;  ///< across the ridge without vertex k
    std::int32_t successor;  ///< -1 while alive, then a facet that took over a part of the cone
  };

  RadialHull(int dimension, double start_radius);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] const std::vector<Facet>& facets() const { return facets_; }
  [[nodiscard]] bool alive(std::int32_t f) const { return facets_[f].successor < 0; }
  [[nodiscard]] std::int64_t num_facets() const { return alive_; }
  [[nodiscard]] const std::vector<AnyVector>& vertices() const { return vertices_; }
  /// Vertices below this are those of the start.
  [[nodiscard]] std::int32_t start_vertices() const { return 2 * dimension_; }
  [[nodiscard]] std::span<const std::int32_t> vertices_of(std::int32_t f) const {
    return {facets_[f].vertex.data(), static_cast<std::size_t>(dimension_)};
  }
  [[nodiscard]] std::span<const std::int32_t> neighbours_of(std::int32_t f) const {
    return {facets_[f].neighbour.data(), static_cast<std::size_t>(dimension_)};
  }
  /// lambda = inverse * p
  [[nodiscard]] Eigen::Map<const AnyMatrix> inverse(std::int32_t f) const {
    return Eigen::Map<const AnyMatrix>(numbers(f), dimension_, dimension_);
  }
  /// The plane is <normal, x> = 1.
  [[nodiscard]] Eigen::Map<const AnyVector> normal(std::int32_t f) const {
    return Eigen::Map<const AnyVector>(normal_data(f), dimension_);
  }

  /// The living facet whose cone holds p, walking from a facet that may be dead. Counts facets visited.
  std::int32_t locate(const AnyVector& p, std::int32_t start, std::int64_t& visited) const;

  /// <normal, p>, in the cone.
  [[nodiscard]] double gauge(std::int32_t f, const AnyVector& p) const {
    return dot(normal_data(f), p.data(), dimension_);
  }

  /// Inserts p, which lies beyond facet f. False, and nothing changed, where rounding leaves no surface with the
  /// invariants. `removed()` and `added()` then tell of the last insertion.
  bool insert(const AnyVector& p, std::int32_t f);
  [[nodiscard]] const std::vector<std::int32_t>& removed() const { return removed_; }
  [[nodiscard]] const std::vector<std::int32_t>& added() const { return added_; }

  /// Drops dead facets, which take memory and the nearest cache. Returns each old facet's new number; of a dead one,
  /// that of a living facet that took over a part of its cone.
  std::vector<std::int32_t> compact();

  /// Distance of the nearest facet plane from the origin.
  [[nodiscard]] double inner_radius() const;

  /// Fetches the numbers of a facet into the nearest cache.
  void prefetch(std::int32_t f) const {
    for (std::size_t k = 0; k < stride_; k += 8) __builtin_prefetch(numbers(f) + k);
    __builtin_prefetch(&facets_[f]);
  }

 private:
  struct Ridge {
    std::int32_t facet;  ///< seen
    int opposite;
  };
  [[nodiscard]] const double* numbers(std::int32_t f) const { return numbers_.data() + stride_ * f; }
  [[nodiscard]] const double* normal_data(std::int32_t f) const { return numbers(f) + dimension_ * dimension_; }
  bool complete(const Facet& facet, double* numbers) const;
  template <int D>
  std::int32_t walk(const double* p, std::int32_t start, std::int64_t& visited) const;
  void mark_visible(const AnyVector& p, std::int32_t f);
  void unmark();
  bool plan_cone(std::int32_t v);
  void link_cone();

  int dimension_;
  std::size_t stride_;     ///< of `numbers_`
  double least_distance_;  ///< of a facet's plane from the origin, in theory at least that of the start
  std::vector<AnyVector> vertices_;
  std::vector<Facet> facets_;
  std::vector<double> numbers_;  ///< per facet: the inverse, column by column, and the normal
  std::int64_t alive_ = 0;
  // Of the insertion under way:
  std::vector<char> visible_;                                     ///< a flag a facet
  std::vector<std::array<std::int32_t, kMaxDimension>> cone_of_;  ///< per facet and ridge of a seen facet: that over it
  std::vector<std::int32_t> removed_, added_;
  std::vector<Ridge> horizon_;
  std::vector<Facet> planned_;
  std::vector<double> planned_numbers_;
};

}  // namespace pd::dimension::detail
