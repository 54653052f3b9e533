/// @file
/// [M] Lemma 5 and section 1.1: sizes of kernels, work of directional width queries; promises on hard bodies.
#include <fmt/format.h>

#include <algorithm>

#include "bench/agarwal/agarwal.hpp"
#include "bench/arya/arya.hpp"
#include "bench/arya/clouds.hpp"
#include "pd/dimension/directional_width.hpp"
#include "pd/dimension/epsilon_kernel.hpp"

namespace pd::bench {

namespace {

using dimension::Backend;
using dimension::Body;
using dimension::DirectionalWidth;
using dimension::QueryCounters;
using dimension::Vector;

const Claim kSize{"Section 1.1, kernels", "an epsilon-kernel of a fat body has O(1/epsilon^((d-1)/2)) points"};
const Claim kQuery{"Lemma 5, kernel backend", "a directional width query costs O(polylog 1/epsilon)"};
const Claim kPromise{"Lemma 5, promise", "every directional width is at least 1 - epsilon of the true one"};

template <int D>
void sizes(const AryaSettings& settings, ClaimTable& table, std::size_t n, std::initializer_list<double> epsilons) {
  std::mt19937_64 random(settings.seed);
  const auto body = *Body<D>::from_points(cloud<D>(Cloud::sphere, n, random));
  const std::string name = fmt::format("sphere, d = {}", D);
  Growth points{name, "kernel points", "1 / epsilon"};
  Growth nodes{name, "nodes a query", "1 / epsilon"};
  Growth products{name, "dot products a query", "1 / epsilon"};
  for (const double epsilon : epsilons) {
    const auto structure = DirectionalWidth<D>::build(body, epsilon);
    QueryCounters counters;
    constexpr int kQueries = 2000;
    for (int i = 0; i < kQueries; ++i) (void)structure->support(direction<D>(random), counters);
    points.add(1 / epsilon, static_cast<double>(structure->size().points));
    nodes.add(1 / epsilon, static_cast<double>(counters.nodes) / kQueries);
    products.add(1 / epsilon, static_cast<double>(counters.dot_products) / kQueries);
  }
  table.add_order(kSize, std::move(points), 0.5 * (D - 1), 0.15);
  table.add_growth(kQuery, std::move(nodes), 0.2);
  table.add_growth(kQuery, std::move(products), 0.2);
}

/// Errors beyond epsilon over bodies of a few dozen to a few hundred points, each asked along `directions` directions,
/// half of them random where the body is fat.
template <int D>
void promises(const AryaSettings& settings, ClaimTable& table, int bodies, int directions) {
  std::mt19937_64 random(settings.seed + D);
  const Backend backend = settings.backend.value_or(Backend::kernel);
  const auto epsilon_of = [&](double share) {
    if (backend != Backend::macbeath) return std::pow(10.0, -0.3 - (D > 3 ? 0.7 : 2.7) * share);
    constexpr double kLeast = D == 2 ? 0.01 : D == 3 ? 0.1 : D == 4 ? 0.3 : 0.5;
    return kLeast * std::pow(0.9 / kLeast, share);
  };
  for (const Cloud kind :
       {Cloud::sphere, Cloud::ball, Cloud::box, Cloud::needle, Cloud::slab, Cloud::simplex, Cloud::cube}) {
    std::int64_t wrong = 0;
    double worst = 0;
    for (int b = 0; b < bodies; ++b) {
      const double epsilon = epsilon_of(std::abs(uniform(random)));
      const std::size_t n = 20 + random() % 200;
      const auto body = *Body<D>::from_points(cloud<D>(kind, n, random));
      const auto structure = *DirectionalWidth<D>::build(body, epsilon, backend);
      const dimension::Matrix<D> fat = body.sandwich().fattening().linear;
      QueryCounters counters;
      for (int i = 0; i < directions; ++i) {
        Vector<D> v = direction<D>(random);
        if (i % 2 == 0) v = fat.transpose() * v;
        double low = INFINITY, high = -INFINITY;
        for (const Vector<D>& p : body.points()) {
          low = std::min(low, v.dot(p));
          high = std::max(high, v.dot(p));
        }
        const auto answer = structure.width(v, counters);
        const double error = 1 - (answer.most.value - answer.least.value) / (high - low);
        worst = std::max(worst, error / epsilon);
        if (error > epsilon || answer.most.value > high || answer.least.value < low) ++wrong;
      }
    }
    const std::string name = fmt::format("{}, {}, d = {}", to_string(backend), to_string(kind), D);
    const std::string range = fmt::format("{} bodies, {} directions each", bodies, directions);
    table.add_value(kPromise, name, std::string(kWrongAnswers), range, static_cast<double>(wrong), 0);
    table.add_value(kPromise, name, "largest error / epsilon", range, worst, 1);
  }
}

}  // namespace

void measure_arya_sizes(const AryaSettings& settings, ClaimTable& table) {
  if (settings.full) {
    sizes<2>(settings, table, 1'000'000, {1e-1, 1e-2, 1e-3, 1e-4, 1e-5});
    sizes<3>(settings, table, 2'000'000, {1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4});
    sizes<4>(settings, table, 500'000, {1e-1, 5e-2, 2e-2, 1e-2});
    sizes<5>(settings, table, 200'000, {3e-1, 2e-1, 1e-1, 5e-2});
  } else {
    sizes<2>(settings, table, 100'000, {1e-1, 1e-2, 1e-3, 1e-4});
    sizes<3>(settings, table, 100'000, {1e-1, 3e-2, 1e-2, 3e-3});
    sizes<4>(settings, table, 50'000, {2e-1, 1e-1, 5e-2});
    sizes<5>(settings, table, 20'000, {4e-1, 3e-1, 2e-1});
  }
}

void measure_arya_promises(const AryaSettings& settings, ClaimTable& table) {
  // Over the families of `promises`.
  const int bodies = settings.pairs > 0 ? std::max(1, settings.pairs / 7) : settings.full ? 20'000 : 200;
  promises<2>(settings, table, bodies, 20);
  promises<3>(settings, table, bodies, 20);
  if (settings.backend == Backend::exact) return;  // of two and three dimensions
  promises<4>(settings, table, settings.full ? 300 : 10, 20);
  promises<5>(settings, table, settings.full ? 300 : 5, 20);
}

}  // namespace pd::bench
