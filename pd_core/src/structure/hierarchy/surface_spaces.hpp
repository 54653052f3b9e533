/// @file
/// The two surfaces that hierarchies are made of: the vertices of a polytope, and the vertices of its polar body, which
/// are its facets.
#pragma once

#include <algorithm>
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
    const std::array<Row, 4> rows{rounded(i), rounded(j), rounded(k), rounded(l)};
    for (std::size_t base = 4; base-- > 0;) {
      const int sign = certain_sign(rows, base);
      if (sign != 0) return -sign;
    }
    const ExactRow p = exact(i), q = exact(j), r = exact(k), s = exact(l);
    return -minors(p, q, r, s).sign();
  }

  /// Whether the polar facet through three of its vertices has the centre strictly behind it: only then do the planes
  /// bound the body there.
  [[nodiscard]] bool faces_centre(int i, int j, int k) const {
    const Vec3 &a = polytope_.facet_normal(i), &b = polytope_.facet_normal(j), &c = polytope_.facet_normal(k);
    const Vec3 ac = a - c, bc = b - c;
    const double value = ac.dot(bc.cross(c));
    // 6 products of two differences, which err by 2^-45, and a number of at most 1.
    const double air = 0x1p-41 * (ac.lpNorm<Eigen::Infinity>() + bc.lpNorm<Eigen::Infinity>() + 0x1p-44);
    if (std::abs(value) > air) return value > 0;
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

  /// The sign of the determinant of four rounded rows, 0 where it is not certain.
  ///
  /// Neighbouring facets of a large body have nearly equal rows, and their determinant is as small as a product of
  /// three differences: these are taken first, from row `base`, so that the bound of the error is as small as two of
  /// them. Entries are at most 8 and err by less than 2^-47, differences by less than 2^-45; each of 24 products of
  /// three differences and an entry errs by at most 2.5 * 2^-42 times the two largest differences' product.
  static int certain_sign(const std::array<Row, 4>& rows, std::size_t base) {
    std::array<Row, 4> from_base = rows;
    std::array<double, 3> size{};
    for (std::size_t i = 0, next = 0; i < 4; ++i) {
      if (i == base) continue;
      Row& row = from_base[i];
      row = {row.normal - rows[base].normal, row.offset - rows[base].offset};
      size[next++] = std::max(row.normal.lpNorm<Eigen::Infinity>(), std::abs(row.offset)) + 0x1p-45;
    }
    const double value = minors(from_base[0], from_base[1], from_base[2], from_base[3]);
    const double air = 0x1p-36 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    return value > air ? 1 : (value < -air ? -1 : 0);
  }

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
