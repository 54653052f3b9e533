/// @file
/// What a query about an ellipsoid and a small body inside it costs, by how nearly the ellipsoid is a ball: median,
/// slowest and supports. Directions of near-balls are nearly tied, the hardest there is for an expansion.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Pose;
using pd::Vec3;
using pd::scenes::Random;

struct Options {
  int pairs = 100;
  double delta = 1e-6;
  std::uint64_t seed = 0;
};

constexpr const char* kBodies[] = {"point",   "sphere",   "near-ball", "ellipsoid", "box",
                                   "hull 32", "cylinder", "cone",      "capsule"};

/// Radii within `spread` of each other.
ConvexShape near_ball(double size, double spread, Random& random) {
  const double x = size * (1 + spread * random.uniform());
  const double y = size * (1 + spread * random.uniform());
  return *ConvexShape::ellipsoid({x, y, size * (1 + spread * random.uniform())});
}

ConvexShape small_body(int kind, double spread, Random& random) {
  const Vec3 origin = Vec3::Zero();
  switch (kind) {
    case 0:
      return *ConvexPolytope::from_points({&origin, 1});
    case 1:
      return *ConvexShape::sphere(0.1);
    case 2:
      return near_ball(0.1, spread, random);
    case 3:
      return *ConvexShape::ellipsoid({0.1, 0.15, 0.2});
    case 4:
      return *ConvexPolytope::box({0.1, 0.12, 0.14});
    case 5: {
      pd::scenes::Points points = pd::scenes::sphere_hull(32, random);
      for (Vec3& p : points) p *= 0.1;
      return *ConvexPolytope::from_points(points);
    }
    case 6:
      return *ConvexShape::cylinder(0.1, 0.1, 1);
    case 7:
      return *ConvexShape::cone(0.1, 0.1, 1);
    default:
      return *ConvexShape::capsule(0.1, 0.1, 1);
  }
}

/// Microseconds of one query: the least of three, but that slow ones are asked once.
double time_of(const pd::PosedShape& a, const pd::PosedShape& b, const pd::DepthSettings& settings,
               pd::Scratch& scratch, pd::PenetrationDepth& answer) {
  double least = 1e30;
  for (int k = 0; k < 3 && (k == 0 || least < 1e4); ++k) {
    const auto start = std::chrono::steady_clock::now();
    answer = pd::penetration_depth(a, b, scratch, settings);
    least = std::min(least, 1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

void measure(const Options& options, int kind, double spread) {
  Random random(options.seed + static_cast<std::uint64_t>(kind));
  pd::Scratch scratch;
  std::vector<double> times;
  double supports = 0;
  int missed = 0;
  for (int i = 0; i < options.pairs; ++i) {
    const ConvexShape a = near_ball(1, spread, random);
    const ConvexShape b = small_body(kind, spread, random);
    // A quarter in the very middle, a quarter near it, the others anywhere inside.
    const double apart = i % 4 == 0 ? 0 : i % 4 == 1 ? random.uniform(0, 0.3) : random.uniform(0.3, 0.95);
    const pd::PosedShape posed_a{&a, random.pose(Vec3::Zero())};
    const Vec3 centre = apart * random.direction();
    const pd::PosedShape posed_b{&b, random.pose(centre)};
    pd::PenetrationDepth answer;
    times.push_back(time_of(posed_a, posed_b, {.delta = options.delta}, scratch, answer));
    supports += static_cast<double>(answer.statistics.support_calls);
    missed += answer.bracket_reached ? 0 : 1;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("%-8g %-10s %9.2f %9.2f %9.2f %9.1f %7d\n", spread, kBodies[kind], at(0.5), at(0.99), times.back(),
              supports / options.pairs, missed);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.seed = std::random_device{}();
  CLI::App app{"Costs of curved queries: ellipsoids from balls to a ratio of 2, small bodies inside them."};
  app.add_option("--pairs", options.pairs)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--delta", options.delta)->check(CLI::Range(1e-12, 1.0))->capture_default_str();
  app.add_option("--seed", options.seed, "repeats a run (default: drawn, and printed)");
  CLI11_PARSE(app, argc, argv);
  std::printf("seed %llu, delta %g, microseconds\n", static_cast<unsigned long long>(options.seed), options.delta);
  std::printf("spread   body            p50       p99       max  supports  missed\n");
  for (const double spread : {0.0, 1e-7, 1e-5, 1e-3, 1e-2, 1e-1, 1.0}) {
    for (int kind = 0; kind < static_cast<int>(std::size(kBodies)); ++kind) measure(options, kind, spread);
  }
  return 0;
}
