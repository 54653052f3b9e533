/// @file
/// The two surfaces that hierarchies are made of: the vertices of a polytope, and the vertices of its polar body, which
/// are its facets.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "numeric/dyadic.hpp"
#include "pd/numeric/predicates.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

using Triangle = std::array<std::int32_t, 3>;

/// The vertices of a polytope.
class VertexSpace {
 public:
  explicit VertexSpace(const ConvexPolytope& polytope) : polytope_(polytope) {}
  [[nodiscard]] int size() const { return polytope_.num_vertices(); }
  /// Side of the plane through i, j, k on which l lies; positive: outside.
  [[nodiscard]] int side(int i, int j, int k, int l) const {
    return orient3d(polytope_.vertex(i), polytope_.vertex(j), polytope_.vertex(k), polytope_.vertex(l));
  }
  /// A hull of fewer points is bounded always.
  [[nodiscard]] static bool faces_centre(int, int, int) { return true; }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> triangles;
    for (int f = 0; f < polytope_.num_facets(); ++f) {
      const auto loop = polytope_.facet_vertices(f);
      for (std::size_t i = 2; i < loop.size(); ++i) triangles.push_back({loop[0], loop[i - 1], loop[i]});
    }
    return triangles;
  }

 private:
  const ConvexPolytope& polytope_;
};

/// The vertices of the polar body about an inner point o: facet f of the polytope as n / <n, c - o> with its normal n
/// and a corner c. Rows (n, <n, c - o>) are that point in homogeneous coordinates.
class FacetSpace {
 public:
  explicit FacetSpace(const ConvexPolytope& polytope) : polytope_(polytope) {
    const auto loop = polytope.facet_vertices(0);
    int apex = 0;
    while (orient3d(polytope.vertex(loop[0]), polytope.vertex(loop[1]), polytope.vertex(loop[2]),
                    polytope.vertex(apex)) == 0) {
      ++apex;
    }
    // o is the mean of four vertices of a tetrahedron; exactly, its fourfold.
    fourfold_ = to_dyadic(polytope.vertex(apex));
    inner_ = polytope.vertex(apex) / 4;
    for (std::size_t i = 0; i < 3; ++i) {
      fourfold_ = fourfold_ + to_dyadic(polytope.vertex(loop[i]));
      inner_ += polytope.vertex(loop[i]) / 4;
    }
    scale_ = std::ldexp(1.0, -std::ilogb(polytope.max_abs_coordinate()));
  }

  [[nodiscard]] int size() const { return polytope_.num_facets(); }

  [[nodiscard]] int side(int i, int j, int k, int l) const {
    const Row a = rounded(i), b = rounded(j), c = rounded(k), d = rounded(l);
    const double value = minors(a, b, c, d);
    // Entries are at most 8 and err by less than 2^-47: 24 products of four.
    if (std::abs(value) > kFilter) return value < 0 ? 1 : -1;
    const ExactRow p = exact(i), q = exact(j), r = exact(k), s = exact(l);
    return -minors(p, q, r, s).sign();
  }

  /// Whether the polar facet through three of its vertices has the centre strictly behind it: only then do the planes
  /// bound the body there.
  [[nodiscard]] bool faces_centre(int i, int j, int k) const {
    return determinant(exact(i).normal, exact(j).normal, exact(k).normal).sign() > 0;
  }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> triangles;
    for (int v = 0; v < polytope_.num_vertices(); ++v) {
      const int first = polytope_.first_half_edge(v);
      const int degree = static_cast<int>(polytope_.neighbours(v).size());
      const auto facet = [&](int k) { return polytope_.half_edge(first + k).facet; };
      for (int k = 2; k < degree; ++k) triangles.push_back({facet(0), facet(k - 1), facet(k)});
    }
    return triangles;
  }

 private:
  struct Row {
    Vec3 normal;
    double offset;
  };
  struct ExactRow {
    Dyadic3 normal;
    Dyadic offset;
  };
  static constexpr double kFilter = 1e-8;

  [[nodiscard]] Row rounded(int f) const {
    const Vec3& n = polytope_.facet_normal(f);
    return {n, n.dot(scale_ * (polytope_.vertex(polytope_.facet_vertices(f)[0]) - inner_))};
  }
  [[nodiscard]] ExactRow exact(int f) const {
    const auto loop = polytope_.facet_vertices(f);
    const Dyadic3 c = to_dyadic(polytope_.vertex(loop[0]));
    const Dyadic3 n = cross(to_dyadic(polytope_.vertex(loop[1])) - c, to_dyadic(polytope_.vertex(loop[2])) - c);
    const Dyadic offset = dot(n, c).scaled(2) - dot(n, fourfold_);
    return {{n.x.scaled(2), n.y.scaled(2), n.z.scaled(2)}, offset};
  }

  /// The 4 x 4 determinant of four rows, by its last column.
  template <class AnyRow>
  static decltype(AnyRow::offset) minors(const AnyRow& a, const AnyRow& b, const AnyRow& c, const AnyRow& d) {
    return d.offset * triple(a, b, c) - c.offset * triple(a, b, d) + b.offset * triple(a, c, d) -
           a.offset * triple(b, c, d);
  }
  static double triple(const Row& a, const Row& b, const Row& c) { return a.normal.dot(b.normal.cross(c.normal)); }
  static Dyadic triple(const ExactRow& a, const ExactRow& b, const ExactRow& c) {
    return determinant(a.normal, b.normal, c.normal);
  }

  const ConvexPolytope& polytope_;
  Dyadic3 fourfold_;
  Vec3 inner_;
  double scale_ = 1;
};

}  // namespace pd::detail
