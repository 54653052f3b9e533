/// @file
/// pi within (1 + delta) by rays along a covering of the sphere that is refined where it matters: the adaptive form of
/// [A] Approx-Separation.
///
/// A cell is a triangle of directions u_i. The points Delta(u_i) u_i lie on the boundary of P, so their triangle lies
/// in P, and the boundary point nearest to the origin, if its direction is in the cell's cone, is at least as far as
/// that triangle: a lower bound that is never below the paper's cos(alpha) min Delta(u_i), and exact where the three
/// rays meet one facet. Directions are laid out in a linear frame (`round_frame`): a thin P is covered as fast as a
/// round one. The cell with the least bound is cut in four until the least plane distance met so far is
/// within (1 + delta) of it. A long P with the origin near one of its ends is no rounder in that frame: where the first
/// rays there do not suffice, a covering in the frame of the input is refined by turns with it. Either bounds pi. Every
/// shot's plane gives an upper bound; where one improves the best, a ray along its normal follows, so that the
/// projection of the origin on the best plane lies on P itself.
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
/// (PolytopeShooter::exact_work).
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
      : shooter_(shooter), delta_(std::max(delta, kLeastDelta)), faces_(faces), coverings_{Covering(frame)} {
    cover(coverings_.front());
  }

  DirectionRefinementResult run() {
    for (;;) {
      Covering& covering = next_covering();
      if (covering.cells.empty()) break;
      const double lower = covering.cells.top().lower;
      if (best_.upper <= (1 + delta_) * lower || best_.upper - lower <= shooter_.absolute_error()) break;
      if (is_spent()) break;
      refine(covering);
    }
    best_.lower = 0;
    for (const Covering& covering : coverings_) best_.lower = std::max(best_.lower, covering.lower());
    best_.lower = std::min(best_.lower, best_.upper);
    best_.reached = best_.upper <= (1 + delta_) * best_.lower * (1 + 0x1p-48);
    return best_;
  }

 private:
  /// Cells of 2^-26 radians: nothing between their corners' rays is above rounding.
  static constexpr std::int32_t kFinestLevel = 26;
  /// Corners of a covering in a frame before there is a second one. Slabs and needles around the origin take a tenth.
  static constexpr std::size_t kAlone = 512;

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
  /// Directions L v for v that cover the sphere.
  struct Covering {
    explicit Covering(const Mat3& l)
        : is_framed(!l.isIdentity(0)),
          frame(l),
          dual(is_framed ? Mat3(l.template triangularView<Eigen::Lower>().solve(Mat3::Identity()).transpose()) : l) {}

    /// A lower bound of pi.
    [[nodiscard]] double lower() const { return cells.empty() ? finished : std::min(finished, cells.top().lower); }

    bool is_framed;
    Mat3 frame;
    Mat3 dual;  ///< the inverse of the frame, transposed
    std::vector<Corner> corners;
    std::priority_queue<Cell, std::vector<Cell>, Later> cells;
    std::unordered_map<std::uint64_t, std::int32_t> middles;
    double finished = std::numeric_limits<double>::infinity();  ///< least bound of the finest cells
  };

  [[nodiscard]] bool is_spent() const { return shooter_.shots() >= kMaxRays || shooter_.exact_work() >= kMaxExactWork; }

  void cover(Covering& covering) {
    const Icosahedron body = icosahedron();
    for (const Vec3& v : body.vertices) add_corner(covering, v);
    for (std::size_t f = 0; f < faces_; ++f) {
      push(covering, {body.faces[f][0], body.faces[f][1], body.faces[f][2], 0, 0});
    }
  }

  Covering& next_covering() {
    Covering& first = coverings_.front();
    if (!first.is_framed || first.corners.size() < kAlone) return first;
    if (coverings_.size() == 1) {
      coverings_.emplace_back(Mat3::Identity());
      cover(coverings_.back());
    }
    return coverings_.front().corners.size() < coverings_.back().corners.size() ? coverings_.front()
                                                                                : coverings_.back();
  }

  /// Cuts the cell with the least bound.
  void refine(Covering& covering) {
    const Cell cell = covering.cells.top();
    covering.cells.pop();
    if (cell.level == kFinestLevel) {
      covering.finished = std::min(covering.finished, cell.lower);
      return;
    }
    const std::int32_t ab = middle(covering, cell.a, cell.b), bc = middle(covering, cell.b, cell.c),
                       ca = middle(covering, cell.c, cell.a);
    const std::int32_t level = cell.level + 1;
    push(covering, {cell.a, ab, ca, level, 0});
    push(covering, {ab, cell.b, bc, level, 0});
    push(covering, {ca, bc, cell.c, level, 0});
    push(covering, {ab, bc, ca, level, 0});
  }

  std::int32_t add_corner(Covering& covering, const Vec3& round) {
    const Vec3 direction = covering.is_framed ? Vec3((covering.frame * round).normalized()) : round;
    const RayShot shot = shooter_.shoot(direction);
    covering.corners.push_back({round, direction, shot.lower});
    improve(shot);
    return static_cast<std::int32_t>(covering.corners.size()) - 1;
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

  std::int32_t middle(Covering& covering, std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
    const auto [place, fresh] = covering.middles.try_emplace(key, 0);
    if (fresh) {
      const std::vector<Corner>& corners = covering.corners;
      const Vec3 sum = corners[static_cast<std::size_t>(low)].round + corners[static_cast<std::size_t>(high)].round;
      place->second = add_corner(covering, sum.normalized());
    }
    return place->second;
  }

  void push(Covering& covering, Cell cell) {
    const auto corner = [&](std::int32_t i) -> const Corner& { return covering.corners[static_cast<std::size_t>(i)]; };
    if (covering.is_framed) {
      cell.lower = distance_in_frame(covering.dual, corner(cell.a), corner(cell.b), corner(cell.c));
      covering.cells.push(cell);
      return;
    }
    // Relative to the longest of the three, so that nothing under- or overflows.
    const double scale = std::max({corner(cell.a).lower, corner(cell.b).lower, corner(cell.c).lower});
    const auto point = [&](std::int32_t i) { return Vec3(corner(i).lower / scale * corner(i).direction); };
    cell.lower = scale * distance_below(point(cell.a), point(cell.b), point(cell.c)) * (1 - 0x1p-50);
    covering.cells.push(cell);
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
  static double distance_in_frame(const Mat3& dual, const Corner& a, const Corner& b, const Corner& c) {
    const Corner* const corners[3] = {&a, &b, &c};
    Vec3 round[3];
    for (int i = 0; i < 3; ++i) round[i] = corners[i]->lower * (dual.transpose() * corners[i]->direction);
    const double scale = std::max({round[0].norm(), round[1].norm(), round[2].norm()});
    if (!(scale > 0)) return 0;
    for (Vec3& y : round) y /= scale;
    const auto least_height = [&](const Vec3& of_round) {
      const Vec3 n = dual * of_round;
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
  std::size_t faces_;
  std::vector<Covering> coverings_;  ///< one, or two by turns
  DirectionRefinementResult best_{true, 0, std::numeric_limits<double>::infinity(), Vec3::UnitX()};
};

}  // namespace pd::detail
