#include "depth/facets/box_pair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace pd::detail {

namespace {

/// |column of R| <= 1 + 1e-6 (Pose), and the rounding of the half extents.
constexpr double kLongest = 1 + 0x1p-19;
/// Two faces that overlap share a point after one or two projections each way; faces askew take more.
constexpr int kMaxFootSteps = 12;
constexpr double kLeastProgress = 0.75;

/// Whether all numbers have the 24 digits of single precision: products of two of them are exact. By their bits,
/// since GCC 12 takes roundings to float and back, side by side in one vector, for none at all.
bool is_single(const Mat3& rotation) {
  constexpr std::uint64_t kBeyond = (std::uint64_t{1} << (53 - 24)) - 1;
  std::uint64_t bits = 0;
  for (int i = 0; i < 9; ++i) bits |= std::bit_cast<std::uint64_t>(rotation.data()[i]);
  return (bits & kBeyond) == 0;
}

void spread(const Mat3& rotation, const Vec3& half, BoxGenerators& out) {
  for (int k = 0; k < kGeneratorsRead; ++k) {
    const int i = k % 3;
    out.x[k] = rotation(0, i) * half[i];
    out.y[k] = rotation(1, i) * half[i];
    out.z[k] = rotation(2, i) * half[i];
    out.length[k] = kLongest * half[i];
  }
}

/// Where the edge of B comes nearest to that of A moved by x, from -1 to 1; of parallel ones, anywhere.
double crossing(const Vec3& edge_a, const Vec3& centre_a, const Vec3& edge_b, const Vec3& centre_b, const Vec3& x) {
  const Vec3 n = edge_a.cross(edge_b);
  const double squared = n.squaredNorm();
  if (!(squared > 0)) return 0;
  const double along = (centre_b - centre_a - x).cross(edge_a).dot(n) / squared;
  return std::clamp(along, -1.0, 1.0);
}

/// The points of a box farthest along a direction, up to a level: a centre and the half edges that may be added with
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

Face face(const BoxHalfEdges& of, const Vec3& along, int spanned, double level) {
  Face out{of.centre, {}, 0};
  for (int k = 0; k < 3; ++k) {
    const Vec3& g = of.edges[k];
    const double height = g.dot(along);
    if ((spanned & bit_of_box_axis(k)) != 0 || std::abs(height) <= level) {
      out.edges[out.count++] = g;
    } else {
      out.centre += height > 0 ? g : Vec3(-g);
    }
  }
  return out;
}

}  // namespace

BoxPair::BoxPair(const BoxFrame& frame_a, const Pose& pose_a, double radius_a, const BoxFrame& frame_b,
                 const Pose& pose_b, double radius_b)
    : rotation_a_(pose_a.rotation()),
      rotation_b_(pose_b.rotation()),
      centre_a_(rotation_a_ * frame_a.centre),
      centre_b_(rotation_b_ * frame_b.centre + (pose_b.translation() - pose_a.translation())),
      centre_(centre_b_ - centre_a_),
      reach_(radius_a + radius_b + (pose_b.translation() - pose_a.translation()).norm()) {
  spread(rotation_a_, frame_a.half_extents, of_a_);
  spread(rotation_b_, frame_b.half_extents, of_b_);
}

BoxDistance BoxPair::distance() const {
  BoxGenerators along_a = of_a_, along_b = of_b_;
  BoxAxesErrors errors{kBoxTurn * reach_, kBoxParallelSine};
  if (is_single(rotation_a_) && is_single(rotation_b_)) {
    spread(rotation_a_, Vec3::Ones(), along_a);
    spread(rotation_b_, Vec3::Ones(), along_b);
    errors = {0, 0};
  }
  const double c[3] = {centre_.x(), centre_.y(), centre_.z()};
  const NearestBoxAxis nearest = nearest_box_axis({of_a_, along_a}, {of_b_, along_b}, c, errors);
  BoxDistance out;
  out.axis = nearest.axis;
  Vec3 u, v;
  spanning(along_a, along_b, nearest.axis, u, v);
  out.normal = outward(u.cross(v));
  // As for `box_pair_depth`; the normal errs by 3u more.
  out.rounding = 28 * kUnitRoundoff * reach_;
  out.height = std::copysign(std::sqrt(std::abs(nearest.key)), nearest.key);
  const double slivers = errors.turn > 0 ? (kBoxParallelSine + 2 * kBoxTurn) * nearest.slivers : 0;
  out.depth = nearest.lower_key > 0 ? std::sqrt(nearest.lower_key) - out.rounding - slivers : 0;
  return out;
}

BoxFoot foot_of_boxes(const BoxHalfEdges& a, const BoxHalfEdges& b, const BoxDistance& found, double level,
                      double reach) {
  const Vec3 x = found.height * found.normal;
  const int block = found.axis / 4, lane = found.axis % 4;
  const int across = (lane + 2) % 3;
  const int plane = 7 & ~bit_of_box_axis(across);
  level = std::max(level, 16 * kUnitRoundoff * reach);
  const Face of_a = face(a, -found.normal, block == 0 ? plane : block == 1 ? 0 : bit_of_box_axis(block - 2), level);
  const Face of_b = face(b, found.normal, block == 1 ? plane : block == 0 ? 0 : bit_of_box_axis(lane), level);
  BoxFoot out;
  Vec3 on_b = of_b.centre;
  if (of_a.count == 1 && of_b.count == 1) {
    on_b += crossing(of_a.edges[0], of_a.centre, of_b.edges[0], of_b.centre, x) * of_b.edges[0];
  }
  out.missed = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxFootSteps; ++step) {
    out.point_a = of_a.nearest(on_b - x);
    on_b = of_b.nearest(out.point_a + x);
    const double last = std::exchange(out.missed, (on_b - out.point_a - x).norm());
    if (out.missed <= 32 * kUnitRoundoff * reach || !(out.missed < kLeastProgress * last)) break;
  }
  out.point_b = on_b;
  return out;
}

BoxFoot BoxPair::foot(const BoxDistance& found, double level) const {
  const auto edges_of = [](const BoxGenerators& of, const Vec3& centre) {
    return BoxHalfEdges{{generator(of, 0), generator(of, 1), generator(of, 2)}, centre};
  };
  return foot_of_boxes(edges_of(of_a_, centre_a_), edges_of(of_b_, centre_b_), found, level, reach_);
}

double BoxPair::slack() const { return 64 * kUnitRoundoff * reach_; }

void BoxPair::spanning(const BoxGenerators& a, const BoxGenerators& b, int axis, Vec3& u, Vec3& v) {
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

double BoxPair::greatest_coordinate() const {
  Vec3 extent = centre_.cwiseAbs();
  for (int k = 0; k < 3; ++k) extent += generator(of_a_, k).cwiseAbs() + generator(of_b_, k).cwiseAbs();
  return extent.maxCoeff();
}

int BoxPair::farthest(const BoxGenerators& of, const Vec3& normal, double sign) {
  int id = 0;
  for (int k = 0; k < 3; ++k) id |= sign * generator(of, k).dot(normal) > 0 ? bit(k) : 0;
  return id;
}

}  // namespace pd::detail
