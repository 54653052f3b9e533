#include "solid/translation_cover.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <queue>
#include <vector>

#include "numeric/root_sum.hpp"
#include "solid/solid_contact.hpp"

namespace pd::detail {

namespace {

/// A point and its depths, A moved.
struct Spot {
  Vec3 x = Vec3::Zero();
  SurfaceDepth in_a, in_b;
  /// All translations nearer than this to the one looked at let the solids overlap.
  [[nodiscard]] double radius() const { return in_a.depth + in_b.depth; }
};

/// A cube of translations. Numbers are inside lengths.
struct Cube {
  double near;  ///< from zero
  std::int64_t order;
  Vec3 middle;
  double half;
  int level = 0;             ///< 0: the first
  std::vector<Vec3> points;  ///< with which to begin

  [[nodiscard]] double radius() const { return 0x1.bb67ae8584cabp0 * half; }  // sqrt(3), rounded up
  bool operator<(const Cube& other) const { return near != other.near ? near > other.near : order > other.order; }
};

double distance_from_zero(const Vec3& middle, double half) {
  return (middle.cwiseAbs().array() - half).cwiseMax(0.0).matrix().norm() * (1 - 0x1p-50);
}

/// Some two hundred vertices at most.
std::vector<Vec3> landmarks_of(const PosedSolids& solids, Body body) {
  constexpr std::size_t kMostVertices = 200;
  const std::size_t count = solids.solid(body).vertices().size();
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < count; v += count / kMostVertices + 1) {
    points.push_back(solids.point(body, static_cast<std::int32_t>(v)).x);
  }
  return points;
}

class StandingSolid final : public StandingBody {
 public:
  StandingSolid(const PosedSolid& a, const PosedSolid& b, const PosedSolids& solids)
      : a_(a), b_(b), solids_(solids), probe_(solids, Body::b) {}

  [[nodiscard]] SurfaceDepth depth_at(const Vec3& x) override { return probe_.at(x); }
  [[nodiscard]] SurfaceDepth depth_at(const Vec3& x, const SurfaceDepth& near, double moved) override {
    return probe_.at(x, near, moved);
  }
  [[nodiscard]] std::vector<Vec3> landmarks() const override { return landmarks_of(solids_, Body::b); }

  [[nodiscard]] Meeting meeting_after(const Vec3& way) override {
    constexpr std::int64_t kPairsOfAPoint = 16;  // take the same time
    const SolidContact found = contact_of(PosedSolids(*a_.solid, a_.pose, *b_.solid, b_.pose, way));
    Meeting out{.contact = found.contact, .points = 1 + found.pairs / kPairsOfAPoint};
    if (found.triangle_a < 0) return out;
    for (const PosedPoint& p : solids_.corners(Body::a, found.triangle_a)) out.corners_a.push_back(p.x);
    for (const PosedPoint& p : solids_.corners(Body::b, found.triangle_b)) out.corners_b.push_back(p.x);
    return out;
  }

 private:
  const PosedSolid &a_, &b_;
  const PosedSolids& solids_;
  const DepthProbe probe_;
};

class TranslationCover {
 public:
  TranslationCover(const CoverQuestion& question, SolidDepth& out)
      : question_(question),
        solids_(question.solids),
        out_(out),
        in_a_(solids_, Body::a),
        standing_(question.standing),
        box_a_(solids_.box(Body::a, solids_.solid(Body::a).nodes().front())),
        box_b_(solids_.box(Body::b, solids_.solid(Body::b).nodes().front())),
        factor_(1 + 0.999 * question.settings.delta) {}

  bool run() {
    queue_.push({0, 0, Vec3::Zero(), std::ldexp(1.0, std::ilogb(upper()) + 1), 0, {}});
    while (!queue_.empty() && queue_.top().near * factor_ < upper() && has_points_left()) {
      if (queue_.top().level == kMostLevels) break;
      const Cube cube = queue_.top();
      queue_.pop();
      look_at(cube);
    }
    double lower = upper() / factor_;
    if (!queue_.empty()) lower = std::min(lower, queue_.top().near);
    out_.lower = std::min(std::max(out_.lower, outside(lower * (1 - 0x1p-40))), out_.upper);
    return improved_;
  }

 private:
  static constexpr std::size_t kKept = 6;  ///< points of a cube, the best ones
  /// Share of a cube that a ball should reach over, before fresh points are looked at.
  static constexpr double kUseful = 0.1;
  static constexpr int kMany = 10, kFew = 4;  ///< fresh points along the longest side of where the bodies may meet
  /// A cube that is still in doubt after so many halvings has a size of 1e-12 of the first: no ball ends at a wall of
  /// no width, and much smaller cubes would not be told from each other.
  static constexpr int kMostLevels = 40;

