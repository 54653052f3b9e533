#include "bench/dobkin/polygon_peers.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <utility>

#include "pd/planar/convex_polygon.hpp"

namespace pd::bench {

std::vector<std::vector<Point2>> edge_sweeps(const Polygon& p, const Polygon& q) {
  std::vector<std::vector<Point2>> sweeps;
  for (int v = 0; v < p.num_vertices(); ++v) {
    std::vector<Point2> points;
    for (const Point2& end : {p.point(v), p.point(p.next(v))}) {
      for (const Point2& x : q.points()) points.push_back({end[0] - x[0], end[1] - x[1]});
    }
    const auto hull = ConvexPolygon::from_points(points).value();
    sweeps.emplace_back(hull.points().begin(), hull.points().end());
  }
  return sweeps;
}

namespace {

namespace bg = boost::geometry;
using Spot = bg::model::d2::point_xy<double>;
using Piece = bg::model::polygon<Spot, false>;  // counter-clockwise, closed
using Pieces = bg::model::multi_polygon<Piece>;

Piece piece_of(const std::vector<Point2>& ring) {
  Piece piece;
  for (const Point2& x : ring) bg::append(piece.outer(), Spot(x[0], x[1]));
  bg::append(piece.outer(), Spot(ring[0][0], ring[0][1]));
  return piece;
}

/// Halves first, so that no union is much larger than its parts.
Pieces united(const std::vector<Piece>& pieces, std::size_t begin, std::size_t end) {
  if (end - begin == 1) return {pieces[begin]};
  const std::size_t middle = (begin + end) / 2;
  const Pieces a = united(pieces, begin, middle), b = united(pieces, middle, end);
  Pieces r;
  bg::union_(a, b, r);
  return r;
}

}  // namespace

PeerSum boost_sum(const Polygon& p, const Polygon& q) {
  std::vector<Piece> pieces;
  for (const auto& sweep : edge_sweeps(p, q)) pieces.push_back(piece_of(sweep));
  Piece body;
  for (int r = 0; r < p.num_rings(); ++r) {
    if (r > 0) body.inners().emplace_back();
    auto& ring = r == 0 ? body.outer() : body.inners().back();
    for (int v = p.ring_begin(r); v <= p.ring_end(r); ++v) {
      const Point2& x = p.point(v == p.ring_end(r) ? p.ring_begin(r) : v);
      ring.emplace_back(x[0] - q.point(0)[0], x[1] - q.point(0)[1]);
    }
  }
  pieces.push_back(std::move(body));
  PeerSum sum;
  try {
    const Pieces all = united(pieces, 0, pieces.size());
    sum.answered = all.size() == 1;
    for (const Piece& piece : all) sum.holes += static_cast<int>(piece.inners().size());
    sum.area = bg::area(all);
  } catch (const bg::exception&) {  // it throws where rounding breaks its overlay
    sum.answered = false;
  }
  return sum;
}

std::vector<PolygonPeer> polygon_peers() {
  std::vector<PolygonPeer> peers = {{"Boost.Geometry", boost_sum, true, 200'000}};
#ifdef PD_BENCH_WITH_GEOS
  peers.push_back({"GEOS", geos_sum, true, 2'000'000});
#endif
#ifdef PD_BENCH_WITH_CGAL
  peers.push_back({"CGAL", cgal_sum, false, 2'000'000});
#endif
  return peers;
}

}  // namespace pd::bench
