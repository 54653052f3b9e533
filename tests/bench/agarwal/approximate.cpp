/// @file
/// [A] section 3: direction grids, ray shots (Theorem 3.2), polyhedral metrics (Corollary 3.4), width
/// (Corollary 3.3, and 3.4 of the earlier version).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "bench/agarwal/agarwal.hpp"
#include "pd/depth/approximate_separation.hpp"
#include "pd/depth/approximate_width.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/polyhedral_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/width.hpp"
#include "pd/structure/direction_grid.hpp"

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;
using scenes::DepthClass;
using scenes::PolytopePair;

const Claim kCovering{"Lemma 3.1, directions", "a grid for a relative error delta has O(1 / delta) directions"};
const Claim kShots{"Theorem 3.2, one shot", "a ray shot costs O(log^2 n): supports over log^2 n do not grow"};
const Claim kGrid{"Theorem 3.2, Approx-Separation", "O(log^2 n / delta) a query: supports grow at most as 1 / delta"};
const Claim kAsItStands{"Theorem 3.2, every ray of a grid",
                        "O(1 / delta) rays whatever the bodies; (1 + delta) holds, the exact depth between"};
const Claim kMetric{"Corollary 3.4, polyhedral metrics", "O(m + n + k log^2 n) for a unit ball of k vertices"};
const Claim kFactor{"Theorem 3.2, factor", "upper <= (1 + delta) lower, and both hold the exact depth"};
const Claim kGridWidth{"Corollary 3.3, width", "width within (1 + delta) by O(1 / delta) ray shots"};
const Claim kLinearWidth{
    "Corollary 3.4, width of points",
    "one linear pass, then time that does not depend on n; at most 3 passes of 64 products a point"};

std::vector<double> deltas(const AgarwalSettings& settings) {
  return settings.quick ? std::vector<double>{0.3, 0.1, 0.03, 0.01, 0.003}
                        : std::vector<double>{0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003, 0.0001};
}

void measure_grids(const AgarwalSettings& settings, ClaimTable& table) {
  for (const GridKind kind : {GridKind::latitude_longitude, GridKind::geodesic}) {
    const std::string name = kind == GridKind::geodesic ? "geodesic" : "latitude and longitude";
    Growth count{name, "directions", "1 / delta"};
    for (const double delta : deltas(settings)) {
      const auto grid = direction_grid(kind, delta);
      if (grid) count.add(1 / delta, static_cast<double>(grid->directions.size()));
    }
    const double constant = count.y.back() / count.x.back();
    table.add_growth(kCovering, std::move(count), 1.05);
    table.add_value(kCovering, name, "directions times delta", "at the top", constant);
  }
}

/// Mean supports of a ray shot as n grows.
void measure_shots(const AgarwalSettings& settings, ClaimTable& table) {
  for (const AgarwalFamily family : {AgarwalFamily::sphere_hulls, AgarwalFamily::balls}) {
    const std::string name(to_string(family));
    Growth plain{name, "supports of a shot", "n"};
    Growth share{name, "supports of a shot / log^2 n", "n"};
    Scratch scratch;
    for (const int n : doublings(64, settings.quick ? 8192 : 262'144)) {
      const PolytopePair pair = scenes::make_agarwal_pair(family, n, DepthClass::deep, settings.seed);
      const ConvexShape a(pair.a), b(pair.b);
      scenes::Random random(settings.seed + 77);
      double supports = 0;
      constexpr int kShotCount = 64;
      for (int k = 0; k < kShotCount; ++k) {
        const auto out = directional_depth({&a, pair.pose_a}, {&b, pair.pose_b}, random.direction(), scratch);
        if (out) supports += static_cast<double>(out->statistics.support_calls) / kShotCount;
      }
      plain.add(n, supports);
      share.add(n, supports / (std::log2(n) * std::log2(n)));
    }
    table.add_growth(kShots, std::move(plain));
    table.add_growth(kShots, std::move(share), 0.05);
  }
}

void measure_grid_engine(const AgarwalSettings& settings, ClaimTable& table) {
  const int n = settings.quick ? 1024 : 16'384;
  for (const AgarwalFamily family : {AgarwalFamily::sphere_hulls, AgarwalFamily::balls, AgarwalFamily::patch}) {
    const std::string name(to_string(family));
    const PolytopePair pair = scenes::make_agarwal_pair(family, scenes::is_quadratic(family) ? std::min(n, 2048) : n,
                                                        DepthClass::deep, settings.seed);
    const ConvexShape a(pair.a), b(pair.b);
    Scratch scratch;
    const PenetrationDepth exact = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {});
    Growth supports{name, "supports", "1 / delta"};
    Growth time{name, "time, ns", "1 / delta"};
    double loosest = 0;
    int misses = 0;
    for (const double delta : deltas(settings)) {
      PenetrationDepth answer;
      const std::function<void()> query = [&] {
        answer =
            penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {.method = Method::grid, .delta = delta});
      };
      time.add(1 / delta, least_times_ns({&query, 1}, 3)[0]);
      supports.add(1 / delta, static_cast<double>(answer.statistics.support_calls));
      loosest = std::max(loosest, (answer.upper / answer.lower - 1) / delta);
      misses += answer.lower <= exact.upper && exact.lower <= answer.upper ? 0 : 1;
    }
    table.add_growth(kGrid, std::move(supports), 1.05);
    table.add_growth(kGrid, std::move(time), 1.1);
    table.add_value(kFactor, name, "(upper / lower - 1) / delta, greatest", "all deltas", loosest, 1);
    table.add_value(kFactor, name, std::string(kWrongAnswers), "all deltas", misses, 0);
  }
}

