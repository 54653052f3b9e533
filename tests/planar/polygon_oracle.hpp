/// @file
/// How deep two small polygons are inside each other, by trying everything: shares no code with the core.
///
/// For polygons with small whole coordinates and placements that are multiples of 1/8. All contacts of a vertex with an
/// edge happen along segments in the plane of placements; their crossings, ends and feet are the only places where an
/// answer can lie. All of these are fractions with denominators below 1e5, so that doubles tell different ones apart by
/// far (1e-6 against rounding of 1e-12), and overlap is decided by trying points of both polygons.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace oracle {

using Vec = std::array<double, 2>;
using Rings = std::vector<std::vector<Vec>>;  ///< outer ring, holes; any orientation

class PolygonOracle {
 public:
  PolygonOracle(const Rings& p, const Rings& q);

  /// Is y in the interior of the closure of {y : int P meets int (Q + y)}? In that closure?
  [[nodiscard]] bool interior(const Vec& y) const;
  [[nodiscard]] std::string contact(const Vec& y) const;
  /// Do the interiors of P and Q + y meet?
  [[nodiscard]] bool overlap(const Vec& y) const;
  /// Interior without overlap, among the ends and crossings of contacts: single seats, and ends of slots.
  [[nodiscard]] std::vector<Vec> seats() const;
  /// Distance from an interior placement to the nearest one that is not.
  [[nodiscard]] double depth(const Vec& y) const;
  /// Least t >= 0 for which y + t d/|d| is not interior.
  [[nodiscard]] double depth_along(const Vec& y, const Vec& d) const;
  /// Least t from which on none is interior.
  [[nodiscard]] double straight_exit(const Vec& y, const Vec& d) const;
  /// The least of that over all d: tried towards every place on the boundary where two contacts cross or one ends, and
  /// square to every contact.
  [[nodiscard]] double straight_escape(const Vec& y) const;

 private:
  struct Segment {
    Vec a, b;
  };
  /// Ends and crossings of contacts, and the feet of y on them.
  [[nodiscard]] std::vector<Vec> places(const Vec& y) const;
  [[nodiscard]] std::vector<double> critical(const Vec& y, const Vec& d) const;
  /// How many of the sectors between edge directions round y overlap, and of how many.
  [[nodiscard]] std::array<int, 2> sectors(const Vec& y) const;

  std::vector<Segment> p_, q_;  ///< edges, the interior on the left
  std::vector<Segment> contacts_;
  std::vector<Vec> directions_;  ///< between all directions of edges
};

}  // namespace oracle
