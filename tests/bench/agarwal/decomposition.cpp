/// @file
/// [A] section 2: the bipartite decomposition F (C1 to C5), and the exact depth by it (Theorems 2.4 and 2.5) beside the
/// overlay, which meets every facet.
#include "pd/structure/decomposition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "depth/facets/decomposition_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {

namespace {

using scenes::AgarwalFamily;
using scenes::DepthClass;
using scenes::PolytopePair;

const Claim kCover{"C1-C4",
                   "F holds every edge-edge facet and no other pair of edges; B's line lies above A's (Lemma 2.3)"};
const Claim kSizes{"C5, eq. (1)",
                   "sizes of F: sum of |A| + |B| = O(N log^2 N), N edges in all; per class pairs 2^i and "
                   "opposite sums O(N log N)"};
const Claim kProducts{"Theorem 2.4", "sum of (|A| |B|)^(3/4) = O(K^(1/2) (m n log m log n)^(1/4)): their ratio stays"};
const Claim kBuild{"Building F", "O((m + n) log^2 (m + n)) and what F holds"};
const Claim kWork{"Theorem 2.5, work",
                  "pairs of lines tried, and those passed over for bounds of blocks; exponent over m "
                  "(the theorem's is 3/2 where K = m^2)"};
const Claim kQuarter{"Theorem 2.5, evaluations", "fewer pairs of lines are tried than K / 4"};
const Claim kTime{"Theorem 2.5, time",
                  "exact depth by decomposition in at most half the overlay's time, both whole, in one run"};
const Claim kAuto{"Theorem 2.5, auto", "auto answers by decomposition where that wins (1 = it does)"};
const Claim kNoise{"Open problem (i)",
                   "lines turned at random: the work, which was m^1.96 for a dual tree without more ideas"};

constexpr AgarwalFamily kCovered[] = {AgarwalFamily::lens,         AgarwalFamily::patch,
                                      AgarwalFamily::flat_patch,   AgarwalFamily::tilt_noise,
                                      AgarwalFamily::sphere_hulls, AgarwalFamily::fogel_halperin_weibel};

double edges_of(const PolytopePair& pair) { return static_cast<double>(pair.a.num_edges() + pair.b.num_edges()); }

void measure_family(const AgarwalSettings& settings, ClaimTable& table, AgarwalFamily family, int top,
                    std::int64_t check_limit) {
  const std::string name(to_string(family));
  Growth sums{name, "sum of sizes / log^2 N", "N"};
  Growth pairs{name, "greatest pairs 2^i / log N", "N"};
  Growth opposite{name, "greatest opposite sum / log N", "N"};
  Growth products{name, "sum (|A||B|)^(3/4) over the bound", "N"};
  Growth build{name, "time, ns", "N"};
  std::int64_t missing = 0, extra = 0, below = 0, checked = 0;
  for (const int m : doublings(16, top)) {
    const PolytopePair pair = scenes::make_agarwal_pair(family, m, DepthClass::deep, settings.seed);
    const double n = edges_of(pair), log_n = std::log2(n);
    Decomposition f = Decomposition::of(pair.a, pair.pose_a, pair.b, pair.pose_b);
    const std::function<void()> again = [&] { f = Decomposition::of(pair.a, pair.pose_a, pair.b, pair.pose_b); };
    build.add(n, least_times_ns({&again, 1}, 2, false)[0]);
    sums.add(n, static_cast<double>(f.sum_sizes()) / (log_n * log_n));
    double most_pairs = 0, most_opposite = 0;
    for (const Decomposition::SizeClass& c : f.size_classes()) {
      most_pairs = std::max(most_pairs, static_cast<double>(c.pairs) * std::exp2(c.exponent));
      most_opposite = std::max(most_opposite, static_cast<double>(c.opposite_sum));
    }
    pairs.add(n, most_pairs / log_n);
    opposite.add(n, most_opposite / log_n);
    const double edges_a = pair.a.num_edges(), edges_b = pair.b.num_edges();
    const double k = static_cast<double>(cover_of(f, pair.a, pair.b).edge_edge);
    products.add(n, f.closest_lines_work() /
                        (std::sqrt(k) * std::pow(edges_a * edges_b * std::log2(edges_a) * std::log2(edges_b), 0.25)));
    const auto check = check_decomposition(f, pair.a, pair.pose_a, pair.b, pair.pose_b, check_limit);
    if (!check) continue;
    missing += check->missing;
    extra += check->extra;
    below += check->lines_below + check->lines_meeting;
    checked = m;
  }
  const std::string range = fmt::format("m = 16..{}", checked);
  table.add_value(kCover, name, "missing (C3)", range, static_cast<double>(missing), 0);
  table.add_value(kCover, name, "extra (C2)", range, static_cast<double>(extra), 0);
  table.add_value(kCover, name, "lines not above (C4)", range, static_cast<double>(below), 0);
  table.add_growth(kSizes, std::move(sums), 1.1);
  table.add_growth(kSizes, std::move(pairs), 1.1);
  table.add_growth(kSizes, std::move(opposite), 1.1);
  table.add_growth(kProducts, std::move(products), 0.1);
  table.add_growth(kBuild, std::move(build));
}

detail::DecompositionDepth search_alone(const PolytopePair& pair, detail::OverlayDepthBuffers& overlay,
                                        detail::DecompositionBuffers& buffers) {
  const detail::PosedPair posed(pair.a, pair.pose_a, pair.b, pair.pose_b);
  return detail::decomposition_depth(posed, {}, overlay, buffers);
}

/// Work without any bound from before, and whole queries beside the overlay's.
void measure_depth(const AgarwalSettings& settings, ClaimTable& table, AgarwalFamily family, bool tilted) {
  const std::string name(to_string(family));
  const int top = settings.quick ? 1024 : 8192;
  Growth work{name, "pairs tried + lines passed over", "m"};
  Growth tried{name, "pairs of lines tried", "m"};
  Growth time{name, "time, ns", "m"};
  detail::OverlayDepthBuffers overlay;
  detail::DecompositionBuffers buffers;
  for (const int m : doublings(settings.quick ? 64 : 256, top)) {
    const PolytopePair pair = scenes::make_agarwal_pair(family, m, DepthClass::deep, settings.seed);
    detail::DecompositionDepth found;
    const std::function<void()> search = [&] { found = search_alone(pair, overlay, buffers); };
    const double ns = least_times_ns({&search, 1}, 1, m < 2048)[0];
    time.add(m, ns);
    tried.add(m, static_cast<double>(found.lines.pair_evaluations));
    work.add(m, static_cast<double>(found.lines.pair_evaluations + found.lines.lines_scanned));
    if (ns > (settings.quick ? 2e9 : 2e10)) break;
  }
  table.add_growth(tilted ? kNoise : kWork, std::move(work), tilted ? 1.96 : 1.3);
  table.add_growth(tilted ? kNoise : kWork, std::move(tried));
  table.add_growth(tilted ? kNoise : kWork, std::move(time));

  const int m = settings.quick ? 512 : 2048;
  const PolytopePair pair = scenes::make_agarwal_pair(family, m, DepthClass::deep, settings.seed);
  const ConvexShape a(pair.a), b(pair.b);
  Scratch scratch;
  PenetrationDepth answer;
  const auto query = [&](Method method) {
    return std::function<void()>([&, method] {
      answer = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch,
                                 {.method = method, .bracket = Bracket::certified});
    });
  };
  detail::DecompositionDepth found;
  const std::vector<std::function<void()>> tasks = {query(Method::overlay), query(Method::decomposition),
                                                    [&] { found = search_alone(pair, overlay, buffers); },
                                                    query(Method::automatic)};
  const std::vector<double> times = least_times_ns(tasks, settings.quick ? 3 : 5);
  const std::string range = fmt::format("m = {}", m);
  const auto bound = [&](double most) { return tilted ? std::nullopt : std::optional<double>(most); };
  table.add_value(kQuarter, name, "pairs tried / m^2", range,
                  static_cast<double>(found.lines.pair_evaluations) / (static_cast<double>(m) * m), bound(0.25));
  table.add_value(kTime, name, "decomposition / overlay", range, times[1] / times[0], bound(0.5));
  table.add_value(kTime, name, "the same without a first bound", range, times[2] / times[0]);
  table.add_value(kTime, name, "auto / overlay", range, times[3] / times[0]);
  table.add_value(kTime, name, "overlay, ms", range, times[0] * 1e-6);
  table.add_value(kAuto, name, "auto by decomposition", range, answer.method == Method::decomposition ? 1 : 0);
}

}  // namespace

void measure_decomposition(const AgarwalSettings& settings, ClaimTable& table) {
  for (const AgarwalFamily family : kCovered) {
    const bool linear = !scenes::is_quadratic(family);
    const bool most_facets = family == AgarwalFamily::fogel_halperin_weibel;
    const int top = settings.quick ? 128 : most_facets ? 256 : linear ? 8192 : 1024;
    measure_family(settings, table, family, top, settings.quick ? 200'000 : 5'000'000);
  }
  for (const AgarwalFamily family : smooth_families()) measure_depth(settings, table, family, false);
  for (const AgarwalFamily family : tilted_families()) measure_depth(settings, table, family, true);
}

}  // namespace pd::bench
