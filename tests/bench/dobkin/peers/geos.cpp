// GEOS by its C interface: the union of the sweeps of -Q along P's edges and of P itself.
#include <geos_c.h>

#include <vector>

#include "bench/dobkin/polygon_peers.hpp"

namespace pd::bench {

namespace {

GEOSGeometry* ring_of(GEOSContextHandle_t geos, const std::vector<Point2>& points) {
  const auto size = static_cast<unsigned>(points.size());
  GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(geos, size + 1, 2);
  for (unsigned i = 0; i <= size; ++i) {
    GEOSCoordSeq_setXY_r(geos, sequence, i, points[i % size][0], points[i % size][1]);
  }
  return GEOSGeom_createLinearRing_r(geos, sequence);
}

GEOSGeometry* body_of(GEOSContextHandle_t geos, const Polygon& p, const Point2& shift) {
  std::vector<GEOSGeometry*> rings;
  for (int r = 0; r < p.num_rings(); ++r) {
    std::vector<Point2> points;
    for (int v = p.ring_begin(r); v < p.ring_end(r); ++v) {
      points.push_back({p.point(v)[0] - shift[0], p.point(v)[1] - shift[1]});
    }
    rings.push_back(ring_of(geos, points));
  }
  return GEOSGeom_createPolygon_r(geos, rings[0], rings.data() + 1, static_cast<unsigned>(rings.size() - 1));
}

}  // namespace

PeerSum geos_sum(const Polygon& p, const Polygon& q) {
  const GEOSContextHandle_t geos = GEOS_init_r();
  std::vector<GEOSGeometry*> pieces;
  for (const auto& sweep : edge_sweeps(p, q)) {
    pieces.push_back(GEOSGeom_createPolygon_r(geos, ring_of(geos, sweep), nullptr, 0));
  }
  pieces.push_back(body_of(geos, p, q.point(0)));
  GEOSGeometry* all =
      GEOSGeom_createCollection_r(geos, GEOS_MULTIPOLYGON, pieces.data(), static_cast<unsigned>(pieces.size()));
  GEOSGeometry* sum = GEOSUnaryUnion_r(geos, all);
  PeerSum result;
  if (sum != nullptr && GEOSGeomTypeId_r(geos, sum) == GEOS_POLYGON) {
    result.answered = true;
    result.holes = GEOSGetNumInteriorRings_r(geos, sum);
    GEOSArea_r(geos, sum, &result.area);
  }
  GEOSGeom_destroy_r(geos, sum);
  GEOSGeom_destroy_r(geos, all);
  GEOS_finish_r(geos);
  return result;
}

}  // namespace pd::bench
