#include "depth/facets/box_near_ties.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

/// Vertices of a box are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
constexpr int bit(int axis) { return 4 >> axis; }

/// The three edges of A, then those of B, along their axes.
constexpr int kGenerators = 6;

PairVector generator(int g) { return g < 3 ? PairVector::edge_a(0, bit(g)) : PairVector::edge_b(0, bit(g - 3)); }

/// A facet of P: a parallelogram at a corner, the other generators on the side that exact signs tell.
struct BoxFacet {
  int g = 0;  ///< what spans it
  int h = 0;
  VertexPair corner{};
  FacetOfDifference facet;
};

class BoxFacets {
 public:
  explicit BoxFacets(const PosedPair& pair) : pair_(pair) {}

  /// The two generators of a slot of `box_axis_keys`.
  static std::pair<int, int> spanning(int axis) {
    const int block = axis / 4, lane = axis % 4, next = (lane + 1) % 3;
    return block == 0   ? std::pair(lane, next)
           : block == 1 ? std::pair(3 + lane, 3 + next)
                        : std::pair(block - 2, 3 + lane);
  }

  /// @param axis    a slot of `box_axis_keys`
  /// @param corner  of the facet, but for signs that doubles took wrong.
  [[nodiscard]] BoxFacet facet(int axis, VertexPair corner) {
    const int block = axis / 4, lane = axis % 4;
    const auto [g, h] = spanning(axis);
    const int outwards = outward_normal(g, h, corner).dot(product(g, h)) > 0 ? 1 : -1;
    for (int k = 0; k < kGenerators; ++k) {
      if (k == g || k == h) continue;
      const int rises = outwards * determinant(k, g, h);
      if (k < 3) {
        set(corner.a, k, -rises);
      } else {
        set(corner.b, k - 3, rises);
      }
    }
    const int across = (lane + 2) % 3;
    if (block == 0) {
      const int f = facet_of_box(pair_.a(), across, (corner.a & bit(across)) != 0);
      return {g, h, corner, FacetOfDifference::from_facet_of_a(pair_.a(), f, corner.b)};
    }
    if (block == 1) {
      const int f = facet_of_box(pair_.b(), across, (corner.b & bit(across)) != 0);
      return {g, h, corner, FacetOfDifference::from_facet_of_b(pair_.b(), f, corner.a)};
    }
    // (Edge of B) x (edge of A) points outwards.
    const int low_a = corner.a & ~bit(g), high_a = corner.a | bit(g), b = corner.b & ~bit(h - 3);
    return {g, h, corner,
            outwards < 0 ? FacetOfDifference::from_edges(low_a, high_a, b, b | bit(h - 3))
                         : FacetOfDifference::from_edges(high_a, low_a, b, b | bit(h - 3))};
  }

  /// How far inside of the facet the point below the origin lies, in its plane: at least. Not above 0: outside, or
  /// doubles do not tell.
  [[nodiscard]] double foot_inside(const BoxFacet& f) const {
    const Vec3 along_g = from_corner(f.corner, f.g), along_h = from_corner(f.corner, f.h);
    const Vec3 n = along_g.cross(along_h);
    const double area = n.norm(), of_g = along_g.norm(), of_h = along_h.norm();
    const Vec3 to_origin = -pair_.approximate(PairVector::point(f.corner.a, f.corner.b));
    const double s = to_origin.cross(along_h).dot(n) / (area * area);
    const double t = along_g.cross(to_origin).dot(n) / (area * area);
    const double inside = std::min(std::min(s, 1 - s) * area / of_h, std::min(t, 1 - t) * area / of_g);
    // Vectors err by `vector_error` in each coordinate, products of two of them by it times their lengths, and where
    // sides are long or nearly parallel that counts for more by what they are over the parallelogram's least width.
    const double sharpness = 1 + std::max({to_origin.norm(), of_g, of_h}) * std::max(of_g, of_h) / area;
    return inside - 64 * pair_.vector_error() * sharpness * sharpness;
  }
  /// Unit, up to rounding.
  [[nodiscard]] Vec3 outward_normal(int g, int h, const VertexPair& corner) const {
    const Vec3 n = product(g, h);
    // P's centre lies behind the facet: from its corner to the one opposite.
    const Vec3 inwards = pair_.approximate(PairVector::difference(corner.a, corner.b, corner.a ^ 7, corner.b ^ 7));
    return n * ((inwards.dot(n) < 0 ? 1 : -1) / n.norm());
  }
  /// At least the angle between a unit normal and that of the facets of two generators; 1 or more where that is large.
  [[nodiscard]] double turn_between(const Vec3& normal, int g, int h, const VertexPair& corner) const {
    const Vec3 other = outward_normal(g, h, corner);
    if (!(other.dot(normal) > 0)) return 1;
    const double sides = pair_.approximate(generator(g)).norm() + pair_.approximate(generator(h)).norm();
    const double error = 64 * pair_.vector_error() * sides / product(g, h).norm() + 0x1p-50;
    return (other.cross(normal).norm() + error) * (1 + 0x1p-10);
  }

