#include "pd/depth/linear_separation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "depth/difference/direction_signs.hpp"
#include "depth/difference/exact_support.hpp"
#include "depth/distance/gjk_exact.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd {

namespace {

using detail::DirectionSigns;
using detail::Dyadic3;
using detail::PairVector;
using detail::PosedPair;

/// A vertex of A or of B.
struct Site {
  std::int32_t vertex;
  bool of_b;
};

/// q - p as a vector of the pair, up to the sign.
struct Step {
  PairVector vector;
  int sign;
};

Step step(const Site& p, const Site& q) {
  if (p.of_b == q.of_b) {
    return {p.of_b ? PairVector::edge_b(p.vertex, q.vertex) : PairVector::edge_a(p.vertex, q.vertex), 1};
  }
  if (q.of_b) return {PairVector::point(p.vertex, q.vertex), 1};
  return {PairVector::point(q.vertex, p.vertex), -1};
}

bool is_zero(const Dyadic3& v) { return v.x.sign() == 0 && v.y.sign() == 0 && v.z.sign() == 0; }

/// The flats (planes, lines, points) through `dimension` sites that may separate A's sites from B's, in a space of that
/// dimension: R^3, a plane seen along a coordinate axis, or a line seen across one.
class FlatSearch {
 public:
  static constexpr int kMostSites = 3;
  struct Flat {
    std::array<Site, kMostSites> sites{};
    int orientation = 1;
  };

  /// @param axis  in a plane one that is not parallel to it; in a line one that is not orthogonal to it.
  FlatSearch(const PosedPair& pair, int dimension, int axis, std::span<const Site> sites)
      : pair_(pair), dimension_(dimension), along_(pair, Vec3::Unit(axis)), sites_(sites) {}

  /// A flat with no site of B behind it and none of A before it, or nothing. Requires that the sites span the space or
  /// a flat of it.
  std::optional<Flat> solve() {
    Flat flat;
    bool off_flat = false;
    if (!solve(0, sites_.size(), flat, off_flat)) return std::nullopt;
    return flat;
  }

  /// Side of an oriented flat on which a site lies.
  int side(const Flat& flat, const Site& site) {
    ++tests_;
    const auto& s = flat.sites;
    const Step last = step(s[0], site);
    int sign = last.sign * flat.orientation;
    if (dimension_ == 1) return sign * along_.along(last.vector);
    const Step first = step(s[0], s[1]);
    sign *= first.sign;
    if (dimension_ == 2) return sign * along_.turn(first.vector, last.vector);
    const Step second = step(s[0], s[2]);
    return sign * second.sign * pair_.sign_determinant(first.vector, second.vector, last.vector);
  }

  [[nodiscard]] std::int64_t tests() const { return tests_; }

 private:
  /// The same with the first `tight` sites of the flat fixed, for the first `count` sites. `off_flat`: some of them
  /// lies strictly on its own side.
  bool solve(int tight, std::size_t count, Flat& flat, bool& off_flat) {
    flat.orientation = 1;
    off_flat = false;
    if (tight >= std::min(dimension_, kMostSites)) {
      int found = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const int value = own_side(flat, sites_[i]);
        if (value != 0 && value == -found) return false;
        if (value != 0) found = value;
      }
      if (found < 0) flat.orientation = -1;
      off_flat = found != 0;
      return true;
    }
    complete(flat, tight);
    for (std::size_t i = 0; i < count; ++i) {
      const int value = own_side(flat, sites_[i]);
      off_flat = off_flat || value > 0;
      if (value >= 0) continue;
      if (!off_flat) {
        // All earlier sites lie in the flat: turned round it serves them as well.
        flat.orientation = -flat.orientation;
        off_flat = true;
        continue;
      }
      // Between this flat and any that serves site i, too, there is one through site i: solutions form a convex cone.
      Flat through = flat;
      through.sites[static_cast<std::size_t>(tight)] = sites_[i];
      if (!solve(tight + 1, i, through, off_flat)) return false;
      flat = through;
    }
    return true;
  }

  /// Positive where the site lies on the side of its body.
  int own_side(const Flat& flat, const Site& site) { return site.of_b ? side(flat, site) : -side(flat, site); }

  /// Adds sites in general position to the first `tight` ones. (Fewer exist only when all sites lie in one flat, and
  /// then any flat serves: the sides are all 0.)
  void complete(Flat& flat, int tight) const {
    for (const Site& site : sites_) {
      if (tight == dimension_) return;
      if (independent(flat, tight, site)) flat.sites[static_cast<std::size_t>(tight++)] = site;
    }
    for (; tight < dimension_; ++tight) flat.sites[static_cast<std::size_t>(tight)] = flat.sites[0];
  }

  bool independent(const Flat& flat, int count, const Site& site) const {
    if (count == 0) return true;
    const Step last = step(flat.sites[0], site);
    if (count == 1) {
      if (flat.sites[0].of_b == site.of_b) return flat.sites[0].vertex != site.vertex;
      return pair_.approximate(last.vector).cwiseAbs().maxCoeff() > pair_.vector_error() ||
             !is_zero(pair_.exact(last.vector));
    }
    return !pair_.parallel(step(flat.sites[0], flat.sites[1]).vector, last.vector);
  }

