/// @file
/// Class, depth and distance of two small bodies on the integer grid, exact, in a few microseconds.
///
/// P = B + (-A) has whole numbers for vertices, and every facet normal of P is a facet normal of A or B or a cross
/// product of an edge of each: whole numbers again. All of them are tried, in 16 bits: h_P(n) is a whole number and
/// depth^2 = min h_P(n)^2 / |n|^2 a fraction of numbers below 2^30. The distance is that of the point w of P nearest to
/// the origin, found face by face and proved by w . p >= w . w at every vertex p of P.
#pragma once

#include <cstdint>
#include <vector>

#include "oracle/grid_body.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::oracle::grid {

/// Where a body stands: x = R p + t.
struct Placement {
  int rotation = 0;  ///< of `axis_rotations()`
  std::array<std::int64_t, 3> translation{};
};

struct PlacedBody {
  const Body* body;
  Placement at;
};

/// B's translation less A's must not exceed this in any coordinate: then every h_P(n) is below 2^15.
inline constexpr int kMostOffset = 28;

/// numerator / denominator, both below 2^40, denominator > 0.
struct Fraction {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;
};
/// The sign of x^2 - value, exact. Requires 0 <= x <= 2^400, finite.
[[nodiscard]] int compare_square(double x, const Fraction& value);
/// The square root rounded to a double, down and up.
[[nodiscard]] double root_down(const Fraction& value);
[[nodiscard]] double root_up(const Fraction& value);

struct Verdict {
  ContactClass contact = ContactClass::separated;
  bool flat_difference = false;  ///< P lies in a plane
  Fraction depth_squared;        ///< 0 unless overlapping
  /// Optimal directions, of any length: h_P(n)^2 / |n|^2 is depth_squared. Overlapping: all of them, facet normals of
  /// P, perhaps more than once. Touching and not flat: some of those that lead out at once, all facet normals among
  /// them.
  std::vector<Int3> normals;
  Fraction distance_squared;  ///< 0 unless separated
  /// The point of P nearest to the origin, times a positive number; 0 unless separated.
  std::array<std::int64_t, 3> nearest{};
  int extent = 0;  ///< L: the largest |coordinate| of P
};

/// Judges pairs one after another; keeps the pair and its directions for the questions about an answer. The bodies
/// must outlive the questions.
class Judge {
 public:
  Judge();

  /// Time O(E_A E_B (V_A + V_B)). Throws std::logic_error where class and distance contradict each other, and
  /// std::invalid_argument where the offset is too large.
  const Verdict& judge(const PlacedBody& a, const PlacedBody& b);

  /// Whether t is not in int P, decided exactly: moving A by t leaves the interiors disjoint. Requires a verdict whose
  /// P is not flat, and finite |t_i| <= 2^400.
  [[nodiscard]] bool separates(const Vec3& t) const;
  /// The largest (<n, t> - h_P(n)) / |n| over the facet normals n of P, rounded: how far outside of P, at least, t
  /// lies.
  [[nodiscard]] double clearance(const Vec3& t) const;
  /// h_P(n) in doubles, at the vertex of P that doubles tell.
  [[nodiscard]] double support(const Vec3& n) const;

  /// Vertices, turned but not moved.
  [[nodiscard]] const std::vector<Int3>& vertices_a() const { return a_.vertices; }
  [[nodiscard]] const std::vector<Int3>& vertices_b() const { return b_.vertices; }
  [[nodiscard]] const Int3& offset() const { return offset_; }

 private:
  struct Turned {
    std::vector<Int3> vertices;
    std::vector<Int3> directions;
    std::vector<Int3> normals;
  };
  static void turn(const PlacedBody& placed, Turned& turned);
  void list_directions();
  void add_direction(const Int3& n);
  void find_extents();
  void decide();
  void find_extent();
  /// w and |w|^2 of the nearest point of P; O lies in P when it is 0.
  void find_nearest();

  // 18 edges and 12 facets at most a body of 8 vertices: 324 + 24 directions, and room for the last lanes.
  static constexpr int kMostDirections = 352;
  struct alignas(32) Lanes {
    std::int16_t x[kMostDirections];
    std::int16_t y[kMostDirections];
    std::int16_t z[kMostDirections];
    std::int16_t high[kMostDirections];  ///< h_P(n)
    std::int16_t low[kMostDirections];   ///< - h_P(-n)
  };

  Turned a_;
  Turned b_;
  Int3 offset_;
  int count_ = 0;
  Lanes lanes_;
  Verdict verdict_;
};

}  // namespace pd::oracle::grid
