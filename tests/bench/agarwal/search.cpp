/// @file
/// The engines side by side where facets are nearly tied: the ground on which [A] section 2 has to win.
#include <fmt/format.h>

#include "bench/agarwal/agarwal.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;
using scenes::DepthClass;

const Claim kSupports{"Best-first search",
                      "supports of auto, deep: the signed expansion up to its budget, beyond which it hands over"};
const Claim kEngines{"Engines, exact and deep", "time of one cold query, bracket certified"};

/// A run beyond this ends a growth.
constexpr double kLongest = 4e9;

struct Engine {
  std::string_view name;
  Method method;
};
constexpr Engine kEngineList[] = {
    {"auto", Method::automatic}, {"overlay", Method::overlay}, {"decomposition", Method::decomposition}};

}  // namespace

void measure_search(const AgarwalSettings& settings, ClaimTable& table) {
  const int top = settings.quick ? 256 : 2048;
  std::vector<Growth> times;
  for (const AgarwalFamily family : scenes::agarwal_families()) {
    const std::string name(to_string(family));
    const bool quadratic = scenes::is_quadratic(family);
    const int most = family == AgarwalFamily::fogel_halperin_weibel ? top / 4 : quadratic ? top : 4 * top;
    Growth supports{name, "supports", "m"};
    for (const Engine& engine : kEngineList) {
      Growth time{name, fmt::format("time by {}, ns", engine.name), "m"};
      Scratch scratch;
      for (const int m : doublings(quadratic ? 16 : 64, most)) {
        const scenes::PolytopePair pair = scenes::make_agarwal_pair(family, m, DepthClass::deep, settings.seed);
        const ConvexShape a(pair.a), b(pair.b);
        PenetrationDepth answer;
        const std::function<void()> query = [&] {
          answer = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch,
                                     {.method = engine.method, .bracket = Bracket::certified});
        };
        const double before = time.y.empty() ? 0 : time.y.back();
        const double ns = least_times_ns({&query, 1}, before > 1e8 ? 1 : 3, before < 1e8)[0];
        time.add(m, ns);
        if (engine.method == Method::automatic) supports.add(m, static_cast<double>(answer.statistics.support_calls));
        if (ns > (settings.quick ? kLongest / 40 : kLongest)) break;
      }
      times.push_back(std::move(time));
    }
    table.add_growth(kSupports, std::move(supports));
  }
  for (Growth& time : times) table.add_growth(kEngines, std::move(time));
}

}  // namespace pd::bench
