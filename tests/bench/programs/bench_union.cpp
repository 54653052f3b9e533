/// @file
/// Measures the depth of non-convex bodies: the boundary of P of two star-shaped bodies against m n (the paper gives
/// O(m^2 n^2 alpha(mn)) for the envelope of m n triangles), the lazy exact search beside it, the octree's cost
/// against 1 / delta, and frames that hang together with and without the memory of the pair.
///
/// Processor time, one run: the work is deterministic and long.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "pd/compound/compound_difference.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace {

using pd::Compound;
using pd::Pose;
using pd::Vec3;
namespace scenes = pd::scenes;

double processor_ms() { return 1e3 * pd::bench::processor_seconds(); }

/// Exponent of y in x by least squares over the logarithms.
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    sx += u;
    sy += v;
    sxx += u * u;
    sxy += u * v;
  }
  const double n = static_cast<double>(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

Compound compound_of(const scenes::Surface& surface) {
  return pd::StarBody::from_faces(surface.vertices, surface.faces, surface.centre)->tetrahedra();
}

Compound compound_of(const scenes::PartList& parts) {
  std::vector<Compound::Part> list;
  for (const auto& part : parts) list.push_back({*pd::ConvexPolytope::from_points(part.points), part.pose});
  return *Compound::from_parts(std::move(list));
}

void measure_stars(int largest, std::uint64_t seed) {
  std::printf("star prisms against star prisms, turned\n%6s %8s %10s %10s %10s %12s %10s %12s %10s\n", "mn", "facets",
              "built", "boundary", "vertices", "cuts", "ms", "search cuts", "search ms");
  std::vector<double> sizes, boundary, time, search;
  scenes::Random random(seed);
  for (int k = 2; 64 * k * k <= largest; ++k) {
    const Compound a = compound_of(scenes::star_prism(k, 0.5, random)),
                   b = compound_of(scenes::star_prism(k, 0.5, random));
    const Pose pose = random.pose({0.5, 0.1, 0.2});
    double begin = processor_ms();
    const auto built = pd::minkowski_difference({&a, pose}, {&b, Pose()});
    const double built_ms = processor_ms() - begin;
    pd::Scratch scratch;
    begin = processor_ms();
    const auto answer = pd::penetration_depth(pd::PosedCompound{&a, pose}, pd::PosedCompound{&b, Pose()}, scratch);
    const double search_ms = processor_ms() - begin;
    if (!built || !answer) continue;
    const double mn = static_cast<double>(a.parts().size() * b.parts().size());
    std::printf("%6.0f %8d %10lld %10zu %10zu %12lld %10.0f %12lld %10.0f\n", mn, static_cast<int>(8 * k),
                static_cast<long long>(built->work.facets), built->facets.size(), built->vertices.size(),
                static_cast<long long>(built->work.cuts), built_ms, static_cast<long long>(answer->work.cuts),
                search_ms);
    std::fflush(stdout);
    sizes.push_back(mn);
    boundary.push_back(static_cast<double>(built->facets.size()));
    time.push_back(built_ms);
    search.push_back(search_ms);
  }
  if (sizes.size() < 2) return;
  std::printf(
      "exponents in mn: boundary facets %.2f, time to build %.2f, time to search %.2f (the paper's bound: 2)\n\n",
      exponent(sizes, boundary), exponent(sizes, time), exponent(sizes, search));
}

/// Two rough balls deep inside each other: m and n parts that meet in the middle, so that nearly all pairs overlap.
void measure_balls(int levels, std::uint64_t seed) {
  std::printf("rough balls deep in each other, turned\n%6s %10s %10s %10s %12s %10s\n", "mn", "depth", "facets",
              "cells", "cuts", "ms");
  std::vector<double> sizes, time;
  for (int total = 0; total <= 2 * levels; ++total) {
    scenes::Random random(seed);
    const Compound a = compound_of(scenes::rough_ball(total / 2, 0.3, random)),
                   b = compound_of(scenes::rough_ball((total + 1) / 2, 0.3, random));
    const Pose pose = random.pose({0.3, 0.1, 0.2});
    pd::Scratch scratch;
    const double begin = processor_ms();
    const auto answer = pd::penetration_depth(pd::PosedCompound{&a, pose}, pd::PosedCompound{&b, Pose()}, scratch);
    const double spent = processor_ms() - begin;
    if (!answer) continue;
    sizes.push_back(static_cast<double>(a.parts().size() * b.parts().size()));
    time.push_back(spent);
    std::printf("%6.0f %10.6f %10lld %10lld %12lld %10.0f\n", sizes.back(), answer->depth,
                static_cast<long long>(answer->work.facets), static_cast<long long>(answer->work.cells),
                static_cast<long long>(answer->work.cuts), spent);
    std::fflush(stdout);
  }
  if (sizes.size() > 1) std::printf("exponent of the time in mn: %.2f\n\n", exponent(sizes, time));
}

void measure_bracket(std::uint64_t seed) {
  scenes::Random random(seed);
  const std::vector<std::pair<std::string, Compound>> bodies = {{"L", compound_of(scenes::letter_l())},
                                                                {"cross", compound_of(scenes::cross())},
                                                                {"dumbbell", compound_of(scenes::dumbbell(12, random))},
                                                                {"stack", compound_of(scenes::stack(6, 0.3))}};
  std::printf("octree against 1 / delta\n%10s %10s %10s %10s %12s\n", "body", "1/delta", "cells", "ms", "gap");
  for (const auto& [name, body] : bodies) {
    const Pose pose = random.pose({0.2, 0.1, 0.15});
    std::vector<double> inverse, cells;
    for (double delta = 0.25; delta > 0.002; delta /= 2) {
      pd::Scratch scratch;
      pd::UnionSettings settings;
      settings.method = pd::UnionMethod::octree;
      settings.delta = delta;
      const double begin = processor_ms();
      const auto answer = pd::penetration_depth(pd::PosedCompound{&body, pose},
                                                pd::PosedCompound{&bodies[0].second, Pose()}, scratch, settings);
      if (!answer) continue;
      std::printf("%10s %10.0f %10lld %10.1f %12.2e\n", name.c_str(), 1 / delta,
                  static_cast<long long>(answer->work.cells), processor_ms() - begin,
                  answer->upper / answer->lower - 1);
      std::fflush(stdout);
      inverse.push_back(1 / delta);
      cells.push_back(static_cast<double>(answer->work.cells) + 1);
    }
    std::printf("%10s exponent of the cells in 1 / delta: %.2f\n", name.c_str(), exponent(inverse, cells));
  }
}

/// Frames in which A turns and moves a little: every one asked cold and from the memory of the pair, side by side.
void measure_coherent(int frames, std::uint64_t seed) {
  scenes::Random random(seed);
  const auto ball = [&](int levels) { return compound_of(scenes::rough_ball(levels, 0.3, random)); };
  struct Row {
    const char* name;
    Compound a, b;
    Vec3 offset;
  };
  const Row rows[] = {
      {"letters", compound_of(scenes::letter_l()), compound_of(scenes::letter_l()), {1.9, 0.9, 0.3}},
      {"stack, letter", compound_of(scenes::stack(6, 0.3)), compound_of(scenes::letter_l()), {0.2, 0.1, 0.15}},
      {"rubble",
       compound_of(scenes::rubble(8, 12, random)),
       compound_of(scenes::rubble(8, 12, random)),
       {0.6, 0.1, 0.2}},
      {"20-part balls", ball(0), ball(0), {0.3, 0.1, 0.2}},
      {"touching", ball(0), ball(0), {1.3, 0.1, 0.2}},
      {"80-part balls", ball(1), ball(1), {0.3, 0.1, 0.2}},
      {"touching", ball(1), ball(1), {1.5, 0.1, 0.2}},
      {"apart", ball(1), ball(1), {2.2, 0.1, 0.2}}};
  std::printf("coherent frames: turned by .004 rad, moved by .0011 a frame\n%14s %9s %12s %12s %10s %10s %10s %8s\n",
              "bodies", "depth", "cold facets", "warm facets", "cold ms", "warm ms", "warm/cold", "bytes");
  for (const Row& row : rows) {
    const Pose start = random.pose(row.offset);
    pd::Scratch scratch;
    pd::WarmUnion memory;
    double cold_ms = 0, warm_ms = 0, cold_facets = 0, warm_facets = 0, depth = 0;
    for (int frame = 0; frame <= frames; ++frame) {
      auto q = start.quaternion_wxyz();
      q[1] += 0.002 * frame;
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      for (double& x : q) x /= length;
      const Pose pose = *Pose::from_quaternion(q, row.offset + 0.001 * frame * Vec3(1, 0.5, 0));
      const pd::PosedCompound a{&row.a, pose}, b{&row.b, Pose()};
      const double begin = processor_ms();
      const auto cold = pd::penetration_depth(a, b, scratch);
      const double between = processor_ms();
      const auto warm = pd::penetration_depth(a, b, scratch, {}, &memory);
      const double end = processor_ms();
      if (!cold || !warm || cold->contact != warm->contact || cold->lower != warm->lower) {
        std::printf("%s: frame %d differs\n", row.name, frame);
        return;
      }
      if (frame == 0) continue;
      depth = cold->signed_distance();
      cold_ms += (between - begin) / frames;
      warm_ms += (end - between) / frames;
      cold_facets += static_cast<double>(cold->work.facets) / frames;
      warm_facets += static_cast<double>(warm->work.facets) / frames;
    }
    std::printf("%14s %9.5f %12.0f %12.0f %10.2f %10.2f %10.2f %8zu\n", row.name, depth, cold_facets, warm_facets,
                cold_ms, warm_ms, warm_ms / cold_ms, memory.memory_bytes());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Depth of non-convex bodies: sizes and times");
  int largest = 4096;
  std::uint64_t seed = 1;
  app.add_option("--largest", largest, "Largest m n of the star-shaped bodies")->check(CLI::Range(256, 100000));
  int levels = 1;
  app.add_option("--levels", levels, "Rough balls of 20, 80, 320 ... parts up to this many subdivisions; -1: none")
      ->check(CLI::Range(-1, 3));
  app.add_option("--seed", seed, "Seed of the random bodies");
  int frames = 10;
  app.add_option("--frames", frames, "Frames of each coherent sequence; 0: none")->check(CLI::Range(0, 10000));
  CLI11_PARSE(app, argc, argv);
  if (frames > 0) measure_coherent(frames, seed);
  measure_balls(levels, seed);
  measure_stars(largest, seed);
  measure_bracket(seed);
  return 0;
}