 private:
  /// As it is where the generator lies in the plane.
  static void set(int& vertex, int k, int sign) {
    if (sign != 0) vertex = sign > 0 ? vertex | bit(k) : vertex & ~bit(k);
  }

  /// The sign of det(i, j, k) of generators, each three of them asked once.
  int determinant(int i, int j, int k) {
    int sign = 1;
    const auto order = [&](int& x, int& y) {
      if (x > y) {
        std::swap(x, y);
        sign = -sign;
      }
    };
    order(i, j);
    order(j, k);
    order(i, j);
    std::optional<int>& known = signs_[static_cast<std::size_t>(1 << i | 1 << j | 1 << k)];
    if (!known) known = pair_.sign_determinant(generator(i), generator(j), generator(k));
    return sign * *known;
  }

  [[nodiscard]] Vec3 product(int g, int h) const {
    return pair_.approximate(generator(g)).cross(pair_.approximate(generator(h)));
  }
  /// The edge of P along a generator that leaves a corner.
  [[nodiscard]] Vec3 from_corner(const VertexPair& corner, int g) const {
    return pair_.approximate(PairVector::difference(corner.a, corner.b, g < 3 ? corner.a ^ bit(g) : corner.a,
                                                    g < 3 ? corner.b : corner.b ^ bit(g - 3)));
  }

  const PosedPair& pair_;
  std::array<std::optional<int>, 1 << kGenerators> signs_;  ///< by sets of three
};

}  // namespace

std::optional<ProvenFacet> nearest_of_box_facets(const PosedPair& pair, const BoxNearFacets& found,
                                                 SupportFaces& faces) {
  BoxFacets facets(pair);
  const auto count = static_cast<std::size_t>(found.count);
  BoxFacet nearest;
  std::size_t holder = count;
  double inside = 0;
  for (std::size_t i = 0; i < count && holder == count; ++i) {
    nearest = facets.facet(found.axis[i], found.near[i].v[0]);
    inside = facets.foot_inside(nearest);
    if (inside > 0) holder = i;
  }
  if (holder == count) return std::nullopt;
  const FacetPlane plane = measure_facet(pair, nearest.facet);
  if (!plane.known() || !(to_double(plane.distance) > plane.distance_error)) return std::nullopt;
  // tan(t / 2) < t up to an angle of 2.
  const double flush = std::min(0x1p-20, inside / to_double(plane.distance));
  for (std::size_t i = 0; i < count; ++i) {
    const auto [g, h] = BoxFacets::spanning(found.axis[i]);
    const VertexPair& corner = found.near[i].v[0];
    if (i == holder || facets.turn_between(high(plane.unit), g, h, corner) < flush) continue;
    const FacetPlane other = measure_facet(pair, facets.facet(found.axis[i], corner).facet);
    const double error = (other.distance_error + plane.distance_error) * (1 + 0x1p-40);
    if (!other.known() || !(to_double(other.distance - plane.distance) > error)) return std::nullopt;
  }
  return prove_facet(pair, nearest.facet, found.beyond * pair.inwards(), faces);
}

}  // namespace pd::detail