  [[nodiscard]] double outside(double length) const { return std::ldexp(length, solids_.scale_exponent()); }
  [[nodiscard]] double upper() const { return std::ldexp(out_.upper, -solids_.scale_exponent()); }
  [[nodiscard]] bool has_points_left() const { return out_.work.points < question_.settings.max_points; }

  void look_at(const Cube& cube) {
    std::vector<Spot> spots;
    for (const Vec3& x : cube.points) spots.push_back(spot_at(x, cube.middle));
    double radius = climb(spots, cube, cube.half);
    if (radius > cube.radius()) return;
    // A small ball: A leaves B near here, or the points of the cube around this one are of little use, since the bodies
    // meet elsewhere, too.
    const bool is_shallow = radius < step_beyond(cube);
    if (is_shallow || radius < kUseful * cube.radius()) {
      if (is_shallow && leaves(cube, spots)) return halve(cube, spots, radius);
      if (is_shallow) take_crossing(cube.middle, spots);
      if (cube.level == 0) take_landmarks(spots);
      const double step = sample(cube.level == 0 || is_shallow ? kMany : kFew, cube.middle, spots);
      radius = climb(spots, cube, step);
    }
    if (radius <= cube.radius()) halve(cube, spots, radius);
  }

  [[nodiscard]] Spot spot_at(const Vec3& x, const Vec3& way) {
    ++out_.work.points;
    return {x, in_a_.at(x - way), standing_.depth_at(x)};
  }

  void take_landmarks(std::vector<Spot>& spots) {
    const auto take = [&](const std::vector<Vec3>& points) {
      for (const Vec3& x : points) spots.push_back(spot_at(x, Vec3::Zero()));
    };
    take(landmarks_of(solids_, Body::a));
    take(standing_.landmarks());
  }

  /// Adds the points of a grid in the box where the bodies' boxes meet.
  /// @return their distance
  double sample(int most, const Vec3& way, std::vector<Spot>& spots) {
    const Vec3 low = box_b_.low.cwiseMax(box_a_.low + way), sides = box_b_.high.cwiseMin(box_a_.high + way) - low;
    if (!(sides.minCoeff() > 0)) return 0;
    const double step = sides.maxCoeff() / most;
    const Eigen::Array3i counts = (sides / step).array().ceil().cwiseMax(2).cast<int>();
    for (int i = 0; i < counts[0]; ++i) {
      for (int j = 0; j < counts[1]; ++j) {
        for (int k = 0; k < counts[2]; ++k) {
          const Vec3 share = (Eigen::Array3d(i, j, k) + 0.5) / counts.cast<double>();
          spots.push_back(spot_at(low + share.cwiseProduct(sides), way));
        }
      }
    }
    return step;
  }

  /// Keeps the best spots that are not near each other, and moves them to better places until one covers the cube.
  /// @return the radius of the largest ball of translations about the cube's middle that was found.
  double climb(std::vector<Spot>& spots, const Cube& cube, double step) {
    std::stable_sort(spots.begin(), spots.end(), [](const Spot& p, const Spot& q) { return p.radius() > q.radius(); });
    std::vector<Spot> kept;
    for (const Spot& spot : spots) {
      const auto beside = [&](const Spot& other) { return (other.x - spot.x).norm() <= 0.5 * other.radius(); };
      if (kept.size() < kKept && std::none_of(kept.begin(), kept.end(), beside)) kept.push_back(spot);
    }
    spots = std::move(kept);
    double best = 0;  // of a ball that is none
    for (Spot& spot : spots) {
      if (best > cube.radius()) break;
      climb(spot, cube, std::max(step, 0.5 * std::abs(spot.radius())));
      best = std::max(best, spot.radius());
    }
    std::stable_sort(spots.begin(), spots.end(), [](const Spot& p, const Spot& q) { return p.radius() > q.radius(); });
    return best;
  }

  void climb(Spot& spot, const Cube& cube, double first) {
    for (double step = first; step > 0.2 * first && spot.radius() <= cube.radius();) {
      const Vec3 inward = spot.in_a.inward + spot.in_b.inward;
      bool better = inward.norm() > 0.1 && move(spot, step * inward.normalized(), cube.middle);
      for (int k = 0; k < 6 && !better; ++k)
        better = move(spot, (k % 2 == 0 ? step : -step) * Vec3::Unit(k / 2), cube.middle);
      if (!better) step *= 0.5;
    }
  }

