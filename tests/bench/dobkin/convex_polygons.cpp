/// @file
/// [D] section 3: probes of the search in two convex polygons, its time beside binary searches in arrays of their
/// length, work and probes of the medial axis.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "bench/dobkin/dobkin.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/planar/convex_depth.hpp"
#include "pd/planar/medial_axis.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

namespace {

const Claim kDirection{"Section 3", "directional depth of convex polygons in O(log n + log m)"};
const Claim kSearch{"Section 3, time", "directional depth of convex polygons beside binary searches"};
const Claim kAxis{"Theorem 3.2", "depth of any placement in O(log n) after linear preprocessing"};

ConvexPolygon ellipse(int n, double phase, double squash) {
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    const scenes::Turn t = scenes::turn((i + phase) / n);
    points.push_back({t.cosine, squash * t.sine});
  }
  return *ConvexPolygon::from_points(points);
}

struct Search {
  Point2 values, direction;
};

/// Mean nanoseconds of a call: the least time of each hundred among the rounds, all searches in turn in every round. A
/// round of thousands is longer than a busy machine leaves a program alone; a hundred is not, and the caches are those
/// of random searches all the same.
template <class Call>
double undisturbed_mean_ns(const std::vector<Search>& searches, int rounds, const Call& call) {
  constexpr std::size_t kPart = 100;
  std::vector<double> least((searches.size() + kPart - 1) / kPart, std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t part = 0; part < least.size(); ++part) {
      const auto begin = Clock::now();
      for (std::size_t i = part * kPart; i < std::min(searches.size(), (part + 1) * kPart); ++i) call(searches[i]);
      least[part] = std::min(least[part], elapsed_ns(begin, Clock::now()));
    }
  }
  return std::reduce(least.begin(), least.end()) / static_cast<double>(searches.size());
}

}  // namespace

// Two random binary searches in arrays of the polygons' lengths: the bare cost of finding something among so many.
void measure_searches(const DobkinSettings& settings, ClaimTable& table) {
  const int n = settings.full ? 1 << 20 : 1 << 15;
  const ConvexPolygon p = ellipse(n, 0.3, 0.7), q = ellipse(n, 0.1, 0.4);
  std::vector<double> first, second;
  for (int i = 0; i < n; ++i) {
    first.push_back(i);
    second.push_back(i + 0.5);
  }
  scenes::Random random(settings.seed);
  std::vector<Search> searches;
  for (int i = 0; i < 4000; ++i) {
    const scenes::Turn t = scenes::turn(random.uniform());
    searches.push_back({{random.uniform(0, n), random.uniform(0, n)}, {t.cosine, t.sine}});
  }
  double sum = 0;
  const double ours = undisturbed_mean_ns(searches, 25, [&](const Search& s) {
    sum += convex_directional_depth(p, q, {0.1, 0.2}, s.direction).value().depth;
  });
  const double bare = undisturbed_mean_ns(searches, 25, [&](const Search& s) {
    sum += *std::lower_bound(first.begin(), first.end() - 1, s.values[0]);
    sum += *std::lower_bound(second.begin(), second.end() - 1, s.values[1]);
  });
  if (sum < 0) std::abort();
  const std::string range = "n = m = " + std::to_string(n);
  table.add_value(kSearch, "ellipses", "time of a directional query, ns", range, ours);
  table.add_value(kSearch, "ellipses", "time of two std::lower_bound, ns", range, bare);
  table.add_value(kSearch, "ellipses", "time / that of two std::lower_bound", range, ours / bare, 4);
}

void measure_convex_polygons(const DobkinSettings& settings, ClaimTable& table) {
  const int most = settings.full ? 1 << 20 : 1 << 15;
  for (const int other : {0, 16, most / 4}) {
    const std::string title = other == 0 ? "ellipses, m = n" : "ellipses, m = " + std::to_string(other);
    Growth probes{title, "probes / (log2 n + log2 m)", "n"};
    scenes::Random random(settings.seed);
    for (int n = 8; n <= most; n *= 4) {
      const int m = other == 0 ? n : other;
      const ConvexPolygon p = ellipse(n, 0.3, 0.7), q = ellipse(m, 0.1, 0.4);
      double worst = 0;
      for (int i = 0; i < 1000; ++i) {
        const scenes::Turn t = scenes::turn(random.uniform());
        const auto found = convex_directional_depth(p, q, {0.1, 0.2}, {t.cosine, t.sine});
        worst = std::max(worst, static_cast<double>(found->probes));
      }
      probes.add(n, worst / (std::log2(n) + std::log2(m)));
    }
    table.add_growth(kDirection, std::move(probes), 0.05);
  }

  Growth work{"ellipses", "nodes made and dropped / n", "n"}, probes{"ellipses", "probes / log2 n", "n"};
  int wrong = 0;
  scenes::Random random(settings.seed + 1);
  for (int n = 64; n <= (settings.full ? 1 << 18 : 1 << 14); n *= 4) {
    const ConvexPolygon p = ellipse(n, 0.3, 0.7), q = ellipse(16, 0.1, 0.2);
    const MedialAxis axis = MedialAxis::build(p, q);
    work.add(n, static_cast<double>(axis.work()) / axis.num_edges());
    double sum = 0;
    for (int i = 0; i < 200; ++i) {
      const Point2 y{random.uniform(-0.6, 0.6), random.uniform(-0.4, 0.4)};
      const auto found = axis.depth(y);
      sum += static_cast<double>(found->probes) / 200;
      if (i >= 10) continue;
      const auto expected = convex_depth(p, q, y);
      wrong += found->lower != expected->lower || found->upper != expected->upper ? 1 : 0;
    }
    probes.add(n, sum / std::log2(n));
  }
  table.add_growth(kAxis, std::move(work), 0.02);
  table.add_growth(kAxis, std::move(probes), 0.1);
  table.add_value(kAxis, "ellipses", std::string(kWrongAnswers), "all", wrong, 0);
}

}  // namespace pd::bench
