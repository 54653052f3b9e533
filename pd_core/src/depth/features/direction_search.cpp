#include "depth/features/direction_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pd::detail {

namespace {

/// A direction and the point of P that is extreme in it.
struct Probe {
  Vec3 direction;
  Vec3 extreme;
};

struct Triangle {
  std::array<Probe, 3> corners;
};

/// Of two unit vectors: grows with their angle, and is the angle where that is small.
double chord(const Vec3& u, const Vec3& v) { return (u - v).norm(); }

/// Of a right angle, less .07 radians: a cone below a right angle is convex.
constexpr double kWidestChord = 1.363;

/// The least <q, n> over the corners' directions, for the best q on a segment between two of their extreme points: a
/// ridge of P, whose ends they are, is seen by no end alone. Every unit n of the triangle is a convex combination of
/// the corners divided by its length, which is 1 at most: <q, n> is no less where the value is positive.
double bound_below(const Triangle& t) {
  double value[3][3];
  for (std::size_t q = 0; q < 3; ++q) {
    for (std::size_t n = 0; n < 3; ++n) value[q][n] = t.corners[q].extreme.dot(t.corners[n].direction);
  }
  double best = -std::numeric_limits<double>::infinity();
  for (int q = 0; q < 3; ++q) {
    const double* const from = value[q];
    const double* const to = value[(q + 1) % 3];
    const auto try_at = [&](double along) {
      double least = std::numeric_limits<double>::infinity();
      for (int n = 0; n < 3; ++n) least = std::min(least, from[n] + along * (to[n] - from[n]));
      best = std::max(best, least);
    };
    try_at(0);
    // The least of three linear functions is greatest at an end or where two of them cross.
    for (int n = 0; n < 3; ++n) {
      const int m = (n + 1) % 3;
      const double slope = to[n] - from[n] - (to[m] - from[m]);
      const double along = (from[m] - from[n]) / slope;
      if (along > 0 && along < 1) try_at(along);
    }
  }
  return best;
}

class DirectionSearch {
 public:
  DirectionSearch(const PosedCore& a, const PosedCore& b, const ExcludedCone& cone, double limit)
      : a_(a), b_(b), cone_(cone), limit_(limit) {}

  bool run() {
    constexpr std::int64_t kMostTriangles = 200000;
    constexpr double kLeastTriangle = 1e-14;
    for (int octant = 0; octant < 8; ++octant) {
      const auto corner = [&](int k) { return probe((octant >> k & 1 ? 1.0 : -1.0) * Vec3::Unit(k)); };
      open_.push_back({{corner(0), corner(1), corner(2)}});
    }
    for (std::int64_t seen = 0; !open_.empty() && !found_; ++seen) {
      const Triangle t = open_.back();
      open_.pop_back();
      const auto excluded = [&](const Probe& p) { return chord(p.direction, cone_.axis) <= cone_.chord; };
      if (std::all_of(t.corners.begin(), t.corners.end(), excluded)) continue;
      double size = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        size = std::max(size, chord(t.corners[i].direction, t.corners[(i + 1) % 3].direction));
      }
      if (least_depth(t, size) > limit_) continue;
      if (seen == kMostTriangles || size < kLeastTriangle) return true;
      split(t);
    }
    return found_;
  }

  [[nodiscard]] std::int64_t supports() const { return supports_; }

 private:
  /// A bound of h_P from below on a triangle whose corners are at most the chord `size` apart. Seen from one of its
  /// corners the triangle lies within that angle, so that a convex combination of the corners is no shorter than its
  /// cosine.
  static double least_depth(const Triangle& t, double size) {
    const double least = bound_below(t);
    if (least >= 0) return least;
    const double cosine = 1 - 0.5 * size * size;
    return cosine > 0.5 ? least / cosine : -std::numeric_limits<double>::infinity();
  }

  Probe probe(const Vec3& direction) {
    ++supports_;
    const Probe p{direction, b_.support(direction) - a_.support(-direction)};
    if (p.extreme.dot(direction) <= limit_ && chord(direction, cone_.axis) > cone_.chord) found_ = true;
    return p;
  }

  void split(const Triangle& t) {
    const auto half = [&](std::size_t i, std::size_t j) {
      return probe((t.corners[i].direction + t.corners[j].direction).normalized());
    };
    const std::array<Probe, 3> halves{half(0, 1), half(1, 2), half(2, 0)};
    open_.push_back({halves});
    for (std::size_t i = 0; i < 3; ++i) open_.push_back({{t.corners[i], halves[i], halves[(i + 2) % 3]}});
  }

  const PosedCore& a_;
  const PosedCore& b_;
  const ExcludedCone& cone_;
  double limit_;
  std::vector<Triangle> open_;
  std::int64_t supports_ = 0;
  bool found_ = false;
};

}  // namespace

double cone_of_disc(double distance, double disc, double limit, double reach) {
  if (!(disc > 0) || !(distance > 0)) return reach;
  const double size = std::sqrt(distance * distance + disc * disc);
  if (limit >= size) return reach;
  // The bound is size cos(phi - middle): it exceeds the limit from middle - half to middle + half, both acute.
  const double cos_middle = distance / size, sin_middle = disc / size;
  const double cos_half = limit / size, sin_half = std::sqrt((size - limit) * (size + limit)) / size;
  if (sin_middle * cos_half - cos_middle * sin_half > reach) return reach;
  const double cosine = cos_middle * cos_half - sin_middle * sin_half;
  const double sine = sin_middle * cos_half + cos_middle * sin_half;
  const double end = std::sqrt((1 - cosine) * (1 - cosine) + sine * sine);
  // 1e-9 covers the rounding.
  return std::max(reach, std::min(kWidestChord, end * (1 - 1e-9) - 1e-9));
}

bool another_direction_within(const PosedCore& a, const PosedCore& b, const ExcludedCone& cone, double limit,
                              std::int64_t& supports) {
  DirectionSearch search(a, b, cone, limit);
  const bool found = search.run();
  supports += search.supports();
  return found;
}

}  // namespace pd::detail
