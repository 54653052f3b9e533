/// @file
/// [D] Theorem 4.5: directional queries after preprocessing, beside a ray cast on P's own edges.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "bench/dobkin/dobkin.hpp"
#include "bench/dobkin/edge_caster.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/planar/direction_set.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "scenes/polygon_families.hpp"

namespace pd::bench {

namespace {

const Claim kRays{"Theorem 4.5", "directional depth of a placement in sublinear time after preprocessing"};
const Claim kSet{"Section 6, directions", "directional depth in O(log n) for a fixed set of directions"};
const Claim kStraight{"Section 6, straight", "the least way straight out, over all directions"};

/// The trapezoids of one direction: signs and time of a query, bytes; and the least way straight out.
void measure_directions(const DobkinSettings& settings, ClaimTable& table) {
  constexpr int kRound = 32;
  Growth probes{"star, Q tiny", "most signs / (log2 pieces + log2 m)", "n"}, time{"star, Q tiny", "time, ns", "n"};
  Growth bytes{"star, Q tiny", "bytes / (pieces log2 pieces)", "n"}, straight{"star, Q tiny", "time, ns", "n"};
  scenes::Random random(settings.seed + 6);
  int wrong = 0;
  for (int n = 256; n <= (settings.full ? 65536 : 4096); n *= 4) {
    const Polygon p = scenes::star_polygon(n, random), q = scenes::round_polygon(kRound, 0.3 / n);
    const PolygonDifference r = PolygonDifference::of(p, q, PolygonMethod::implicit).value();
    const Point2 d = {0.3, 1};
    const DirectionSet set = DirectionSet::of(r, {&d, 1}).value();
    const std::vector<Ray> rays = rays_in(p, r, 400, random);
    const auto pieces = static_cast<double>(set.statistics().pieces);
    std::int64_t most = 0;
    for (const Ray& ray : rays) {
      std::int64_t count = 0;
      wrong += set.depth(ray.from, 0, &count).lower != r.depth_along(ray.from, d).lower ? 1 : 0;
      most = std::max(most, count);
    }
    probes.add(n, static_cast<double>(most) / (std::log2(pieces) + std::log2(kRound)));
    bytes.add(n, static_cast<double>(set.statistics().memory_bytes) / (pieces * std::log2(pieces)));
    double sum = 0;
    time.add(n, least_mean_ns(rays, 5, [&](const Ray& ray) { sum += set.depth(ray.from, 0).depth; }));
    const std::vector<Ray> few(rays.begin(), rays.begin() + 3);
    straight.add(n, least_mean_ns(few, 1, [&](const Ray& ray) { sum += r.straight_escape_depth(ray.from).depth; }));
    if (sum < 0) std::abort();
  }
  table.add_growth(kSet, std::move(probes), 0.1);
  table.add_growth(kSet, std::move(bytes), 0.1);
  table.add_growth(kSet, std::move(time), 0.3);
  table.add_value(kSet, "star, Q tiny", std::string(kWrongAnswers), "all", wrong, 0);
  table.add_growth(kStraight, std::move(straight), 1.3);
}

template <class Make>
void measure_rays(const std::string& family, const Make& make, double q_radius, double most_ratio, double most_exponent,
                  const DobkinSettings& settings, ClaimTable& table) {
  Growth time{family, "time of a directional query, ns", "n"};
  Growth boxes{family, "boxes looked into, mean", "n"}, worst{family, "boxes, mean of the worst tenth", "n"};
  double ours = 0, cast = 0;
  int last = 0;
  scenes::Random random(settings.seed + 5);
  for (int n = 256; n <= (settings.full ? 65536 : 4096); n *= 4) {
    const Polygon p = make(n);
    const Polygon q = scenes::round_polygon(32, q_radius > 0 ? q_radius : 0.3 / n);
    const PolygonDifference r = PolygonDifference::of(p, q, PolygonMethod::implicit).value();
    const EdgeCaster caster(p);
    const std::vector<Ray> rays = rays_in(p, r, 400, random);
    std::vector<double> looked;
    for (const Ray& ray : rays) {
      std::int64_t count = 0;
      (void)r.depth_along(ray.from, ray.direction, Leave::first_exit, &count);
      looked.push_back(static_cast<double>(count));
    }
    std::sort(looked.begin(), looked.end());
    const auto tenth = static_cast<std::ptrdiff_t>(looked.size() / 10);
    boxes.add(p.num_vertices(), std::reduce(looked.begin(), looked.end()) / static_cast<double>(looked.size()));
    worst.add(p.num_vertices(), std::reduce(looked.end() - tenth, looked.end()) / static_cast<double>(tenth));
    double sum = 0;
    ours = least_mean_ns(rays, 5, [&](const Ray& ray) { sum += r.depth_along(ray.from, ray.direction).depth; });
    cast = least_mean_ns(rays, 5, [&](const Ray& ray) { sum += caster.cast(ray.from, ray.direction); });
    if (sum < 0) std::abort();  // the sums are used, so that no call is left out
    time.add(p.num_vertices(), ours);
    last = p.num_vertices();
  }
  table.add_growth(kRays, std::move(boxes), most_exponent);
  table.add_growth(kRays, std::move(worst));
  table.add_growth(kRays, std::move(time), most_exponent);
  table.add_value(kRays, family, "time / that of a ray cast on P's edges", "n = " + std::to_string(last), ours / cast,
                  most_ratio);
}

}  // namespace

void measure_polygon_rays(const DobkinSettings& settings, ClaimTable& table) {
  scenes::Random random(settings.seed);
  measure_rays(
      "star, Q tiny", [&](int n) { return scenes::star_polygon(n, random); }, 0, 0.7, 0.5, settings, table);
  measure_rays(
      "comb", [](int n) { return scenes::comb_polygon(n); }, 0.3, 1.5, 0.2, settings, table);
  measure_rays(
      "spiral", [](int n) { return scenes::spiral_polygon(n); }, 0.3, 1.5, 0.2, settings, table);
  measure_rays(
      "plate with holes",
      [](int n) { return scenes::plate_with_holes(std::max(2, static_cast<int>(std::sqrt(n / 4)))); }, 0.3, 1.5, 0.2,
      settings, table);
  measure_directions(settings, table);
}

}  // namespace pd::bench
