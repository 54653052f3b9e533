/// @file
/// [D] Theorem 4.5 counted: `ray_cost FAMILY N [RAYS]` asks for directional depths in a star, comb, spiral or plate of
/// about N vertices and casts the same rays on P's own edges. It prints the boxes that the queries looked into; their
/// instructions are counted by
///
///   valgrind --tool=callgrind --toggle-collect=pdepth_counted_queries ray_cost comb 4096
///   valgrind --tool=callgrind --toggle-collect=pdepth_counted_casts ray_cost comb 4096
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "bench/dobkin/edge_caster.hpp"
#include "scenes/polygon_families.hpp"

namespace {

using pd::bench::Ray;

struct Family {
  const char* name;
  pd::Polygon (*make)(int n, pd::scenes::Random& random);
  double q_radius;  ///< 0: smaller than P's edges
};
constexpr Family kFamilies[] = {
    {"star", pd::scenes::star_polygon, 0},
    {"comb", [](int n, pd::scenes::Random&) { return pd::scenes::comb_polygon(n); }, 0.3},
    {"spiral", [](int n, pd::scenes::Random&) { return pd::scenes::spiral_polygon(n); }, 0.3},
    {"plate",
     [](int n, pd::scenes::Random&) {
       return pd::scenes::plate_with_holes(std::max(2, static_cast<int>(std::sqrt(n / 4))));
     },
     0.3},
};

}  // namespace

/// Not inlined and named as callgrind is told.
extern "C" [[gnu::noinline]] double pdepth_counted_queries(const pd::PolygonDifference& r, const std::vector<Ray>& rays,
                                                           std::vector<std::int64_t>& boxes) {
  double sum = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    sum += r.depth_along(rays[i].from, rays[i].direction, pd::Leave::first_exit, &boxes[i]).depth;
  }
  return sum;
}
extern "C" [[gnu::noinline]] double pdepth_counted_casts(const pd::bench::EdgeCaster& caster,
                                                         const std::vector<Ray>& rays) {
  double sum = 0;
  for (const Ray& ray : rays) sum += caster.cast(ray.from, ray.direction);
  return sum;
}

int main(int argc, char** argv) {
  const Family* family = argc < 3 ? nullptr
                                  : std::find_if(std::begin(kFamilies), std::end(kFamilies),
                                                 [&](const Family& f) { return std::string(argv[1]) == f.name; });
  const int n = argc < 3 ? 0 : std::atoi(argv[2]), count = argc < 4 ? 400 : std::atoi(argv[3]);
  if (family == nullptr || family == std::end(kFamilies) || n < 16 || n % 4 != 0 || count < 1) {
    std::fprintf(stderr, "usage: ray_cost star|comb|spiral|plate N [RAYS], N a multiple of 4 from 16 on\n");
    return 2;
  }
  pd::scenes::Random random(1);
  const pd::Polygon p = family->make(n, random);
  const pd::Polygon q = pd::scenes::round_polygon(32, family->q_radius > 0 ? family->q_radius : 0.3 / n);
  const auto r = pd::PolygonDifference::of(p, q, pd::PolygonMethod::implicit).value();
  const pd::bench::EdgeCaster caster(p);
  const std::vector<Ray> rays = pd::bench::rays_in(p, r, count, random);
  std::vector<std::int64_t> boxes(rays.size());
  const double queried = pdepth_counted_queries(r, rays, boxes), cast = pdepth_counted_casts(caster, rays);
  std::sort(boxes.begin(), boxes.end());
  const auto worst = static_cast<std::ptrdiff_t>(boxes.size() - boxes.size() / 10);
  const auto mean = [&](auto from) {
    return std::accumulate(from, boxes.end(), 0.0) / static_cast<double>(boxes.end() - from);
  };
  std::printf("%d vertices, %zu rays, boxes looked into: mean %.1f, mean of the worst tenth %.1f, most %lld\n",
              p.num_vertices(), rays.size(), mean(boxes.begin()), mean(boxes.begin() + worst),
              static_cast<long long>(boxes.back()));
  std::printf("mean depth %.6g, mean length of the rays cast %.6g\n", queried / static_cast<double>(rays.size()),
              cast / static_cast<double>(rays.size()));
  return 0;
}
