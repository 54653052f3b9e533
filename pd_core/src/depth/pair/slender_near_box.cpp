#include "depth/pair/slender_near_box.hpp"

#include <algorithm>
#include <cmath>

#include "depth/facets/gauss_boxes.hpp"
#include "depth/features/nearest_of_segments.hpp"
#include "depth/pair/slender_pair.hpp"

namespace pd::detail {

namespace {

/// Which side of the box each coordinate lies beyond, 0 within.
struct Sides {
  int of[3];
  bool operator==(const Sides&) const = default;
  [[nodiscard]] int outside() const { return std::abs(of[0]) + std::abs(of[1]) + std::abs(of[2]); }
};

/// A segment in a box's own coordinates.
class SegmentBesideBox {
 public:
  SegmentBesideBox(const Vec3& start, const Vec3& along, const Vec3& halves)
      : start_(start), along_(along), halves_(halves) {}

  /// Sides of the point nearest to the box.
  [[nodiscard]] Sides nearest() const {
    Sides sides = sides_at(0);
    if (slope(0, sides) >= 0) return sides;
    sides = sides_at(1);
    if (slope(1, sides) <= 0) return sides;
    // The slope grows with t along a polygon of at most seven pieces: Newton's step is right once on the right one.
    double low = 0, high = 1, t = 0.5;
    for (int step = 0; step < kMostSteps; ++step) {
      sides = sides_at(t);
      const double here = slope(t, sides);
      (here < 0 ? low : high) = t;
      double growth = 0;
      for (int k = 0; k < 3; ++k) growth += sides.of[k] == 0 ? 0 : along_[k] * along_[k];
      const double next = t - here / growth;
      if (!(next > low && next < high)) {
        if (!(growth > 0) || next == t) return sides;
        t = 0.5 * (low + high);
        continue;
      }
      t = next;
      if (sides_at(t) == sides) return sides;
    }
    return sides;
  }

 private:
  static constexpr int kMostSteps = 24;

  [[nodiscard]] Sides sides_at(double t) const {
    Sides sides{};
    for (int k = 0; k < 3; ++k) {
      const double x = start_[k] + t * along_[k];
      sides.of[k] = (x > halves_[k] ? 1 : 0) - (x < -halves_[k] ? 1 : 0);
    }
    return sides;
  }
  /// Half of the squared distance's derivative.
  [[nodiscard]] double slope(double t, const Sides& sides) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      if (sides.of[k] != 0) sum += (start_[k] + t * along_[k] - sides.of[k] * halves_[k]) * along_[k];
    }
    return sum;
  }

  Vec3 start_;
  Vec3 along_;
  Vec3 halves_;
};

}  // namespace

bool answer_slender_near_box(const PolytopePair& pair, const DepthSettings& settings, PenetrationDepth& out) {
  const bool a_is_box = pair.a->num_vertices() > 2;
  const ConvexPolytope& body = a_is_box ? *pair.b : *pair.a;
  const ConvexPolytope& owner = a_is_box ? *pair.a : *pair.b;
  if (body.num_vertices() > 2) return false;
  const std::optional<BoxFrame> frame = box_frame(owner);
  if (!frame) return false;
  const Pose& pose_body = a_is_box ? *pair.pose_b : *pair.pose_a;
  const Pose& pose_box = a_is_box ? *pair.pose_a : *pair.pose_b;
  const Mat3& turn = pose_box.rotation();
  const Vec3 offset = pose_box.translation() - pose_body.translation();
  const PosedSegment segment(body, pose_body.rotation());
  const PosedBox box{turn * frame->centre, turn * frame->half_extents.asDiagonal()};
  const SegmentBesideBox beside(turn.transpose() * (segment.start - (offset + box.centre)),
                                turn.transpose() * segment.along, frame->half_extents);
  const Sides sides = beside.nearest();
  if (sides.outside() < 2) return false;
  // Vertices are in lexicographic order: z changes fastest.
  std::int32_t from = 0, to = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t place = 4 >> k;
    from += sides.of[k] > 0 ? place : 0;
    to += sides.of[k] >= 0 ? place : 0;
  }
  NearestOfSegments cores(segment, {owner, turn, from, to}, offset, body.radius() + owner.radius() + offset.norm());
  cores.set_box(box);
  return answer_cores_apart(pair, cores, a_is_box, settings, Bracket::certified, out);
}

}  // namespace pd::detail
