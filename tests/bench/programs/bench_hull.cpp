/// @file
/// `bench_hull`: hulls of random clouds against Qhull in the same run, and the memory that a hull keeps.
///
/// Times are processor seconds of the calling thread, the least of some runs, so that a busy machine does not blur
/// them. Qhull's time is that of qh_new_qhull with its default options; ours includes checking the input and laying out
/// the result.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "shape/point_clouds.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace {

using pd::test::Points;

/// The least time of runs that together take a second at most, of ten at most.
double least_time(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  double total = 0;
  for (int run = 0; run < 10 && (run == 0 || total < 1); ++run) {
    const double begin = pd::bench::processor_seconds();
    work();
    const double taken = pd::bench::processor_seconds() - begin;
    least = std::min(least, taken);
    total += taken;
  }
  return least;
}

/// Builds Qhull's hull of `points`; returns its number of vertices.
int qhull(const Points& points, std::vector<double>& coordinates) {
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, stderr);
  char options[] = "qhull";
  int vertices = -1;
  if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options, nullptr, stderr) == 0) {
    vertices = qh->num_vertices;
  }
  qh_freeqhull(qh, qh_ALL);
  int current = 0;
  int total = 0;
  qh_memfreeshort(qh, &current, &total);
  return vertices;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Hulls of random clouds: time against Qhull, bytes per vertex", "bench_hull");
  int largest = 1000000;
  unsigned seed = 1;
  bool with_qhull = true;
  app.add_option("--largest", largest, "number of points of the largest cloud");
  app.add_option("--seed", seed, "seed of the clouds");
  app.add_flag("!--no-qhull", with_qhull, "leave Qhull out");
  CLI11_PARSE(app, argc, argv);

  std::printf("cloud,points,seconds,qhull_seconds,vertices,qhull_vertices,facets,bytes_per_vertex\n");
  const std::vector<std::pair<std::string, std::function<Points(int)>>> clouds = {
      {"ball", [&](int n) { return pd::test::ball_cloud(n, seed); }},
      {"box", [&](int n) { return pd::test::box_cloud(n, seed); }},
      {"sphere", [&](int n) { return pd::test::sphere_cloud(n, seed); }},
      {"cube_sides", [&](int n) { return pd::test::cube_sides(n, seed); }}};
  for (const auto& [name, make] : clouds) {
    for (int n = 128; n <= largest; n = n < 1000 ? 1000 : 10 * n) {
      const Points points = make(n);
      int vertices = 0;
      int facets = 0;
      double bytes = 0;
      const double own = least_time([&] {
        const auto hull = pd::ConvexPolytope::from_points(points);
        vertices = hull->num_vertices();
        facets = hull->num_facets();
        bytes = static_cast<double>(hull->memory_bytes());
      });
      double theirs = 0;
      int their_vertices = -1;
      if (with_qhull) {
        std::vector<double> coordinates;
        for (const pd::Vec3& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
        theirs = least_time([&] { their_vertices = qhull(points, coordinates); });
      }
      std::printf("%s,%d,%.6f,%.6f,%d,%d,%d,%.0f\n", name.c_str(), n, own, theirs, vertices, their_vertices, facets,
                  bytes / vertices);
      std::fflush(stdout);
    }
  }
  return 0;
}