/// The algorithm without refinement: time, and the depth that it leaves open.
void measure_every_ray(const AgarwalSettings& settings, ClaimTable& table) {
  const PolytopePair pair = scenes::make_agarwal_pair(AgarwalFamily::sphere_hulls, settings.quick ? 1024 : 16'384,
                                                      DepthClass::mid, settings.seed);
  const ConvexShape a(pair.a), b(pair.b);
  const auto hierarchy_a = PolyhedralHierarchy::build(pair.a, HierarchyKind::inner);
  const auto hierarchy_b = PolyhedralHierarchy::build(pair.b, HierarchyKind::inner);
  const DirectionalHierarchies hierarchies{&*hierarchy_a, &*hierarchy_b};
  Scratch scratch;
  const PenetrationDepth exact = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {});
  for (const GridKind grid : {GridKind::latitude_longitude, GridKind::geodesic}) {
    for (const DirectionalMethod shot : {DirectionalMethod::portal, DirectionalMethod::hierarchy}) {
      const std::string name = fmt::format("{}, {}", grid == GridKind::geodesic ? "geodesic" : "latitude and longitude",
                                           shot == DirectionalMethod::portal ? "portal" : "hierarchies");
      const ApproximateSeparationSettings rays{.grid = grid, .shot = shot, .hierarchies = &hierarchies};
      Growth count{name, "rays", "1 / delta"};
      Growth time{name, "time, ns", "1 / delta"};
      double loosest = 0, supports = 0;
      int wrong = 0;
      for (double delta = 0.3; delta > (settings.quick ? 0.002 : 0.0002); delta /= 3) {
        Expected<ApproximateSeparation> found = Error{};
        const std::function<void()> query = [&] {
          found = approximate_separation({&a, pair.pose_a}, {&b, pair.pose_b}, delta, scratch, rays);
        };
        time.add(1 / delta, least_times_ns({&query, 1}, 1, false)[0]);
        if (!found) continue;
        count.add(1 / delta, static_cast<double>(found->rays));
        supports = static_cast<double>(found->ray_supports) / static_cast<double>(found->rays);
        loosest = std::max(loosest, (found->upper / found->lower - 1) / delta);
        wrong += found->lower <= exact.upper && exact.lower <= found->upper ? 0 : 1;
      }
      table.add_growth(kAsItStands, std::move(count), 1.05);
      table.add_growth(kAsItStands, std::move(time), 1.1);
      table.add_value(kAsItStands, name, "supports a ray", "at the top", supports);
      table.add_value(kAsItStands, name, "(upper / lower - 1) / delta, greatest", "all deltas", loosest, 1);
      table.add_value(kAsItStands, name, std::string(kWrongAnswers), "all deltas", wrong, 0);
    }
  }
}

void measure_metrics(const AgarwalSettings& settings, ClaimTable& table) {
  const PolytopePair pair =
      scenes::make_agarwal_pair(AgarwalFamily::sphere_hulls, 1024, DepthClass::mid, settings.seed);
  const ConvexShape a(pair.a), b(pair.b);
  Scratch scratch;
  const PenetrationDepth euclidean = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {});
  Growth supports{"sphere hulls", "supports", "k"};
  Growth time{"sphere hulls", "time, ns", "k"};
  int wrong = 0;
  for (const int k : doublings(16, settings.quick ? 512 : 8192)) {
    scenes::Random random(settings.seed + 3);
    const ConvexPolytope ball = *ConvexPolytope::from_points(scenes::sphere_hull(k, random));
    Expected<PenetrationDepth> found = Error{};
    const std::function<void()> query = [&] {
      found = polyhedral_depth({&a, pair.pose_a}, {&b, pair.pose_b}, ball, scratch);
    };
    time.add(k, least_times_ns({&query, 1}, 3)[0]);
    if (!found) {
      ++wrong;
      continue;
    }
    supports.add(k, static_cast<double>(found->statistics.support_calls));
    // A ball inside the unit ball: its gauge is at least the length.
    wrong += found->lower >= euclidean.lower * (1 - 1e-12) ? 0 : 1;
  }
  table.add_growth(kMetric, std::move(supports), 1.05);
  table.add_growth(kMetric, std::move(time), 1.1);
  table.add_value(kMetric, "sphere hulls", std::string(kWrongAnswers), "all k", wrong, 0);
}

