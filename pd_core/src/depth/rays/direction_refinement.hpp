/// @file
/// pi within (1 + delta) by rays along a covering of the sphere that is refined where it matters: the adaptive form of
/// [A] Approx-Separation.
///
/// A cell is a triangle of directions u_i. The points Delta(u_i) u_i lie on the boundary of P, so their triangle lies
/// in P, and the boundary point nearest to the origin, if its direction is in the cell's cone, is at least as far as
/// that triangle: a lower bound that is never below the paper's cos(alpha) min Delta(u_i), and exact where the three
/// rays meet one facet. Directions are laid out in a linear frame (`round_frame`): a thin P is covered as fast as a
/// round one. The cell with the least bound is cut in four until the least plane distance met so far is
/// within (1 + delta) of it. Every shot's plane gives an upper bound; where one improves the best, a ray along its
/// normal follows, so that the projection of the origin on the best plane lies on P itself.
///
/// Cones of neighbours of unequal size leave gaps of rounding's width along a shared edge. A nearest point v there
/// costs nothing: a direction w of a cone at an angle e from v has Delta(w) <= |v| / cos(e), and 1 - cos(1e-15) is 0
/// here.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <unordered_map>
#include <vector>

#include "depth/rays/ray_shooting.hpp"
#include "numeric/unit_roundoff.hpp"
#include "structure/icosahedron.hpp"

namespace pd::detail {

/// Below this a bracket is dominated by rounding.
inline constexpr double kLeastDelta = 1e-12;

/// Rays of one search. A covering of the sphere at 2 parts in 10^4 takes as many; a ray takes 5 to 50 microseconds.
inline constexpr std::int64_t kMaxRays = std::int64_t{1} << 14;
/// The same for rays whose signs need long numbers, as coordinates of 600 decades do: some two tenths of a second
/// (PosedPair::exact_work).
inline constexpr std::int64_t kMaxExactWork = std::int64_t{1} << 23;

struct DirectionRefinementResult {
  bool reached = true;  ///< false: rounding or the budget ended the search with a wider bracket
  double lower = 0;     ///< certified: lower <= pi
  double upper = 0;     ///< least plane distance, rounded up
  Vec3 normal = Vec3::UnitX();
};

/// @tparam Shooter  PolytopeShooter or SweptShooter.
template <class Shooter>
class DirectionRefinement {
 public:
  /// @param faces  20, or 10 where P is symmetric about the origin.
  /// @param frame  L of `round_frame`: directions are L v for v that cover the sphere.
  DirectionRefinement(Shooter& shooter, double delta, std::size_t faces, const Mat3& frame = Mat3::Identity())
      : shooter_(shooter),
        delta_(std::max(delta, kLeastDelta)),
        is_framed_(!frame.isIdentity(0)),
        frame_(frame),
        dual_(is_framed_ ? Mat3(frame.triangularView<Eigen::Lower>().solve(Mat3::Identity()).transpose()) : frame) {
    const Icosahedron body = icosahedron();
    for (const Vec3& v : body.vertices) add_corner(v);
    for (std::size_t f = 0; f < faces; ++f) push({body.faces[f][0], body.faces[f][1], body.faces[f][2], 0, 0});
  }

  DirectionRefinementResult run() {
    double finished = std::numeric_limits<double>::infinity();
    while (!cells_.empty()) {
      const Cell cell = cells_.top();
      if (best_.upper <= (1 + delta_) * cell.lower || best_.upper - cell.lower <= shooter_.absolute_error()) break;
      if (is_spent()) break;
      cells_.pop();
      if (cell.level == kFinestLevel) {
        finished = std::min(finished, cell.lower);
        continue;
      }
      const std::int32_t ab = middle(cell.a, cell.b), bc = middle(cell.b, cell.c), ca = middle(cell.c, cell.a);
      const std::int32_t level = cell.level + 1;
      push({cell.a, ab, ca, level, 0});
      push({ab, cell.b, bc, level, 0});
      push({ca, bc, cell.c, level, 0});
      push({ab, bc, ca, level, 0});
    }
    best_.lower = std::min(finished, cells_.empty() ? finished : cells_.top().lower);
    best_.lower = std::min(best_.lower, best_.upper);
    best_.reached = best_.upper <= (1 + delta_) * best_.lower * (1 + 0x1p-48);
    return best_;
  }

 private:
  /// Cells of 2^-26 radians: nothing between their corners' rays is above rounding.
  static constexpr std::int32_t kFinestLevel = 26;

  struct Cell {
    std::int32_t a, b, c;
    std::int32_t level;
    double lower;
  };
  struct Later {
    bool operator()(const Cell& x, const Cell& y) const {
      if (x.lower != y.lower) return x.lower > y.lower;
      return std::array{x.a, x.b, x.c} > std::array{y.a, y.b, y.c};
    }
  };
  struct Corner {
    Vec3 round;      ///< unit, in the frame
    Vec3 direction;  ///< unit
    double lower;
  };

  [[nodiscard]] bool is_spent() const { return shooter_.shots() >= kMaxRays || shooter_.exact_work() >= kMaxExactWork; }

