/// @file
/// [A] section 3.2: Shallow-Penetration (Theorem 3.5), its visited facets against K_delta.
#include <fmt/format.h>

#include <algorithm>

#include "bench/agarwal/agarwal.hpp"
#include "bench/agarwal/near_facets.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/shallow_penetration.hpp"

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;
using scenes::DepthClass;
using scenes::PolytopePair;

const Claim kShallow{"Theorem 3.5, search", "steps and degrees linear in the facets visited + 1 / delta"};
const Claim kNear{"Theorem 3.5, K_delta",
                  "facets visited are at most K_delta, counted by brute force: those within (1 + delta) pi"};
const Claim kVisited{"Theorem 3.5, visited", "facets visited stay those near the origin (shallow), however large K"};

}  // namespace

void measure_shallow(const AgarwalSettings& settings, ClaimTable& table) {
  constexpr double kDelta = 0.25;
  struct Row {
    AgarwalFamily family;
    DepthClass depth;
  };
  for (const Row row :
       {Row{AgarwalFamily::balls, DepthClass::deep}, Row{AgarwalFamily::balls, DepthClass::mid},
        Row{AgarwalFamily::balls, DepthClass::shallow}, Row{AgarwalFamily::sphere_hulls, DepthClass::shallow},
        Row{AgarwalFamily::patch, DepthClass::deep}}) {
    const std::string name = fmt::format("{}, {}", to_string(row.family), to_string(row.depth));
    const bool quadratic = scenes::is_quadratic(row.family);
    Growth cost{name, "steps + degrees", "visited + 1 / delta"};
    Growth visited{name, "facets visited", "n"};
    Scratch scratch;
    int wrong = 0;
    double greatest_share = 0, greatest_cost = 0;
    std::int64_t near = 0;
    const int top = settings.quick ? 1024 : 16'384;
    for (const int n : doublings(quadratic ? 16 : 64, quadratic ? top / 16 : top)) {
      const PolytopePair pair = scenes::make_agarwal_pair(row.family, n, row.depth, settings.seed);
      const ConvexShape a(pair.a), b(pair.b);
      const auto found = shallow_penetration({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, kDelta);
      if (!found) continue;
      const PenetrationDepth exact = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {});
      wrong += found->answer.lower == exact.lower && found->answer.upper == exact.upper ? 0 : 1;
      cost.add(static_cast<double>(found->counts.visited) + 1 / kDelta,
               static_cast<double>(found->counts.steps + found->counts.degrees));
      visited.add(n, static_cast<double>(found->counts.visited));
      near = count_near_facets(pair, (1 + kDelta) * exact.upper);
      const double allowed = static_cast<double>(near) + 1 / kDelta;
      greatest_share = std::max(greatest_share, visited.y.back() / allowed);
      greatest_cost = std::max(greatest_cost, cost.y.back() / allowed);
    }
    const auto [low, high] = std::minmax_element(cost.x.begin(), cost.x.end());
    double greatest = 0;
    for (std::size_t i = 0; i < cost.x.size(); ++i) greatest = std::max(greatest, cost.y[i] / cost.x[i]);
    table.add_value(kShallow, name, "greatest cost for each", fmt::format("{} sizes", cost.x.size()), greatest);
    // Where hardly more facets are visited as n grows there is no slope to speak of.
    if (!cost.x.empty() && *high > 8 * *low) table.add_growth(kShallow, std::move(cost), 1.1);
    const std::string sizes = fmt::format("n = {:g}..{:g}", visited.x.front(), visited.x.back());
    table.add_value(kNear, name, "K_delta", fmt::format("n = {:g}", visited.x.back()), static_cast<double>(near));
    table.add_value(kNear, name, "visited / (K_delta + 1 / delta), greatest", sizes, greatest_share, 1);
    table.add_value(kNear, name, "(steps + degrees) / (K_delta + 1 / delta), greatest", sizes, greatest_cost);
    table.add_growth(kVisited, std::move(visited));
    table.add_value(kVisited, name, std::string(kWrongAnswers), "all sizes", wrong, 0);
  }
}

}  // namespace pd::bench
