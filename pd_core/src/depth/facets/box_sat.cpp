#include "depth/facets/box_sat.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "depth/facets/box_sat_kernels.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// Fourth powers of lengths above it, the squares of cross products, are ordinary numbers.
constexpr double kLeastExtent = 0x1p-200;

class BoxSat : public BoxPair {
 public:
  BoxSat(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a, const ConvexPolytope& b,
         const BoxFrame& frame_b, const Pose& pose_b)
      : BoxPair(frame_a, pose_a, a.radius(), frame_b, pose_b, b.radius()), a_(a), b_(b) {}

  BoxPairDepth solve(const BracketWidth& width) {
    BoxPairDepth out;
    if (apart_along_centres()) {
      out.status = BoxPairStatus::separated;
      out.normal = -centre_.normalized();
      return out;
    }
    // Generators and centre err by 12u of the reach together, the sum of seven products by 8u.
    const double rounding = 20 * kUnitRoundoff * reach_;
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    const NearestBoxAxis nearest =
        nearest_box_axis({of_a_, of_a_}, {of_b_, of_b_}, c, {kBoxTurn * reach_, kBoxParallelSine});
    Vec3 u, v;
    spanning(of_a_, of_b_, nearest.axis, u, v);
    out.normal = outward(u.cross(v));
    const double distance = signed_root(nearest.key);
    out.upper = distance + rounding;
    if (nearest.key < 0) {
      if (out.upper < 0) out.status = BoxPairStatus::separated;
      out.nearest = triangle(nearest.axis, out.normal);
      return out;
    }
    if (!(nearest.lower_key > 0)) return out;
    const double slivers = (kBoxParallelSine + 2 * kBoxTurn) * nearest.slivers;
    out.lower = std::sqrt(nearest.lower_key) - rounding - slivers;
    const double limit = width.limit(greatest_coordinate());
    const auto narrow = [&] { return out.lower > 0 && out.upper - out.lower <= limit; };
    if (narrow()) {
      if (!place_witness(nearest.axis, distance, out) && !place_on_faces(nearest.axis, distance, out)) return out;
    } else {
      const std::optional<double> missed = place_on_faces(nearest.axis, distance, out);
      if (!missed) return out;
      // Two points by six steps each err by 6u of the reach more than generators and centre do, what they miss by 3u,
      // and the foot's length by 4u.
      const double foot_rounding = 28 * kUnitRoundoff * reach_;
      out.lower = lower_beside_foot(distance - *missed - foot_rounding, out.normal, rounding) - slivers;
      if (!narrow()) return out;
    }
    out.status = BoxPairStatus::certified;
    return out;
  }