  const PosedPair& pair_;
  int dimension_;
  DirectionSigns along_;
  std::span<const Site> sites_;
  std::int64_t tests_ = 0;
};

/// Vertices of both bodies in a fixed pseudo-random order (SplitMix64).
std::vector<Site> shuffled_sites(const ConvexPolytope& a, const ConvexPolytope& b) {
  std::vector<Site> sites;
  sites.reserve(static_cast<std::size_t>(a.num_vertices()) + static_cast<std::size_t>(b.num_vertices()));
  for (int v = 0; v < a.num_vertices(); ++v) sites.push_back({v, false});
  for (int v = 0; v < b.num_vertices(); ++v) sites.push_back({v, true});
  std::uint64_t state = 0;
  for (std::size_t i = sites.size() - 1; i > 0; --i) {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    std::swap(sites[i], sites[(z ^ (z >> 31)) % (i + 1)]);
  }
  return sites;
}

/// Whether max <n, a> < min <n, b>, exactly.
bool strictly_separates(const PosedPair& pair, const Vec3& n) {
  const DirectionSigns signs(pair, -n);
  const auto along = [&](const PairVector& edge) { return signs.along(edge); };
  const detail::VertexPair nearest = support_exactly(pair, {signs.scaled(), 0}, {-1, -1}, along);
  return signs.along(PairVector::point(nearest.a, nearest.b)) < 0;
}

/// A unit direction that separates strictly: the plane's own normal, else that of the nearest points (which leaves the
/// widest gap), else one within two ulps a coordinate of it.
void choose_direction(const PosedPair& pair, const std::optional<Vec3>& normal, LinearSeparation& out) {
  if (normal) {
    out.direction = *normal;
    out.strict = strictly_separates(pair, *normal);
    if (out.strict) return;
  }
  const detail::VertexPair start{0, 0};
  const detail::ExactClosestPoint nearest = exact_closest_point(pair, &start, 1);
  const Vec3 unit = detail::ExactDirection(nearest.point).unit;
  out.direction = unit;
  out.strict = strictly_separates(pair, unit);
  constexpr std::array<int, 5> kUlps{0, 1, -1, 2, -2};
  for (const int i : kUlps) {
    for (const int j : kUlps) {
      for (const int k : kUlps) {
        if (out.strict) return;
        const auto moved = [](double x, int ulps) { return x + ulps * (std::nextafter(x, HUGE_VAL) - x); };
        const Vec3 candidate(moved(unit.x(), i), moved(unit.y(), j), moved(unit.z(), k));
        if (!strictly_separates(pair, candidate)) continue;
        out.direction = candidate;
        out.strict = true;
      }
    }
  }
}

/// The coordinate axis for the next search, from large to small: the first for which `sign` is not 0.
template <class Sign>
int choose_axis(const Vec3& size, Sign&& sign) {
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return std::abs(size[i]) > std::abs(size[j]); });
  for (const int axis : order) {
    if (sign(axis) != 0) return axis;
  }
  return order[0];
}

}  // namespace

LinearSeparation linear_separation(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                   const Pose& pose_b) {
  const detail::FloatingPointGuard guard;
  const PosedPair pair(a, pose_a, b, pose_b);
  LinearSeparation out;
  std::vector<Site> sites = shuffled_sites(a, b);
  std::optional<Vec3> normal;
  int axis = 0;
  for (int dimension = 3; dimension >= 1; --dimension) {
    FlatSearch search(pair, dimension, axis, sites);
    const std::optional<FlatSearch::Flat> flat = search.solve();
    if (!flat) {
      out.sign_tests += search.tests();
      out.contact = dimension == 3 ? ContactClass::overlapping : ContactClass::touching;
      break;
    }
    // What does not lie in the flat lies on its own side and is out of the question.
    std::erase_if(sites, [&](const Site& site) { return search.side(*flat, site) != 0; });
    out.sign_tests += search.tests();
    const Step first = step(flat->sites[0], flat->sites[1]);
    const Step second = step(flat->sites[0], flat->sites[2]);
    if (dimension == 3) {
      const Dyadic3 exact = cross(pair.exact(first.vector), pair.exact(second.vector));
      if (!is_zero(exact)) {
        normal = first.sign * second.sign * flat->orientation * detail::ExactDirection(exact).unit;
      }
    }
    const auto of_b = [](const Site& site) { return site.of_b; };
    if (std::all_of(sites.begin(), sites.end(), of_b) || std::none_of(sites.begin(), sites.end(), of_b)) {
      out.contact = ContactClass::separated;
      choose_direction(pair, dimension == 3 ? normal : std::nullopt, out);
      return out;
    }
    out.contact = ContactClass::touching;
    if (dimension == 3) {
      const Vec3 across = pair.approximate(first.vector).cross(pair.approximate(second.vector));
      axis = choose_axis(across,
                         [&](int i) { return DirectionSigns(pair, Vec3::Unit(i)).turn(first.vector, second.vector); });
    } else if (dimension == 2) {
      axis = choose_axis(pair.approximate(first.vector),
                         [&](int i) { return DirectionSigns(pair, Vec3::Unit(i)).along(first.vector); });
    }
  }
  if (out.contact == ContactClass::touching && normal) out.direction = *normal;
  return out;
}

}  // namespace pd
