#include "depth/facets/box_sat.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "depth/facets/box_sat_kernels.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// The cross product of two generators turns by at most this over the sine of their angle: each errs by 3u of its
/// length, the product by 4u.
constexpr double kTurn = 12 * kUnitRoundoff;
/// Sines below this are rounding.
constexpr double kParallelSine = 8 * kUnitRoundoff;
/// |column of R| <= 1 + 1e-6 (Pose), and the rounding of the half extents.
constexpr double kLongest = 1 + 0x1p-19;
/// Two faces that overlap share a point after one or two projections each way; faces askew take more.
constexpr int kMaxFootSteps = 12;
constexpr double kLeastProgress = 0.75;
/// Fourth powers of lengths above it, the squares of cross products, are ordinary numbers.
constexpr double kLeastExtent = 0x1p-200;

class BoxPair {
 public:
  BoxPair(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a, const ConvexPolytope& b,
          const BoxFrame& frame_b, const Pose& pose_b)
      : a_(a),
        b_(b),
        rotation_a_(pose_a.rotation()),
        rotation_b_(pose_b.rotation()),
        centre_a_(rotation_a_ * frame_a.centre),
        centre_b_(rotation_b_ * frame_b.centre + (pose_b.translation() - pose_a.translation())),
        centre_(centre_b_ - centre_a_),
        reach_(a.radius() + b.radius() + (pose_b.translation() - pose_a.translation()).norm()) {
    spread(rotation_a_, frame_a.half_extents, of_a_);
    spread(rotation_b_, frame_b.half_extents, of_b_);
  }

  BoxPairDepth solve(const BracketWidth& width) {
    BoxPairDepth out;
    // Generators and centre err by 12u of the reach together, the sum of seven products by 8u.
    const double rounding = 20 * kUnitRoundoff * reach_;
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    const NearestBoxAxis nearest = nearest_box_axis({of_a_, of_a_}, {of_b_, of_b_}, c, {kTurn * reach_, kParallelSine});
    Vec3 u, v;
    spanning(of_a_, of_b_, nearest.axis, u, v);
    out.normal = outward(u.cross(v));
    const double distance = signed_root(nearest.key);
    out.upper = distance + rounding;
    if (nearest.key < 0) {
      if (out.upper < 0) out.status = BoxPairStatus::separated;
      return out;
    }
    if (!(nearest.lower_key > 0)) return out;
    out.lower = std::sqrt(nearest.lower_key) - rounding - (kParallelSine + 2 * kTurn) * nearest.slivers;
    if (!(out.lower > 0) || out.upper - out.lower > width.limit(greatest_coordinate())) return out;
    if (place_witness(nearest.axis, distance, out)) out.status = BoxPairStatus::certified;
    return out;
  }

