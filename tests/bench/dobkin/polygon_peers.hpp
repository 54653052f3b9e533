/// @file
/// R = P + (-Q) of polygons by other people's programs, for its time and its holes.
///
/// CGAL convolves (reduced convolution, Behar and Lien 2011). GEOS and Boost.Geometry have no Minkowski sum: they unite
/// P with the sweeps of -Q along P's edges, which is what one writes with them.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pd/planar/polygon.hpp"

namespace pd::bench {

struct PeerSum {
  bool answered = false;
  int holes = 0;
  double area = 0;
};

struct PolygonPeer {
  std::string_view name;
  PeerSum (*sum)(const Polygon& p, const Polygon& q);
  bool takes_holes;   ///< polygons with holes: stock CGAL 5.5 crashes on some of them
  std::int64_t most;  ///< product of the two sizes above which it takes minutes and is left out
};

/// Those whose packages were there when this was built.
[[nodiscard]] std::vector<PolygonPeer> polygon_peers();

/// The convex pieces whose union is R: P less a point of Q comes first, then an edge's sweep each.
[[nodiscard]] std::vector<std::vector<Point2>> edge_sweeps(const Polygon& p, const Polygon& q);

#ifdef PD_BENCH_WITH_GEOS
PeerSum geos_sum(const Polygon& p, const Polygon& q);
#endif
#ifdef PD_BENCH_WITH_CGAL
PeerSum cgal_sum(const Polygon& p, const Polygon& q);
#endif
PeerSum boost_sum(const Polygon& p, const Polygon& q);

}  // namespace pd::bench