  BoxNearFacets near_facets(SupportFaces& faces) const {
    BoxNearFacets out;
    const double rounding = 20 * kUnitRoundoff * reach_;  // as in `solve`
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    BoxAxisKeys keys;
    box_axis_keys({of_a_, of_a_}, {of_b_, of_b_}, c, {kBoxTurn * reach_, kBoxParallelSine}, keys);
    int nearest = 0;
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      if (axis % 4 < 3 && keys.key[axis] < keys.key[nearest]) nearest = axis;
    }
    if (!(keys.key[nearest] > 0)) return out;
    const double upper = std::sqrt(keys.key[nearest]) + rounding;
    const double farther = (upper + rounding) * (1 + 0x1p-50);
    const double far_key = farther * farther;
    out.beyond = std::numeric_limits<double>::infinity();
    add_near(nearest, keys, upper, out);
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      if (axis % 4 == 3 || axis == nearest) continue;
      const double key = keys.lower_key[axis];
      const bool left_out = !(key < std::numeric_limits<double>::infinity());
      if (key > far_key && !left_out) {
        out.beyond = upper;
      } else if (left_out && axis >= 8) {
        const int i = axis / 4 - 2, j = axis % 4;
        if (!slivers_lie_far(i, j, keys, farther)) out.parallel |= 1U << (3 * i + j);
      } else if (left_out || !add_near(axis, keys, upper, out)) {
        out.count = 0;
        return out;
      }
    }
    if (out.count == 1 && out.parallel == 0) out.only = supporting_facet(nearest, out.near[0].v[0], faces);
    return out;
  }

  BoxPairContact contact(const BracketWidth& width) {
    BoxPairContact out;
    const BoxDistance found = distance();
    const double limit = width.limit(greatest_coordinate());
    out.normal = found.normal;
    out.lower = -found.height - found.rounding;
    if (found.depth > 0 && found.height + found.rounding - found.depth > limit) return out;
    const BoxFoot at = foot(found, 0.125 * limit);
    out.point_a = at.point_a;
    out.point_b = at.point_b;
    set_features(found.axis, out);
    if (found.depth > 0) {
      out.upper = -found.depth;
      out.certified = at.missed <= std::max(limit, slack());
    } else {
      out.upper = std::abs(found.height) + at.missed + slack();
      out.certified = out.upper - out.lower <= limit;
    }
    return out;
  }

 private:
  template <class Answer>
  void set_features(int axis, Answer& out) const {
    const int block = axis / 4, lane = axis % 4;
    const int across = (lane + 2) % 3;
    const int va = farthest(of_a_, out.normal, -1), vb = farthest(of_b_, out.normal, 1);
    out.feature_a = {Feature::Kind::vertex, va, -1};
    out.feature_b = {Feature::Kind::vertex, vb, -1};
    if (block == 0) out.feature_a = {Feature::Kind::facet, facet_of_box(a_, across, (va & bit(across)) != 0), -1};
    if (block == 1) out.feature_b = {Feature::Kind::facet, facet_of_box(b_, across, (vb & bit(across)) != 0), -1};
    if (block >= 2) {
      out.feature_a = {Feature::Kind::edge, va & ~bit(block - 2), va | bit(block - 2)};
      out.feature_b = {Feature::Kind::edge, vb & ~bit(lane), vb | bit(lane)};
    }
  }

  /// What most boxes far apart are shown by, sooner than by fifteen axes. Rounding decides nothing here: the distance
  /// is searched for, and a search that finds none leaves the pair to others.
  bool apart_along_centres() const {
    double height = 0;
    for (int k = 0; k < 3; ++k)
      height += std::abs(generator(of_a_, k).dot(centre_)) + std::abs(generator(of_b_, k).dot(centre_));
    return height < centre_.squaredNorm();
  }

  /// Edges that are parallel up to rounding but not exactly span slivers, no wider than that rounding: along each long
  /// side lies a facet that one of the two spans with another edge. Where all of those lie far, the slivers do.
  bool slivers_lie_far(int i, int j, const BoxAxisKeys& keys, double limit) const {
    const double least = limit + 64 * kUnitRoundoff * reach_;
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      const int block = axis / 4, lane = axis % 4;
      if (lane == 3 || (block == i + 2 && lane == j)) continue;
      const auto spans = [lane](int k) { return lane == k || (lane + 1) % 3 == k; };
      const bool involved = block == 0 ? spans(i) : block == 1 ? spans(j) : block == i + 2 || lane == j;
      const double key = keys.lower_key[axis];
      if (involved && !(key > least * least && key < std::numeric_limits<double>::infinity())) return false;
    }
    return true;
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
    add(axis, n, out);
    // The other side lies farther by twice the height of P's centre.
    const double turned = std::sqrt(keys.key[axis]) + rounding - lower;
    if (lower + 2 * (std::abs(n.dot(centre_)) - turned) > upper) {
      out.beyond = std::min(out.beyond, upper);
      return true;
    }
    if (out.count == BoxNearFacets::kMost) return false;
    add(axis, -n, out);
    return true;
  }
  void add(int axis, const Vec3& n, BoxNearFacets& out) const {
    const auto i = static_cast<std::size_t>(out.count++);
    out.near[i] = triangle(axis, n);
    out.axis[i] = static_cast<std::int8_t>(axis);
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

  /// Whether generators that do not lie in the plane of the axis rise along its normal n for certain: n, of its length,
  /// errs by 10u of |u| |v|, a generator by 3u, their product by 4u.
  static bool rises(const BoxGenerators& of, int but, const Vec3& n, double turn) {
    for (int k = 0; k < 3; ++k) {
      if ((but & bit(k)) != 0) continue;
      const Vec3 g = generator(of, k);
      if (!(std::abs(g.dot(n)) > turn * of.length[k])) return false;
    }
    return true;
  }
  /// The facet of the axis at that corner, and the faces in its plane, where it supports P for certain.
  std::optional<FacetOfDifference> supporting_facet(int axis, const VertexPair& corner, SupportFaces& faces) const {
    Vec3 u, v;
    spanning(of_a_, of_b_, axis, u, v);
    const Vec3 n = u.cross(v);
    const double turn = 2 * kBoxTurn * u.norm() * v.norm();
    const int block = axis / 4, lane = axis % 4;
    const int across = (lane + 2) % 3;
    const int plane = 7 & ~bit(across);
    const int flat_a = block == 0 ? plane : block == 1 ? 0 : bit(block - 2);
    const int flat_b = block == 1 ? plane : block == 0 ? 0 : bit(lane);
    if (!rises(of_a_, flat_a, n, turn) || !rises(of_b_, flat_b, n, turn)) return std::nullopt;
    collect_box_face(flat_a, corner.a, faces.on_a);
    collect_box_face(flat_b, corner.b, faces.on_b);
    const bool high_a = (corner.a & bit(across)) != 0, high_b = (corner.b & bit(across)) != 0;
    if (block == 0) return FacetOfDifference::from_facet_of_a(a_, facet_of_box(a_, across, high_a), corner.b);
    if (block == 1) return FacetOfDifference::from_facet_of_b(b_, facet_of_box(b_, across, high_b), corner.a);
    // Of the edges as they leave the corner, that of B times that of A points outwards, or back.
    const bool along_a = (corner.a & flat_a) == 0, along_b = (corner.b & flat_b) == 0;
    const bool outwards = (n.dot(centre_) > 0) == (along_a == along_b);
    const int a0 = corner.a ^ (outwards ? 0 : flat_a);
    return FacetOfDifference::from_edges(a0, a0 ^ flat_a, corner.b, corner.b ^ flat_b);
  }

  static double signed_root(double key) { return std::copysign(std::sqrt(std::abs(key)), key); }

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

  /// The same where faces lie flush, as those of boxes at rest, whatever axis along their normal came first.
  /// @return how far from the foot; nothing where the faces miss each other.
  std::optional<double> place_on_faces(int axis, double distance, BoxPairDepth& out) const {
    const BoxFoot at = foot({axis, out.normal, distance}, 0);
    if (!(at.missed <= slack())) return std::nullopt;
    out.point_a = at.point_a;
    set_features(axis, out);
    return at.missed;
  }

  /// Edges of flush faces cross along the faces' own normal, and those turned by little against each other know it
  /// badly. But a point of P as far along the normal as `foot_lower` keeps every plane that is turned from it by a
  /// small angle away by that times its cosine; and the plane on P's other side, where P's centre is certain to lie
  /// behind that one: the other is then farther.
  double lower_beside_foot(double foot_lower, const Vec3& normal, double rounding) const {
    constexpr double kSmallAngle = 0x1p-28;  // its cosine rounds to 1
    const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
    BoxAxisKeys keys;
    box_axis_keys({of_a_, of_a_}, {of_b_, of_b_}, c, {kBoxTurn * reach_, kBoxParallelSine}, keys);
    double lower = foot_lower * (1 - kUnitRoundoff);
    for (int axis = 0; axis < kBoxAxisSlots; ++axis) {
      const double of_axis = signed_root(keys.lower_key[axis]) - rounding;
      if (axis % 4 == 3 || !(of_axis < lower)) continue;
      Vec3 u, v;
      spanning(of_a_, of_b_, axis, u, v);
      const Vec3 n = u.cross(v);
      const double turn = kBoxTurn * u.norm() * v.norm() / n.norm();
      const Vec3 m = outward(n);
      const bool sided = -m.dot(centre_) >= 2 * turn * centre_.norm() + 16 * kUnitRoundoff * reach_;
      if (sided && m.dot(normal) > 0 && m.cross(normal).norm() + 2 * turn < kSmallAngle) continue;
      lower = of_axis;
    }
    return lower;
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
};

// Eight coordinates are compared two at a time.
typedef double Two __attribute__((vector_size(16)));
typedef std::int64_t TwoFlags __attribute__((vector_size(16)));
Two both(double x) { return Two{x, x}; }
Two two(const double* x, int pair) { return Two{x[2 * pair], x[2 * pair + 1]}; }

}  // namespace

std::optional<BoxFrame> box_frame(const ConvexPolytope& p) {
  // Vertices are in lexicographic order: z changes fastest. Most hulls differ from a box in the first two already.
  if (p.num_vertices() != 8 || p.x()[0] != p.x()[1]) return std::nullopt;
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

void collect_box_face(int flat, int vertex, SupportFace& face) {
  face.clear();
  for (int v = 0; v < 8; ++v) {
    if (((v ^ vertex) & ~flat) == 0) face.push_back(v);
  }
}

BoxPairDepth box_pair_depth(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                            const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                            const BracketWidth& width) {
  return BoxSat(a, frame_a, pose_a, b, frame_b, pose_b).solve(width);
}

BoxNearFacets box_near_facets(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                              const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                              SupportFaces& faces) {
  return BoxSat(a, frame_a, pose_a, b, frame_b, pose_b).near_facets(faces);
}

BoxPairContact box_pair_contact(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                                const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                                const BracketWidth& width) {
  return BoxSat(a, frame_a, pose_a, b, frame_b, pose_b).contact(width);
}

}  // namespace pd::detail