  /// Moves a spot if it is better there.
  bool move(Spot& spot, const Vec3& by, const Vec3& way) {
    const double length = by.norm();
    Spot next;
    next.x = spot.x + by;
    ++out_.work.points;
    next.in_b = standing_.depth_at(next.x, spot.in_b, length);
    if (next.in_b.depth + spot.in_a.depth + length <= spot.radius()) return false;
    next.in_a = in_a_.at(next.x - way, spot.in_a, length);
    if (!(next.radius() > spot.radius())) return false;
    spot = next;
    return true;
  }

  /// @param radius  of a ball of overlapping translations about the cube's middle
  void halve(const Cube& cube, const std::vector<Spot>& spots, double radius) {
    const double half = 0.5 * cube.half;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 aside(corner & 1 ? half : -half, corner & 2 ? half : -half, corner & 4 ? half : -half);
      const Vec3 middle = cube.middle + aside;
      Cube part{distance_from_zero(middle, half), ++order_, middle, half, cube.level + 1, {}};
      if (part.near * factor_ >= upper() || aside.norm() + part.radius() < radius * (1 - 0x1p-50)) continue;
      for (const Spot& spot : spots) part.points.push_back(spot.x + 0.5 * aside);
      queue_.push(std::move(part));
    }
  }

  [[nodiscard]] StandingBody::Meeting meeting_after(const Vec3& way) {
    StandingBody::Meeting found = standing_.meeting_after(way);
    out_.work.points += found.points;
    return found;
  }

  /// Adds the corners of two places that cross.
  void take_crossing(const Vec3& way, std::vector<Spot>& spots) {
    const StandingBody::Meeting found = meeting_after(outside(1) * way);
    for (const Vec3& x : found.corners_a) spots.push_back(spot_at(x + way, way));
    for (const Vec3& x : found.corners_b) spots.push_back(spot_at(x, way));
  }

  [[nodiscard]] double step_beyond(const Cube& cube) const {
    return 0.25 * question_.settings.delta * cube.middle.norm();
  }

  /// True if the cube's middle separates, or a translation a little beyond it, where A seems to leave B.
  bool leaves(const Cube& cube, const std::vector<Spot>& spots) {
    if (spots.empty() || spots.front().radius() <= 0) return take_way(cube.middle, cube.near);
    const Vec3 exit = spots.front().in_a.inward - spots.front().in_b.inward;
    return exit.norm() > 0 && take_way(cube.middle + 2 * step_beyond(cube) * exit.normalized(), cube.near);
  }

  /// Takes a way that separates, exactly, if it is shorter than the upper end: shortened to where it begins to, and
  /// turned to where it is shorter. Places where the two touch are not taken: they may be slots of zero width.
  /// @param overlaps  no way of this length or less separates
  /// @return whether it separates.
  bool take_way(const Vec3& way, double overlaps) {
    const double share = 0.125 * question_.settings.delta, shorter = 1 - std::max(share, 0x1p-9);
    if (!(outside(way.norm()) < (1 - share) * out_.upper) ||
        !shorten(way.normalized(), outside(way.norm()), overlaps)) {
      return false;
    }
    for (double step = 0.25; step > 0x1p-8;) {
      bool better = false;
      const Vec3 best = out_.normal;
      for (int k = 0; k < 6; ++k) {
        const Vec3 aside = (k % 2 == 0 ? step : -step) * Vec3::Unit(k / 2);
        better = shorten((best + aside).normalized(), shorter * out_.upper, overlaps) || better;
      }
      if (!better) step *= 0.5;
    }
    return true;
  }

  /// Takes a way of the direction and an outside length, or a shorter one, if that separates.
  bool shorten(const Vec3& unit, double length, double overlaps) {
    constexpr int kHalvings = 8;
    const auto separates = [&](double some) { return meeting_after(some * unit).contact == ContactClass::separated; };
    double high = length, low = outside(overlaps);
    if (!(high > low) || !separates(high)) return false;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (separates(middle) ? high : low) = middle;
    }
    const Vec3 way = high * unit;
    out_.translation = way;
    out_.depth = out_.upper = length_rounded_up(way);
    out_.normal = unit;
    improved_ = true;
    return true;
  }

  const CoverQuestion& question_;
  const PosedSolids& solids_;
  SolidDepth& out_;
  const DepthProbe in_a_;
  StandingBody& standing_;
  const TriangleBox box_a_, box_b_;
  double factor_;  ///< of the bracket's ends; a little less than asked, for what is rounded
  std::priority_queue<Cube> queue_;
  std::int64_t order_ = 0;
  bool improved_ = false;
};

}  // namespace

std::unique_ptr<StandingBody> standing_solid(const PosedSolid& a, const PosedSolid& b, const PosedSolids& solids) {
  return std::make_unique<StandingSolid>(a, b, solids);
}

bool narrow_by_cover(const CoverQuestion& question, SolidDepth& out) { return TranslationCover(question, out).run(); }

}  // namespace pd::detail