  std::int32_t add_corner(const Vec3& round) {
    const Vec3 direction = is_framed_ ? Vec3((frame_ * round).normalized()) : round;
    const RayShot shot = shooter_.shoot(direction);
    corners_.push_back({round, direction, shot.lower});
    improve(shot);
    return static_cast<std::int32_t>(corners_.size()) - 1;
  }

  /// Takes over a lower plane, and follows its normal down to one that holds the origin's projection.
  void improve(RayShot shot) {
    while (shot.height < best_.upper) {
      const bool by_little = best_.upper - shot.height <= 0.001 * shooter_.absolute_error();
      best_.upper = shot.height;
      best_.normal = shot.normal;
      shooter_.keep();
      if (by_little || is_spent()) return;
      shot = shooter_.shoot(shot.normal);
    }
  }

  std::int32_t middle(std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
    const auto [place, fresh] = middles_.try_emplace(key, 0);
    if (fresh) {
      const Vec3 sum = corners_[static_cast<std::size_t>(low)].round + corners_[static_cast<std::size_t>(high)].round;
      place->second = add_corner(sum.normalized());
    }
    return place->second;
  }

  void push(Cell cell) {
    const auto corner = [&](std::int32_t i) -> const Corner& { return corners_[static_cast<std::size_t>(i)]; };
    if (is_framed_) {
      cell.lower = distance_in_frame(corner(cell.a), corner(cell.b), corner(cell.c));
      cells_.push(cell);
      return;
    }
    // Relative to the longest of the three, so that nothing under- or overflows.
    const double scale = std::max({corner(cell.a).lower, corner(cell.b).lower, corner(cell.c).lower});
    const auto point = [&](std::int32_t i) { return Vec3(corner(i).lower / scale * corner(i).direction); };
    cell.lower = scale * distance_below(point(cell.a), point(cell.b), point(cell.c)) * (1 - 0x1p-50);
    cells_.push(cell);
  }

  /// A lower bound of the distance from the origin of a triangle with corners in the unit ball: min <x_i, n> / |n| for
  /// any n, here the nearest point.
  static double distance_below(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = nearest(a, b, c);
    const double length = n.norm();
    if (!(length > 0)) return 0;
    const double least = std::min({a.dot(n), b.dot(n), c.dot(n)}) / length;
    return std::max(0.0, least - 16 * kUnitRoundoff);
  }

  /// The same where lengths of several orders meet: the nearest point and the triangle's normal are found in the frame,
  /// and each product counts with its own rounding.
  [[nodiscard]] double distance_in_frame(const Corner& a, const Corner& b, const Corner& c) const {
    const Corner* const corners[3] = {&a, &b, &c};
    Vec3 round[3];
    for (int i = 0; i < 3; ++i) round[i] = corners[i]->lower * (dual_.transpose() * corners[i]->direction);
    const double scale = std::max({round[0].norm(), round[1].norm(), round[2].norm()});
    if (!(scale > 0)) return 0;
    for (Vec3& y : round) y /= scale;
    const auto least_height = [&](const Vec3& of_round) {
      const Vec3 n = dual_ * of_round;
      const double length = n.stableNorm();
      double least = std::numeric_limits<double>::infinity();
      for (const Corner* corner : corners) {
        const Vec3 products = corner->direction.cwiseProduct(n / length);
        least = std::min(least, corner->lower * (products.sum() - 16 * kUnitRoundoff * products.cwiseAbs().sum()));
      }
      return std::isfinite(least) ? least : 0;
    };
    const Vec3 across = (round[1] - round[0]).cross(round[2] - round[0]);
    double best = least_height(nearest(round[0], round[1], round[2]));
    best = std::max(best, least_height(across.dot(round[0]) < 0 ? Vec3(-across) : across));
    return std::max(0.0, best) * (1 - 0x1p-48);
  }

  /// The point of a triangle nearest to the origin, up to rounding.
  static Vec3 nearest(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a);
    const bool inside = a.cross(b).dot(n) >= 0 && b.cross(c).dot(n) >= 0 && c.cross(a).dot(n) >= 0;
    if (inside && n.squaredNorm() > 0) return n.dot(a) / n.squaredNorm() * n;
    const auto on_side = [](const Vec3& p, const Vec3& q) {
      const Vec3 e = q - p;
      const double squared = e.squaredNorm();
      const double t = squared > 0 ? std::clamp(-p.dot(e) / squared, 0.0, 1.0) : 0.0;
      return Vec3(p + t * e);
    };
    Vec3 best = on_side(a, b);
    for (const Vec3& other : {on_side(b, c), on_side(c, a)}) {
      if (other.squaredNorm() < best.squaredNorm()) best = other;
    }
    return best;
  }

  Shooter& shooter_;
  double delta_;
  bool is_framed_;
  Mat3 frame_;
  Mat3 dual_;  ///< the inverse of the frame, transposed
  std::vector<Corner> corners_;
  std::priority_queue<Cell, std::vector<Cell>, Later> cells_;
  std::unordered_map<std::uint64_t, std::int32_t> middles_;
  DirectionRefinementResult best_{true, 0, std::numeric_limits<double>::infinity(), Vec3::UnitX()};
};

}  // namespace pd::detail
