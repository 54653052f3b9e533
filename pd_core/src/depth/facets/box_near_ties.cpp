#include "depth/facets/box_near_ties.hpp"

#include <array>
#include <utility>

namespace pd::detail {

namespace {

/// Vertices of a box are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
constexpr int bit(int axis) { return 4 >> axis; }

/// The three edges of A, then those of B, along their axes.
constexpr int kGenerators = 6;

PairVector generator(int g) { return g < 3 ? PairVector::edge_a(0, bit(g)) : PairVector::edge_b(0, bit(g - 3)); }

class BoxFacets {
 public:
  explicit BoxFacets(const PosedPair& pair) : pair_(pair) {}

  /// @param axis    a slot of `box_axis_keys`
  /// @param corner  of the facet, but for signs that doubles took wrong.
  [[nodiscard]] FacetOfDifference facet(int axis, VertexPair corner) {
    const int block = axis / 4, lane = axis % 4;
    const int g = block == 0 ? lane : block == 1 ? 3 + lane : block - 2;
    const int h = block == 0 ? (lane + 1) % 3 : block == 1 ? 3 + (lane + 1) % 3 : 3 + lane;
    // P's centre lies behind the facet: from its corner to the one opposite.
    const Vec3 inwards = pair_.approximate(PairVector::difference(corner.a, corner.b, corner.a ^ 7, corner.b ^ 7));
    const Vec3 n = pair_.approximate(generator(g)).cross(pair_.approximate(generator(h)));
    const int outwards = inwards.dot(n) < 0 ? 1 : -1;
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
      return FacetOfDifference::from_facet_of_a(pair_.a(), f, corner.b);
    }
    if (block == 1) {
      const int f = facet_of_box(pair_.b(), across, (corner.b & bit(across)) != 0);
      return FacetOfDifference::from_facet_of_b(pair_.b(), f, corner.a);
    }
    // (Edge of B) x (edge of A) points outwards.
    const int low_a = corner.a & ~bit(g), high_a = corner.a | bit(g), b = corner.b & ~bit(h - 3);
    return outwards < 0 ? FacetOfDifference::from_edges(low_a, high_a, b, b | bit(h - 3))
                        : FacetOfDifference::from_edges(high_a, low_a, b, b | bit(h - 3));
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

  const PosedPair& pair_;
  std::array<std::optional<int>, 1 << kGenerators> signs_;  ///< by sets of three
};

}  // namespace

std::optional<ProvenFacet> nearest_of_box_facets(const PosedPair& pair, const BoxNearFacets& found,
                                                 SupportFaces& faces) {
  BoxFacets facets(pair);
  std::array<ProvenFacet, BoxNearFacets::kMost> near;
  std::size_t best = 0;
  const auto count = static_cast<std::size_t>(found.count);
  for (std::size_t i = 0; i < count; ++i) {
    near[i].facet = facets.facet(found.axis[i], found.near[i].v[0]);
    near[i].plane = measure_facet(pair, near[i].facet);
    if (!near[i].plane.known() || !(to_double(near[i].plane.distance) > near[i].plane.distance_error)) {
      return std::nullopt;
    }
    if (to_double(near[i].plane.distance - near[best].plane.distance) < 0) best = i;
  }
  const FacetPlane& nearest = near[best].plane;
  for (std::size_t i = 0; i < count; ++i) {
    if (i == best) continue;
    const double error = (near[i].plane.distance_error + nearest.distance_error) * (1 + 0x1p-40);
    if (!(to_double(near[i].plane.distance - nearest.distance) > error)) return std::nullopt;
  }
  return prove_facet(pair, near[best].facet, found.beyond * pair.inwards(), faces);
}

}  // namespace pd::detail
