/// @file
/// One ray from the origin to the boundary of P = B + (-A), with a certified bracket: the step that every grid of
/// directions repeats ([A] section 3, step 2).
#pragma once

#include <array>
#include <vector>

#include "depth/difference/smooth_difference.hpp"
#include "depth/rays/portal.hpp"

namespace pd::detail {

/// x / y for exact numbers of any size, y not 0; relative error below 2^-50.
[[nodiscard]] double ratio(const Dyadic& x, const Dyadic& y);

/// Where the ray {t u} leaves P. Requires the origin in int P.
struct RayShot {
  double lower = 0;  ///< lower <= t <= upper
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit, rounded; of the supporting plane there
  double height = 0;  ///< at least h_P(normal) for `normal` as stored and times |normal|: an upper bound of pi
};

/// Shots at the difference of two polytopes: portal searches with exact signs; each bound within 2^-48 of its value.
class PolytopeShooter {
 public:
  /// A shot's plane exactly: {x : <normal, x> = offset}, offset carrying the pair's homogeneous factor once more.
  struct Plane {
    Dyadic3 normal;
    Dyadic offset;
  };

  explicit PolytopeShooter(const PosedPair& pair, const PortalHierarchies& hierarchies = {})
      : pair_(&pair), hierarchies_(hierarchies) {}

  /// Requires a direction other than zero; t counts in units of it.
  RayShot shoot(const Vec3& direction);
  [[nodiscard]] const Plane& plane() const { return plane_; }  ///< of the last shot
  /// Marks the last shot as the best so far.
  void keep() { kept_ = plane_; }
  /// Three vertices of P on the last shot's plane, which the ray crosses.
  [[nodiscard]] const std::array<VertexPair, 3>& corners() const { return corners_; }
  [[nodiscard]] const Plane& kept() const { return kept_; }
  [[nodiscard]] std::int64_t support_calls() const { return support_calls_; }
  [[nodiscard]] std::int64_t shots() const { return shots_; }
  /// PosedPair's own count, and what exact signs of doubles that are many powers of two apart cost besides.
  [[nodiscard]] std::int64_t exact_work() const { return pair_->exact_work() + spread_work_; }
  /// Brackets narrower than this, times a length, are not to be had.
  [[nodiscard]] double absolute_error() const { return 0; }

 private:
  const PosedPair* pair_;
  PortalHierarchies hierarchies_;
  Plane plane_;
  Plane kept_;
  std::array<VertexPair, 3> corners_{};
  std::int64_t support_calls_ = 0;
  std::int64_t shots_ = 0;
  std::int64_t spread_work_ = 0;
};

/// The point of A whose difference from one of B is where a ray crosses the triangle of three vertices of P, rounded.
[[nodiscard]] Vec3 crossing_on_a(const PosedPair& pair, const std::array<VertexPair, 3>& corners,
                                 const Vec3& direction);

/// Shots at the difference of any two convex bodies, swept ones with their margins: a portal search in doubles, between
/// the triangle that the ray crosses inside P and the plane that supports P beyond it.
class SweptShooter {
 public:
  /// @param inner_radius  > 0, a certified radius of a ball about the origin inside P.
  /// @param relative      a shot ends when upper <= (1 + relative) lower, or where rounding ends its progress.
  SweptShooter(const PosedShape& a, const PosedShape& b, std::vector<PointPair>& points, double inner_radius,
               double relative);

  RayShot shoot(const Vec3& direction);
  /// The last shot's triangle: points of A and of B (relative to A's translation), and the weights of the ray's
  /// crossing.
  struct Crossing {
    Vec3 on_a = Vec3::Zero();
    Vec3 on_b = Vec3::Zero();
  };
  [[nodiscard]] const Crossing& crossing() const { return crossing_; }
  /// A kept shot is fired again where its crossing is wanted.
  void keep() const {}
  [[nodiscard]] std::int64_t support_calls() const { return support_calls_; }
  [[nodiscard]] std::int64_t shots() const { return shots_; }
  [[nodiscard]] static std::int64_t exact_work() { return 0; }
  /// What is below this is not distinguished: 1e-12 of P's reach, as for every answer about smooth bodies.
  [[nodiscard]] double absolute_error() const { return 1e-12 * reach_; }

 private:
  struct Corner {
    Vec3 x;
    PointPair points;
  };
  Corner support(const Vec3& direction);
  std::array<Corner, 3> enclose(const Vec3& unit);
  /// Tightens the shot along `unit` by a portal about `line`, a direction at or near it.
  void push_portal(const Vec3& unit, const Vec3& line, RayShot& shot);
  /// Points of A and of B whose difference lies in the triangle, where the line crosses it up to rounding.
  static Crossing cross_triangle(const std::array<Corner, 3>& corners, const Vec3& line);

  SmoothDifference difference_;
  std::vector<PointPair>& points_;
  double margin_a_;
  double margin_b_;
  double inner_radius_;
  double relative_;
  double reach_;
  double error_;  ///< of a support's position and of its height
  Crossing crossing_;
  std::int64_t support_calls_ = 0;
  std::int64_t shots_ = 0;
};

}  // namespace pd::detail