  BoxNearFacets near_facets() const {
    BoxNearFacets out;
    const double rounding = 20 * kUnitRoundoff * reach_;  // as in `solve`
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    BoxAxisKeys keys;
    box_axis_keys({of_a_, of_a_}, {of_b_, of_b_}, c, {kTurn * reach_, kParallelSine}, keys);
    int nearest = 0;
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      if (axis % 4 < 3 && keys.key[axis] < keys.key[nearest]) nearest = axis;
    }
    if (!(keys.key[nearest] > 0)) return out;
    const double upper = std::sqrt(keys.key[nearest]) + rounding;
    const double farther = (upper + rounding) * (1 + 0x1p-50);
    out.beyond = std::numeric_limits<double>::infinity();
    add_near(nearest, keys, upper, out);
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      if (axis % 4 == 3 || axis == nearest) continue;
      const bool left_out = !(keys.lower_key[axis] < std::numeric_limits<double>::infinity());
      if (left_out && axis >= 8) {
        out.parallel |= 1U << (3 * (axis / 4 - 2) + axis % 4);
      } else if (!left_out && keys.lower_key[axis] > farther * farther) {
        out.beyond = std::min(out.beyond, upper);
      } else if (left_out || !add_near(axis, keys, upper, out)) {
        out.count = 0;
        return out;
      }
    }
    return out;
  }

  BoxPairContact contact(const BracketWidth& width) {
    BoxPairContact out;
    BoxGenerators along_a = of_a_, along_b = of_b_;
    BoxAxesErrors errors{kTurn * reach_, kParallelSine};
    if (is_single(rotation_a_) && is_single(rotation_b_)) {
      spread(rotation_a_, Vec3::Ones(), along_a);
      spread(rotation_b_, Vec3::Ones(), along_b);
      errors = {0, 0};
    }
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    const NearestBoxAxis nearest = nearest_box_axis({of_a_, along_a}, {of_b_, along_b}, c, errors);
    Vec3 u, v;
    spanning(along_a, along_b, nearest.axis, u, v);
    out.normal = outward(u.cross(v));
    // As in `solve`; the normal errs by 3u more.
    const double rounding = 28 * kUnitRoundoff * reach_;
    const double height = signed_root(nearest.key);
    const double slivers = errors.turn > 0 ? (kParallelSine + 2 * kTurn) * nearest.slivers : 0;
    const double depth = nearest.lower_key > 0 ? std::sqrt(nearest.lower_key) - rounding - slivers : 0;
    const double limit = width.limit(greatest_coordinate());
    out.lower = -height - rounding;
    if (depth > 0 && height + rounding - depth > limit) return out;
    const double missed = place_contact(nearest.axis, height * out.normal, 0.125 * limit, out);
    const double slack = 64 * kUnitRoundoff * reach_;
    if (depth > 0) {
      out.upper = -depth;
      out.certified = missed <= std::max(limit, slack);
    } else {
      out.upper = std::abs(height) + missed + slack;
      out.certified = out.upper - out.lower <= limit;
    }
    return out;
  }

 private:
  /// Whether all numbers have the 24 digits of single precision: products of two of them are exact. By their bits,
  /// since GCC 12 takes roundings to float and back, side by side in one vector, for none at all.
  static bool is_single(const Mat3& rotation) {
    constexpr std::uint64_t kBeyond = (std::uint64_t{1} << (53 - 24)) - 1;
    std::uint64_t bits = 0;
    for (int i = 0; i < 9; ++i) bits |= std::bit_cast<std::uint64_t>(rotation.data()[i]);
    return (bits & kBeyond) == 0;
  }

  /// The points of a box farthest along a direction, up to a level: a centre and the generators that may be added with
  /// any weight from -1 to 1.
  struct Face {
    Vec3 centre;
    Vec3 edges[3];
    int count = 0;

    [[nodiscard]] Vec3 nearest(const Vec3& point) const {
      Vec3 x = centre;
      for (int k = 0; k < count; ++k) {
        x += std::clamp((point - centre).dot(edges[k]) / edges[k].squaredNorm(), -1.0, 1.0) * edges[k];
      }
      return x;
    }
  };
  static Face face(const BoxGenerators& of, const Vec3& centre, const Vec3& along, int spanned, double level) {
    Face out{centre, {}, 0};
    for (int k = 0; k < 3; ++k) {
      const Vec3 g = generator(of, k);
      const double height = g.dot(along);
      if ((spanned & bit(k)) != 0 || std::abs(height) <= level) {
        out.edges[out.count++] = g;
      } else {
        out.centre += height > 0 ? g : Vec3(-g);
      }
    }
    return out;
  }

  /// a in A and b in B whose difference is as near to x, the foot of the origin on the winner's plane, as they are
  /// found to be. @return the distance of b - a from x.
  double place_contact(int axis, const Vec3& x, double level, BoxPairContact& out) const {
    const int block = axis / 4, lane = axis % 4;
    const int across = (lane + 2) % 3;
    const int plane = 7 & ~bit(across);
    level = std::max(level, 16 * kUnitRoundoff * reach_);
    const Face of_a = face(of_a_, centre_a_, -out.normal, block == 0 ? plane : block == 1 ? 0 : bit(block - 2), level);
    const Face of_b = face(of_b_, centre_b_, out.normal, block == 1 ? plane : block == 0 ? 0 : bit(lane), level);
    Vec3 b = of_b.centre;
    if (of_a.count == 1 && of_b.count == 1) b += crossing(of_a, of_b, x) * of_b.edges[0];
    double missed = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMaxFootSteps; ++step) {
      out.point_a = of_a.nearest(b - x);
      b = of_b.nearest(out.point_a + x);
      const double last = std::exchange(missed, (b - out.point_a - x).norm());
      if (missed <= 32 * kUnitRoundoff * reach_ || !(missed < kLeastProgress * last)) break;
    }
    out.point_b = b;
    const int va = farthest(of_a_, out.normal, -1), vb = farthest(of_b_, out.normal, 1);
    out.feature_a = {Feature::Kind::vertex, va, -1};
    out.feature_b = {Feature::Kind::vertex, vb, -1};
    if (block == 0) out.feature_a = {Feature::Kind::facet, facet_of_box(a_, across, (va & bit(across)) != 0), -1};
    if (block == 1) out.feature_b = {Feature::Kind::facet, facet_of_box(b_, across, (vb & bit(across)) != 0), -1};
    if (block >= 2) {
      out.feature_a = {Feature::Kind::edge, va & ~bit(block - 2), va | bit(block - 2)};
      out.feature_b = {Feature::Kind::edge, vb & ~bit(lane), vb | bit(lane)};
    }
    return missed;
  }
  /// Where the edge of B comes nearest to that of A moved by x, from -1 to 1; of parallel ones, anywhere.
  static double crossing(const Face& of_a, const Face& of_b, const Vec3& x) {
    const Vec3& e = of_a.edges[0];
    const Vec3& f = of_b.edges[0];
    const Vec3 n = e.cross(f);
    const double squared = n.squaredNorm();
    if (!(squared > 0)) return 0;
    const double along = (of_b.centre - of_a.centre - x).cross(e).dot(n) / squared;
    return std::clamp(along, -1.0, 1.0);
  }

  static void spread(const Mat3& rotation, const Vec3& half, BoxGenerators& out) {
    for (int k = 0; k < kGeneratorsRead; ++k) {
      const int i = k % 3;
      out.x[k] = rotation(0, i) * half[i];
      out.y[k] = rotation(1, i) * half[i];
      out.z[k] = rotation(2, i) * half[i];
      out.length[k] = kLongest * half[i];
    }
  }
  static Vec3 generator(const BoxGenerators& of, int i) { return {of.x[i], of.y[i], of.z[i]}; }

  static void spanning(const BoxGenerators& a, const BoxGenerators& b, int axis, Vec3& u, Vec3& v) {
    const int block = axis / 4, lane = axis % 4;
    if (block < 2) {
      const BoxGenerators& own = block == 0 ? a : b;
      u = generator(own, lane);
      v = generator(own, lane + 1);
    } else {
      u = generator(a, block - 2);
      v = generator(b, lane);
    }
  }
  /// Adds the two facets of an axis, but those certainly farther than `upper`. False where the origin may lie beyond
  /// one of them, or where there is no room.
  bool add_near(int axis, const BoxAxisKeys& keys, double upper, BoxNearFacets& out) const {
    const double rounding = 20 * kUnitRoundoff * reach_;
    const double lower = signed_root(keys.lower_key[axis]) - rounding;
    if (!(lower > 0) || out.count == BoxNearFacets::kMost) return false;
    Vec3 u, v;
    spanning(of_a_, of_b_, axis, u, v);
    const Vec3 n = outward(u.cross(v));
    out.near[out.count++] = triangle(axis, n);
    // The other side lies farther by twice the height of P's centre.
    const double turned = std::sqrt(keys.key[axis]) + rounding - lower;
    if (lower + 2 * (std::abs(n.dot(centre_)) - turned) > upper) {
      out.beyond = std::min(out.beyond, upper);
      return true;
    }
    if (out.count == BoxNearFacets::kMost) return false;
    out.near[out.count++] = triangle(axis, -n);
    return true;
  }
  /// Three corners of the facet of an axis with the outward normal n.
  SurfaceCorners triangle(int axis, const Vec3& n) const {
    const int block = axis / 4, lane = axis % 4;
    const int va = farthest(of_a_, n, -1), vb = farthest(of_b_, n, 1);
    if (block >= 2) return {{{va, vb}, {va ^ bit(block - 2), vb}, {va, vb ^ bit(lane)}}};
    const int first = bit(lane), second = bit((lane + 1) % 3);
    if (block == 0) return {{{va, vb}, {va ^ first, vb}, {va ^ second, vb}}};
    return {{{va, vb}, {va, vb ^ first}, {va, vb ^ second}}};
  }

  /// Of unit length, away from P's centre as the origin sees it.
  Vec3 outward(const Vec3& n) const { return n * ((n.dot(centre_) > 0 ? -1 : 1) / n.norm()); }
  static double signed_root(double key) { return std::copysign(std::sqrt(std::abs(key)), key); }

  /// L, rounded: |c| + sum |g| a coordinate.
  double greatest_coordinate() const {
    Vec3 extent = centre_.cwiseAbs();
    for (int k = 0; k < 3; ++k) extent += generator(of_a_, k).cwiseAbs() + generator(of_b_, k).cwiseAbs();
    return extent.maxCoeff();
  }

  /// Vertices are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
  static constexpr int bit(int axis) { return 4 >> axis; }

  /// The vertex farthest along `sign` * normal; on equal heights the one with the lower id.
  static int farthest(const BoxGenerators& of, const Vec3& normal, double sign) {
    int id = 0;
    for (int k = 0; k < 3; ++k) id |= sign * generator(of, k).dot(normal) > 0 ? bit(k) : 0;
    return id;
  }
  static Vec3 vertex(const BoxGenerators& of, const Vec3& centre, int id) {
    Vec3 x = centre;
    for (int k = 0; k < 3; ++k) x += (id & bit(k)) != 0 ? generator(of, k) : Vec3(-generator(of, k));
    return x;
  }

  /// Finds a in A and b in B with b - a = distance * normal. False where the winner does not hold that point.
  bool place_witness(int axis, double distance, BoxPairDepth& out) const {
    const Vec3 x = distance * out.normal;
    const double slack = 64 * kUnitRoundoff * reach_;
    const int block = axis / 4, lane = axis % 4;
    const int va = farthest(of_a_, out.normal, -1), vb = farthest(of_b_, out.normal, 1);
    if (block >= 2) {
      const int i = block - 2, j = lane;
      const Vec3 e = generator(of_a_, i), other = generator(of_b_, j);
      // middle of the edge of B + t other - (middle of the edge of A + s e) = x, |s|, |t| <= 1
      const Vec3 middle_a = vertex(of_a_, centre_a_, va | bit(i)) - e;
      const Vec3 gap = vertex(of_b_, centre_b_, vb | bit(j)) - other - middle_a - x;
      const Vec3 n = e.cross(other);
      const double squared = n.squaredNorm();
      const double s = gap.cross(other).dot(n) / squared, t = gap.cross(e).dot(n) / squared;
      if (!(std::abs(s) <= 1 && std::abs(t) <= 1)) return false;
      if (!((gap + t * other - s * e).squaredNorm() <= slack * slack)) return false;
      out.point_a = middle_a + s * e;
      out.feature_a = {Feature::Kind::edge, va & ~bit(i), va | bit(i)};
      out.feature_b = {Feature::Kind::edge, vb & ~bit(j), vb | bit(j)};
      return true;
    }
    // The facet's axis is the one that does not span it; lanes span (0, 1), (1, 2), (2, 0).
    const int across = (lane + 2) % 3;
    if (block == 0) {
      return vertex_on_facet(of_b_, centre_b_, vb, out.normal, [&](const Vec3& b, int v) {
        if (!inside(of_a_, across, b - x - centre_a_, slack)) return false;
        out.point_a = b - x;
        out.feature_a = {Feature::Kind::facet, facet_of_box(a_, across, (va & bit(across)) != 0), -1};
        out.feature_b = {Feature::Kind::vertex, v, -1};
        return true;
      });
    }
    return vertex_on_facet(of_a_, centre_a_, va, out.normal, [&](const Vec3& a, int v) {
      if (!inside(of_b_, across, a + x - centre_b_, slack)) return false;
      out.point_a = a;
      out.feature_a = {Feature::Kind::vertex, v, -1};
      out.feature_b = {Feature::Kind::facet, facet_of_box(b_, across, (vb & bit(across)) != 0), -1};
      return true;
    });
  }

  /// Tries the farthest vertex, and those as far within rounding where facets are parallel.
  template <class Try>
  bool vertex_on_facet(const BoxGenerators& of, const Vec3& centre, int farthest_id, const Vec3& normal,
                       Try&& fits) const {
    if (fits(vertex(of, centre, farthest_id), farthest_id)) return true;
    const double level = 16 * kUnitRoundoff * reach_;
    int loose = 0;
    for (int k = 0; k < 3; ++k) loose |= std::abs(generator(of, k).dot(normal)) <= level ? bit(k) : 0;
    for (int v = 0; v < 8; ++v) {
      if ((v & ~loose) != (farthest_id & ~loose) || v == farthest_id) continue;
      if (fits(vertex(of, centre, v), v)) return true;
    }
    return false;
  }

  /// Whether a point in the plane of a facet across `axis`, relative to the centre, lies on it up to `slack`.
  static bool inside(const BoxGenerators& of, int axis, const Vec3& point, double slack) {
    for (int k = 0; k < 3; ++k) {
      if (k == axis) continue;
      const Vec3 g = generator(of, k);
      const double squared = g.squaredNorm();
      const double along = std::abs(point.dot(g));
      if (along > squared && (along - squared) * (along - squared) > slack * slack * squared) return false;
    }
    return true;
  }

  const ConvexPolytope& a_;
  const ConvexPolytope& b_;
  const Mat3 rotation_a_;
  const Mat3 rotation_b_;
  const Vec3 centre_a_;  ///< relative to A's translation
  const Vec3 centre_b_;  ///< relative to A's translation, too
  const Vec3 centre_;    ///< of P
  const double reach_;
  BoxGenerators of_a_;
  BoxGenerators of_b_;
};

