/// @file
/// What the families are: K by the exact overlay, and what the overlay costs.
#include <fmt/format.h>

#include "bench/agarwal/agarwal.hpp"
#include "pd/structure/overlay.hpp"

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;
using scenes::DepthClass;

const Claim kQuadratic{"Section 2, K", "crossed grids have Theta(m^2) facets of P, round bodies Theta(m)"};
const Claim kMaximum{"Fogel-Halperin-Weibel", "the most facets a sum can have: 4 m n - 9 m - 9 n + 26"};
const Claim kOverlay{"Section 2.2, overlay", "the overlay of the two normal diagrams is walked in O(m + n + K)"};

}  // namespace

void measure_sizes(const AgarwalSettings& settings, ClaimTable& table) {
  Overlay overlay;
  const int top = settings.quick ? 1024 : 4096;
  std::vector<Growth> costs;
  for (const AgarwalFamily family : scenes::agarwal_families()) {
    const std::string name(to_string(family));
    const bool quadratic = scenes::is_quadratic(family);
    // Of bodies with m facets each, K and the squashed coordinates grow faster.
    const int most = family == AgarwalFamily::fogel_halperin_weibel ? top / 4 : top;
    Growth facets{name, "K", "m"};
    Growth cost{name, "time of the walk, ns", "K + m"};
    double off = 0;
    for (const int m : doublings(quadratic ? most / 16 : most / 4, quadratic ? most : 4 * most)) {
      const scenes::PolytopePair pair = scenes::make_agarwal_pair(family, m, DepthClass::deep, settings.seed);
      std::int64_t k = 0;
      const std::function<void()> walk = [&] {
        k = overlay.count(pair.a, pair.pose_a, pair.b, pair.pose_b, OverlayPieces::as_walked).total();
      };
      const double time = least_times_ns({&walk, 1}, k > 1'000'000 ? 1 : 3)[0];
      facets.add(m, static_cast<double>(k));
      cost.add(static_cast<double>(k) + m, time);
      if (family == AgarwalFamily::fogel_halperin_weibel) {
        off += std::abs(static_cast<double>(k - (4LL * m * m - 18LL * m + 26)));
      }
    }
    if (family == AgarwalFamily::fogel_halperin_weibel) {
      table.add_value(kMaximum, name, "sum of |K - formula|", fmt::format("m = n = {}..{}", most / 16, most), off, 0);
    }
    table.add_order(kQuadratic, std::move(facets), quadratic ? 2 : 1, 0.1);
    costs.push_back(std::move(cost));
  }
  for (Growth& cost : costs) {
    const double per_facet = cost.y.back() / cost.x.back();
    const std::string name = cost.family;
    table.add_growth(kOverlay, std::move(cost), 1.1);
    table.add_value(kOverlay, name, "ns for each facet", "at the top", per_facet);
  }
}

}  // namespace pd::bench
