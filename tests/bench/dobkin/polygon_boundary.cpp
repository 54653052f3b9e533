/// @file
/// [D] section 4: time, memory and holes of the implicit boundary, beside other people's programs in the same run.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "bench/dobkin/dobkin.hpp"
#include "bench/dobkin/polygon_peers.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "scenes/polygon_families.hpp"

namespace pd::bench {

namespace {

const Claim kBoundary{"Section 4, boundary", "the boundary of P + (-Q) in implicit form, against explicit unions"};
const Claim kHoles{"Section 4, holes", "every hole of P + (-Q) is there, and no other"};
const Claim kReflex{"Fact 4.2", "at most 6 s - 12 reflex points for s >= 3 convolved triangles"};

struct Built {
  double seconds;
  PolygonDifference::Statistics statistics;
  double area;
};

/// Least time of `rounds`; the area by the drawn boundary, for a comparison with peers.
Built build(const Polygon& p, const Polygon& q, int rounds) {
  Built best{std::numeric_limits<double>::infinity(), {}, 0};
  for (int i = 0; i < rounds; ++i) {
    const auto begin = Clock::now();
    const PolygonDifference r = PolygonDifference::of(p, q, PolygonMethod::implicit).value();
    const double seconds = elapsed_ns(begin, Clock::now()) * 1e-9;
    if (seconds < best.seconds) best.seconds = seconds;
    if (i > 0) continue;
    best.statistics = r.statistics();
    for (const auto& curve : r.boundary_curves()) {
      for (std::size_t k = 0; k + 1 < curve.points.size(); ++k) {
        const Point2 &a = curve.points[k], &b = curve.points[k + 1];
        best.area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
      }
    }
  }
  return best;
}

void measure_peers(const std::string& title, const Polygon& p, const Polygon& q, const Built& ours, ClaimTable& table) {
  double fastest = std::numeric_limits<double>::infinity();
  for (const PolygonPeer& peer : polygon_peers()) {
    if (p.num_rings() > 1 && !peer.takes_holes) continue;
    if (std::int64_t{p.num_vertices()} * q.num_vertices() > peer.most) continue;
    const auto begin = Clock::now();
    const PeerSum sum = peer.sum(p, q);
    const double seconds = elapsed_ns(begin, Clock::now()) * 1e-9;
    const std::string name(peer.name);
    table.add_value(kBoundary, title, name + ": time, s", "1 run", seconds);
    if (!sum.answered) {
      table.add_value(kBoundary, title, name + ": gives no single polygon", "1 run", 1);
      continue;
    }
    table.add_value(kHoles, title, name + ": holes, less ours", "1 run",
                    sum.holes - static_cast<double>(ours.statistics.loops - 1));
    table.add_value(kHoles, title, "area, relative to " + name + "'s, less 1", "1 run",
                    std::abs(ours.area / sum.area - 1), 1e-6);
    if (name == "CGAL") {
      table.add_value(kBoundary, title, "time / CGAL's", "1 run", ours.seconds / seconds, 1.0 / 20);
    } else {
      fastest = std::min(fastest, seconds);
    }
  }
  if (std::isfinite(fastest)) {
    table.add_value(kBoundary, title, "time / that of the faster of GEOS and Boost", "1 run", ours.seconds / fastest,
                    1.0 / 4);
  }
}

void measure_family(const std::string& title, const Polygon& p, const Polygon& q, bool peers, ClaimTable& table) {
  const Built ours = build(p, q, 3);
  const double vertices = p.num_vertices() + q.num_vertices();
  table.add_value(kBoundary, title, "time, s", "least of 3", ours.seconds);
  table.add_value(kBoundary, title, "bytes a vertex of P and Q", "1 run",
                  static_cast<double>(ours.statistics.memory_bytes) / vertices, 1024);
  table.add_value(
      kReflex, title, "reflex points / (6 s - 12)", "1 run",
      static_cast<double>(ours.statistics.reflex_points) / static_cast<double>(6 * ours.statistics.sums - 12), 1);
  if (peers) measure_peers(title, p, q, ours, table);
}

/// Holes whose number is known beforehand: square ones of side 1, which Q fits in or does not.
void count_holes(ClaimTable& table, bool full) {
  const int k = full ? 50 : 12;
  int missed = 0, false_holes = 0;
  for (const double radius : {0.1, 0.49, 0.51, 0.6}) {
    for (const int m : {3, 8, 64}) {
      const Polygon q = scenes::round_polygon(m, radius);
      double low = 1e300, high = -1e300;
      for (const Point2& x : q.points()) {
        low = std::min(low, x[0]);
        high = std::max(high, x[0]);
      }
      const auto found = PolygonDifference::of(scenes::plate_with_holes(k), q).value().statistics().loops - 1;
      const auto expected = static_cast<std::int64_t>(high - low < 1 ? k * k : 0);
      missed += static_cast<int>(std::max<std::int64_t>(0, expected - found));
      false_holes += static_cast<int>(std::max<std::int64_t>(0, found - expected));
    }
  }
  // Gaps of width 1: a smaller Q goes out of every one of them, a larger one into none.
  for (const double radius : {0.2, 0.6}) {
    const Polygon q = scenes::round_polygon(32, radius);
    false_holes += static_cast<int>(PolygonDifference::of(scenes::comb_polygon(800), q).value().statistics().loops - 1);
  }
  const Polygon thin = scenes::round_polygon(32, 0.2);
  false_holes +=
      static_cast<int>(PolygonDifference::of(scenes::spiral_polygon(1280), thin).value().statistics().loops - 1);
  table.add_value(kHoles, "plates, combs, spirals", "holes missed", "15 pairs", missed, 0);
  table.add_value(kHoles, "plates, combs, spirals", "false holes", "15 pairs", false_holes, 0);
}

}  // namespace

void measure_polygon_boundary(const DobkinSettings& settings, ClaimTable& table) {
  scenes::Random random(settings.seed);
  const int n = settings.full ? 10000 : 1000, m = settings.full ? 100 : 32;
  // Tiny beside the star's gaps, which are 2 pi / n wide at the tips.
  const auto tiny = [&](int gaps) { return 0.3 / gaps; };
  measure_family(fmt::format("star {} x {}, Q tiny", n, m), scenes::star_polygon(n, random),
                 scenes::round_polygon(m, tiny(n)), true, table);
  measure_family(fmt::format("star {} x {}, Q 30 gaps wide", n, m), scenes::star_polygon(n, random),
                 scenes::round_polygon(m, 100 * tiny(n)), !settings.full, table);
  measure_family(fmt::format("comb {} x {}", n, m), scenes::comb_polygon(n), scenes::round_polygon(m, 0.3), true,
                 table);
  measure_family(fmt::format("spiral {} x {}", n, m), scenes::spiral_polygon(n), scenes::round_polygon(m, 0.3), true,
                 table);
  const int k = settings.full ? 50 : 16;
  measure_family(fmt::format("plate {} x {} holes, Q {}", k, k, m), scenes::plate_with_holes(k),
                 scenes::round_polygon(m, 0.3), true, table);
  if (settings.full) {
    measure_family("star 100000 x 1000, Q tiny", scenes::star_polygon(100000, random),
                   scenes::round_polygon(1000, tiny(100000)), false, table);
  }
  count_holes(table, settings.full);
  Growth time{"star, Q tiny, m = 100", "time to build, s", "n"};
  for (int size = 500; size <= (settings.full ? 64000 : 8000); size *= 2) {
    time.add(size, build(scenes::star_polygon(size, random), scenes::round_polygon(100, tiny(size)), 2).seconds);
  }
  table.add_growth(kBoundary, std::move(time), 1.25);
}

}  // namespace pd::bench
