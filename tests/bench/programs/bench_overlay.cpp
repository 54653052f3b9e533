/// @file
/// Measures the overlay of two normal diagrams: K, time of the walk alone and of the exact depth engine on it, and the
/// quadratic alternative (every pair of edges whose arcs cross, in doubles) where it is affordable.
///
/// The least of several rounds is reported: the work is deterministic, so that whatever slows a round down is
/// disturbance.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "depth/facets/overlay_depth.hpp"
#include "scenes/shape_families.hpp"

namespace {

using pd::ConvexPolytope;
using pd::Pose;
using pd::Vec3;
namespace scenes = pd::scenes;

/// Microseconds of one call, the mean of `calls`.
template <class Task>
double time_of(int calls, Task&& task) {
  const double begin = pd::bench::processor_seconds();
  for (int i = 0; i < calls; ++i) task();
  return 1e6 * (pd::bench::processor_seconds() - begin) / calls;
}

struct ArcTable {
  std::vector<Vec3> edges, left, right, points;
};

ArcTable arcs_of(const ConvexPolytope& body, const Pose& pose, double sign) {
  ArcTable table;
  for (int h = 0; h < body.num_half_edges(); ++h) {
    const pd::HalfEdge& e = body.half_edge(h);
    if (e.twin < h) continue;
    table.edges.push_back(pose.rotation() * (body.vertex(body.target(h)) - body.vertex(e.origin)));
    table.left.push_back(sign * (pose.rotation() * body.facet_normal(e.facet)));
    table.right.push_back(sign * (pose.rotation() * body.facet_normal(body.half_edge(e.twin).facet)));
    table.points.push_back(pose.apply(body.vertex(e.origin)));
  }
  return table;
}

/// Least edge-edge distance over all pairs whose arcs cross: separating axes pruned by the Gauss map, O(m n).
double arc_pruned_axes(const ArcTable& a, const ArcTable& b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.edges.size(); ++i) {
    for (std::size_t j = 0; j < b.edges.size(); ++j) {
      const double c = b.edges[j].dot(a.left[i]), d = b.edges[j].dot(a.right[i]);
      if (c * d >= 0) continue;
      const double e = a.edges[i].dot(b.left[j]), f = a.edges[i].dot(b.right[j]);
      if (e * f >= 0) continue;
      const Vec3 n = a.edges[i].cross(b.edges[j]);
      const double side_a = n.dot(a.left[i] * std::abs(d) + a.right[i] * std::abs(c));
      const double side_b = n.dot(b.left[j] * std::abs(f) + b.right[j] * std::abs(e));
      if (side_a * side_b <= 0) continue;
      least = std::min(least, std::abs((b.points[j] - a.points[i]).dot(n)) / n.norm());
    }
  }
  return least;
}

struct Row {
  std::string family;
  int n = 0;
  std::int64_t facets = 0;
  double walk = std::numeric_limits<double>::infinity();
  double depth = std::numeric_limits<double>::infinity();
  double axes = std::numeric_limits<double>::infinity();
  std::int64_t exact = 0;
};

Row measure(const std::string& family, int n, const scenes::PointPair& points, int rounds, double axes_limit) {
  const ConvexPolytope a = *ConvexPolytope::from_points(points.a);
  const ConvexPolytope b = *ConvexPolytope::from_points(points.b);
  Row row;
  row.family = family;
  row.n = n;
  pd::detail::OverlayDepthBuffers buffers;
  const int calls = a.num_vertices() + b.num_vertices() < 100 ? 50 : 1;
  for (int round = 0; round < rounds; ++round) {
    row.walk = std::min(row.walk, time_of(calls, [&] {
                          row.facets = 0;
                          const pd::detail::PosedPair pair(a, points.pose_a, b, points.pose_b);
                          pd::detail::OverlayWalk walk(pair, buffers.overlay);
                          walk.run([&](std::span<const pd::detail::OverlayPiece> pieces) {
                            row.facets += static_cast<std::int64_t>(pieces.size());
                            return true;
                          });
                        }));
    row.depth = std::min(row.depth, time_of(calls, [&] {
                           const pd::detail::PosedPair pair(a, points.pose_a, b, points.pose_b);
                           pd::detail::overlay_depth(pair, buffers);
                           row.exact = pair.stages().exact;
                         }));
  }
  if (static_cast<double>(a.num_edges()) * b.num_edges() <= axes_limit) {
    for (int round = 0; round < std::max(2, rounds / 4); ++round) {
      double least = 0;
      row.axes = std::min(row.axes, time_of(calls, [&] {
                                      least =
                                          arc_pruned_axes(arcs_of(a, points.pose_a, -1), arcs_of(b, points.pose_b, 1));
                                    }) + (least < 0 ? 1 : 0));
    }
  }
  return row;
}

void print(const Row& row) {
  std::printf("%-14s %7d %10lld %12.2f %12.2f %9.1f ", row.family.c_str(), row.n, static_cast<long long>(row.facets),
              row.walk, row.depth, 1e3 * row.depth / static_cast<double>(row.facets));
  std::isfinite(row.axes) ? std::printf("%12.1f", row.axes) : std::printf("%12s", "-");
  std::printf(" %8lld\n", static_cast<long long>(row.exact));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times of the overlay of two normal diagrams, in microseconds (least of the rounds)"};
  int largest = 2000;
  std::uint64_t seed = 1;
  double axes_limit = 2e7;
  app.add_option("--largest", largest, "largest lens profile (K is about its square)")->capture_default_str();
  app.add_option("--seed", seed, "seed of the random families")->capture_default_str();
  app.add_option("--axes-limit", axes_limit, "pairs of edges above which the quadratic method is left out")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::printf("%-14s %7s %10s %12s %12s %9s %12s %8s\n", "family", "n", "K", "walk us", "depth us", "ns per K",
              "axes us", "exact");
  for (const int n : {8, 32, 128, 1024, 8192}) {
    const auto pair = scenes::make_pair(scenes::PairFamily::sphere, n, scenes::DepthClass::deep, seed);
    print(measure("sphere", n, pair, n <= 32 ? 40 : n <= 1024 ? 100 : 15, axes_limit));
  }
  for (const int m : {32, 128, 512, 1000, 2000, 4000}) {
    if (m > largest) continue;
    // Profiles of m ridges, extruded along y and, turned by a right angle about z, along x; a small tilt breaks the
    // ties.
    scenes::PointPair pair;
    pair.a = scenes::lens(2 * m, 0.5);
    pair.b = scenes::lens(2 * m, 0.5);
    pair.pose_a = *Pose::from_quaternion({std::sqrt(0.5), 0.001, 0.0007, std::sqrt(0.5)}, Vec3(0.01, 0.02, 0.03));
    print(measure("lens grid", m, pair, m <= 512 ? 60 : 15, axes_limit));
  }
  for (const auto family : {scenes::PairFamily::roofs, scenes::PairFamily::tilted_roofs, scenes::PairFamily::box,
                            scenes::PairFamily::cubes, scenes::PairFamily::prism, scenes::PairFamily::equal_bodies}) {
    const int n = family == scenes::PairFamily::box || family == scenes::PairFamily::cubes ? 8 : 512;
    const auto pair = scenes::make_pair(family, n, scenes::DepthClass::deep, seed);
    print(measure(std::string(to_string(family)), n, pair, 30, axes_limit));
  }
  return 0;
}