// Eight coordinates are compared two at a time.
typedef double Two __attribute__((vector_size(16)));
typedef std::int64_t TwoFlags __attribute__((vector_size(16)));
Two both(double x) { return Two{x, x}; }
Two two(const double* x, int pair) { return Two{x[2 * pair], x[2 * pair + 1]}; }

}  // namespace

std::optional<BoxFrame> box_frame(const ConvexPolytope& p) {
  if (p.num_vertices() != 8) return std::nullopt;
  // Vertices are in lexicographic order: z changes fastest.
  const Two x0 = both(p.x()[0]), x1 = both(p.x()[7]), y0 = both(p.y()[0]), y1 = both(p.y()[7]);
  const Two z = {p.z()[0], p.z()[7]};
  const TwoFlags as_box = (two(p.x(), 0) == x0) & (two(p.x(), 1) == x0) & (two(p.x(), 2) == x1) &
                          (two(p.x(), 3) == x1) & (two(p.y(), 0) == y0) & (two(p.y(), 1) == y1) &
                          (two(p.y(), 2) == y0) & (two(p.y(), 3) == y1) & (two(p.z(), 0) == z) & (two(p.z(), 1) == z) &
                          (two(p.z(), 2) == z) & (two(p.z(), 3) == z);
  const bool box = (as_box[0] & as_box[1]) != 0;
  if (!box) return std::nullopt;
  const Vec3 least = p.vertex(0), most = p.vertex(7);
  if (!((most - least).minCoeff() > kLeastExtent)) return std::nullopt;
  return BoxFrame{0.5 * (least + most), 0.5 * (most - least)};
}

int facet_of_box(const ConvexPolytope& p, int axis, bool positive) {
  int f = 0;
  while ((positive ? 1 : -1) * p.facet_normal(f)[axis] < 0.5) ++f;
  return f;
}

BoxPairDepth box_pair_depth(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                            const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                            const BracketWidth& width) {
  return BoxPair(a, frame_a, pose_a, b, frame_b, pose_b).solve(width);
}

BoxNearFacets box_near_facets(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                              const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b) {
  return BoxPair(a, frame_a, pose_a, b, frame_b, pose_b).near_facets();
}

BoxPairContact box_pair_contact(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                                const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                                const BracketWidth& width) {
  return BoxPair(a, frame_a, pose_a, b, frame_b, pose_b).contact(width);
}

}  // namespace pd::detail