void measure_grid_width(const AgarwalSettings& settings, ClaimTable& table) {
  for (const AgarwalFamily family : {AgarwalFamily::sphere_hulls, AgarwalFamily::balls}) {
    const std::string name(to_string(family));
    const PolytopePair pair =
        scenes::make_agarwal_pair(family, settings.quick ? 1024 : 16'384, DepthClass::deep, settings.seed);
    const ConvexShape body(pair.a);
    Scratch scratch;
    const Width exact = width({&body, pair.pose_a}, scratch);
    Growth supports{name, "supports", "1 / delta"};
    int wrong = 0;
    for (const double delta : deltas(settings)) {
      const Width near = width({&body, pair.pose_a}, scratch, Method::grid, delta);
      supports.add(1 / delta, static_cast<double>(near.statistics.support_calls));
      const bool closed = near.upper <= (1 + delta) * near.lower;
      wrong += closed && near.lower <= exact.upper && exact.lower <= near.upper ? 0 : 1;
    }
    table.add_growth(kGridWidth, std::move(supports), 1.05);
    table.add_value(kGridWidth, name, std::string(kWrongAnswers), "all deltas", wrong, 0);
  }
}

/// Extents of all points along 64 directions: what the linear pass is measured by.
double extents_along_64(const scenes::Points& points, const scenes::Points& directions) {
  constexpr std::size_t kDirections = 64;
  std::array<double, kDirections> x{}, y{}, z{}, low{}, high{};
  low.fill(1e300);
  high.fill(-1e300);
  for (std::size_t k = 0; k < kDirections; ++k) {
    x[k] = directions[k].x();
    y[k] = directions[k].y();
    z[k] = directions[k].z();
  }
  for (const Vec3& p : points) {
    const double px = p.x(), py = p.y(), pz = p.z();
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double h = x[k] * px + y[k] * py + z[k] * pz;
      low[k] = h < low[k] ? h : low[k];
      high[k] = h > high[k] ? h : high[k];
    }
  }
  double least = 1e300;
  for (std::size_t k = 0; k < kDirections; ++k) least = std::min(least, high[k] - low[k]);
  return least;
}

void measure_linear_width(const AgarwalSettings& settings, ClaimTable& table) {
  constexpr double kDelta = 1e-2;
  scenes::Random random(settings.seed + 5);
  const scenes::Points directions = scenes::sphere_hull(64, random);
  for (const bool flat : {false, true}) {
    const std::string name = flat ? "points in a flat ellipsoid" : "points on a sphere";
    Growth time{name, "time, ns", "n"};
    Growth dots{name, "dot products a point", "n"};
    double ratio = 0;
    int open = 0;
    const int top = settings.quick ? 100'000 : 1'000'000;
    for (int n = 1000; n <= top; n *= 10) {
      scenes::Points points = scenes::sphere_hull(n, random);
      if (flat) {
        for (Vec3& p : points) p = Vec3(p.x(), 0.5 * p.y(), 0.1 * p.z()) * random.uniform();
      }
      Scratch scratch;
      Expected<ApproximateWidth> answer = Error{};
      double least = 0;
      const std::vector<std::function<void()>> tasks = {[&] { answer = approximate_width(points, kDelta, scratch); },
                                                        [&] { least += extents_along_64(points, directions); }};
      const std::vector<double> times = least_times_ns(tasks, 3);
      time.add(n, times[0]);
      if (answer) dots.add(n, static_cast<double>(answer->dot_products_per_point));
      open += answer && answer->upper <= (1 + kDelta) * answer->lower && least > 0 ? 0 : 1;
      ratio = times[0] / times[1];
    }
    const std::string range = fmt::format("n = {}, delta = {:g}", top, kDelta);
    table.add_growth(kLinearWidth, std::move(time), 1.05);
    table.add_growth(kLinearWidth, std::move(dots), 0.1);
    table.add_value(kLinearWidth, name, "time over one pass of 64 products", range, ratio,
                    settings.quick ? std::nullopt : std::optional<double>(3));
    table.add_value(kLinearWidth, name, std::string(kWrongAnswers), "all n", open, 0);
  }
}

}  // namespace

void measure_approximate(const AgarwalSettings& settings, ClaimTable& table) {
  measure_grids(settings, table);
  measure_shots(settings, table);
  measure_grid_engine(settings, table);
  measure_every_ray(settings, table);
  measure_grid_width(settings, table);
  measure_metrics(settings, table);
  measure_linear_width(settings, table);
}

}  // namespace pd::bench
