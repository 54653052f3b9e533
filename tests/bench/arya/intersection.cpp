/// @file
/// [M] Theorem 1: intersection queries after preprocessing, their promise, and their time against GJK over hulls. The
/// hierarchy of Macbeath regions: nodes, degrees, visits.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>

#include "bench/agarwal/agarwal.hpp"
#include "bench/arya/arya.hpp"
#include "bench/arya/clouds.hpp"
#include "pd/dimension/approximate_intersection.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"
#include "pd/shape/convex_polytope.hpp"
#ifdef PD_BENCH_WITH_CCD
#include <ccd/ccd.h>
#endif

namespace pd::bench {

namespace {

using dimension::AffineMap;
using dimension::Backend;
using dimension::Body;
using dimension::ComposedBody;
using dimension::DirectionalWidth;
using dimension::Matrix;
using dimension::QueryCounters;
using dimension::Vector;

const Claim kTime{"Theorem 1, time", "intersection queries after preprocessing do not depend on n"};
const Claim kFlat{"Theorem 1, flatness", "intersection queries cost the same whatever n, within a tenth"};
const Claim kCalls{"Theorem 1, calls", "an intersection query takes O(polylog 1/epsilon) directional width queries"};
const Claim kTernary{"Lemmas 14 and 15",
                     "the nested ternary search takes O(log^(d-1) 1/epsilon) directional width queries"};
const Claim kPromise{"Theorem 1, promise", "yes where the bodies meet, no where the grown bodies do not"};
const Claim kNodes{"Lemma 5, nodes", "the hierarchy of Macbeath regions has O(1/epsilon^((d-1)/2)) nodes"};
/// The claim in the measure that a sphere's own caps have: caps of depth t are tan^-2 = (1 - t)^2 / (t (2 - t)) to the
/// power (d - 1) / 2, which is far from 1 / t before t is small. Epsilons within reach of memory are not.
const Claim kCaps{"Lemma 5, nodes by caps", "a sphere's hierarchy has as many nodes as caps epsilon / 2 deep cover it"};
const Claim kVisits{"Lemma 5, visits", "a descent visits O(log^2 1/epsilon) nodes"};
const Claim kSum{"Theorem 2, size", "approximate Minkowski sums have O(1/epsilon^((d-1)/2)) points"};
/// A facet at the distance 1 / (1 + epsilon / 2) from the centre of a unit sphere that it is inscribed to has the sine
/// of its cap's angle as circumradius: as many are needed as flat pieces of that size cover the sphere.
const Claim kSumCaps{"Theorem 2, size by caps", "a ball's sum has as many points as flat pieces within epsilon / 2"};

template <int D>
AffineMap<D> random_map(std::mt19937_64& random) {
  AffineMap<D> map;
  for (int k = 0; k < D; ++k) {
    Vector<D> v;
    do {
      v = direction<D>(random);
      for (int j = 0; j < k; ++j) v -= map.linear.col(j).normalized().dot(v) * map.linear.col(j).normalized();
    } while (!(v.norm() > 0.1));
    map.linear.col(k) = v.normalized() * (1 + 0.5 * uniform(random));
    map.translation[k] = 3 * uniform(random);
  }
  return map;
}

template <int D>
Vector<D> farthest(std::span<const Vector<D>> points, const AffineMap<D>& map, const Vector<D>& v) {
  const Vector<D> pulled = map.pull_back(v);
  const auto best = std::max_element(points.begin(), points.end(), [&](const Vector<D>& a, const Vector<D>& b) {
    return a.dot(pulled) < b.dot(pulled);
  });
  return map.apply(*best);
}

/// B is laid so that the truth needs no solver: with a common point just inside both tips, or beyond a slab that is
/// 1e-4 wider than what growing fills.
template <int D>
void promises(const AryaSettings& settings, ClaimTable& table, Backend backend, double epsilon, int bodies, int cases) {
  if (settings.backend.value_or(backend) != backend) return;
  std::mt19937_64 random(settings.seed + D);
  struct Prepared {
    Body<D> body;
    DirectionalWidth<D> structure;
  };
  std::vector<Prepared> pool;
  for (const Cloud kind :
       {Cloud::sphere, Cloud::ball, Cloud::box, Cloud::needle, Cloud::slab, Cloud::simplex, Cloud::cube}) {
    for (int k = 0; k < bodies; ++k) {
      const auto body = *Body<D>::from_points(cloud<D>(kind, 20 + random() % 200, random));
      pool.push_back({body, *DirectionalWidth<D>::build(body, epsilon / 4, backend)});
    }
  }
  std::int64_t wrong = 0, refused = 0, most = 0;
  for (int k = 0; k < cases; ++k) {
    const Prepared& a = pool[random() % pool.size()];
    const Prepared& b = pool[random() % pool.size()];
    const AffineMap<D> place_a = random_map<D>(random);
    AffineMap<D> place_b = random_map<D>(random);
    const Vector<D> v = direction<D>(random);
    const Vector<D> tip_a = farthest<D>(a.body.points(), place_a, v);
    const Vector<D> tip_b = farthest<D>(b.body.points(), place_b, -v);
    const bool meets = k % 2 == 0;
    if (meets) {
      const double inwards = std::pow(10.0, -9 * std::abs(uniform(random)));
      const Vector<D> other_a = place_a.apply(a.body.points()[random() % a.body.points().size()]);
      const Vector<D> other_b = place_b.apply(b.body.points()[random() % b.body.points().size()]);
      place_b.translation += tip_a + inwards * (other_a - tip_a) - (tip_b + inwards * (other_b - tip_b));
    } else {
      const double width = (tip_a - farthest<D>(a.body.points(), place_a, -v)).dot(v) +
                           (farthest<D>(b.body.points(), place_b, v) - tip_b).dot(v);
      const double size = tip_a.norm() + tip_b.norm() + width;
      place_b.translation += tip_a + (0.5 * epsilon * width * (1 + 1e-4) + 1e-15 * size) * v - tip_b;
    }
    const std::array<ComposedBody<D>, 2> pair = {*ComposedBody<D>::of(a.structure, place_a),
                                                 *ComposedBody<D>::of(b.structure, place_b)};
    const auto answer = dimension::approximate_intersection<D>(pair, epsilon);
    refused += answer ? 0 : 1;
    if (!answer) continue;
    wrong += answer->intersect != meets;
    most = std::max(most, answer->support_calls);
  }
  const std::string name = fmt::format("{}, d = {}, epsilon = {:g}", to_string(backend), D, epsilon);
  const std::string range = fmt::format("{} pairs of {} bodies", cases, pool.size());
  table.add_value(kPromise, name, std::string(kWrongAnswers), range, static_cast<double>(wrong), 0);
  table.add_value(kPromise, name, "refused", range, static_cast<double>(refused), 0);
  table.add_value(kPromise, name, "most support calls", range, static_cast<double>(most));
}

/// Two round bodies, one moved from deep inside the other to a gap of .3 of their size, in steps.
constexpr int kGaps = 101;
/// All places again and again, so that none of the solvers is measured on what the one before it left in the caches: a
/// hull of 1e6 points leaves nothing there, and what ours fetch weighs in a few passes.
constexpr int kPasses = 3;
constexpr int kOwnPasses = 60;
/// Places for counts alone: a query takes one to dozens of support calls, and over few places their mean depends on
/// which points the clouds have there.
constexpr int kCounted = 20'000;
Vector<3> aside(int k, int count, std::mt19937_64& random) {
  return (2 + 2 * 0.3 * (2.0 * k / (count - 1) - 1)) * direction<3>(random);
}

#ifdef PD_BENCH_WITH_CCD
/// The vertices of a hull, their neighbours, and a few of them to begin a climb at.
struct ClimbingHull {
  const ConvexPolytope* hull;
  std::vector<std::int32_t> first, neighbours, starts;
  Vec3 translation = Vec3::Zero();

  ClimbingHull(const ConvexPolytope& polytope, int samples) : hull(&polytope) {
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const auto loop = polytope.facet_vertices(f);
      for (std::size_t i = 0; i < loop.size(); ++i) edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
    }
    std::sort(edges.begin(), edges.end());
    first.assign(static_cast<std::size_t>(polytope.num_vertices()) + 1, 0);
    for (const auto& [from, to] : edges) {
      ++first[static_cast<std::size_t>(from) + 1];
      neighbours.push_back(to);
    }
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    for (int k = 0; k < samples; ++k) {
      starts.push_back(static_cast<std::int32_t>(static_cast<std::int64_t>(polytope.num_vertices()) * k / samples));
    }
  }

  [[nodiscard]] std::int32_t climb(const Vec3& d) const {
    std::int32_t at = starts[0];
    double reach = hull->vertex(at).dot(d);
    const auto consider = [&](std::int32_t v) {
      const double value = hull->vertex(v).dot(d);
      if (value <= reach) return false;
      reach = value;
      at = v;
      return true;
    };
    for (const std::int32_t v : starts) consider(v);
    for (bool up = true; up;) {
      up = false;
      const auto here = static_cast<std::size_t>(at);
      for (std::int32_t i = first[here]; i < first[here + 1]; ++i) {
        up = consider(neighbours[static_cast<std::size_t>(i)]) || up;
      }
    }
    return at;
  }
};

void climbing_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& hull = *static_cast<const ClimbingHull*>(object);
  const Vec3 p = hull.hull->vertex(hull.climb({direction->v[0], direction->v[1], direction->v[2]})) + hull.translation;
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

void gjk(ClimbingHull& a, ClimbingHull& b, const std::vector<Vector<3>>& places, std::int64_t& meets) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = climbing_support;
  ccd.max_iterations = 1000;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (const Vector<3>& place : places) {
      b.translation = place;
      meets += ccdGJKIntersect(&a, &b, &ccd);
    }
  }
}
#endif

void times(const AryaSettings& settings, ClaimTable& table) {
  constexpr double kEpsilon = 1e-3;
  const std::string spheres = "two spheres' points, d = 3, epsilon = 0.001";
  Growth growth{spheres, "time a query, ns", "n"};
  Growth supports{spheres, "support calls a query", "n"};
  Growth nodes{spheres, "kernel vertices visited a query", "n"};
  Growth products{spheres, "dot products a query", "n"};
  for (const std::size_t n : settings.full ? std::vector<std::size_t>{10'000, 100'000, 1'000'000}
                                           : std::vector<std::size_t>{10'000, 40'000}) {
    std::mt19937_64 random(settings.seed);
    const auto points_a = cloud<3>(Cloud::sphere, n, random);
    const auto points_b = cloud<3>(Cloud::sphere, n, random);
    const auto prepared = [&](const std::vector<Vector<3>>& points) {
      return *DirectionalWidth<3>::build(*Body<3>::from_points(points), kEpsilon / 4);
    };
    const DirectionalWidth<3> a = prepared(points_a), b = prepared(points_b);
    std::mt19937_64 same_for_all(settings.seed);
    std::int64_t calls = 0;
    QueryCounters counters;
    for (int k = 0; k < kCounted; ++k) {
      AffineMap<3> map;
      map.translation = aside(k, kCounted, same_for_all);
      const std::array<ComposedBody<3>, 2> pair = {*ComposedBody<3>::of(a), *ComposedBody<3>::of(b, map)};
      const auto answer = *dimension::approximate_intersection<3>(pair, kEpsilon);
      calls += answer.support_calls;
      counters.nodes += answer.counters.nodes;
      counters.dot_products += answer.counters.dot_products;
    }
    std::vector<Vector<3>> places;
    for (int k = 0; k < kGaps; ++k) places.push_back(aside(k, kGaps, same_for_all));
    std::vector<std::array<ComposedBody<3>, 2>> pairs;
    for (const Vector<3>& place : places) {
      AffineMap<3> map;
      map.translation = place;
      pairs.push_back({*ComposedBody<3>::of(a), *ComposedBody<3>::of(b, map)});
    }
    std::int64_t ours = 0;
    std::vector<std::function<void()>> tasks = {[&] {
      ours = 0;
      for (int pass = 0; pass < kOwnPasses; ++pass) {
        for (const auto& pair : pairs) {
          ours += dimension::approximate_intersection<3>(pair, kEpsilon)->intersect;
        }
      }
    }};
#ifdef PD_BENCH_WITH_CCD
    const auto polytope = [](const std::vector<Vector<3>>& points) {
      return *ConvexPolytope::from_points(std::vector<Vec3>(points.begin(), points.end()));
    };
    const ConvexPolytope hull_a = polytope(points_a), hull_b = polytope(points_b);
    ClimbingHull climb_a(hull_a, 1), climb_b(hull_b, 1), sampled_a(hull_a, 64), sampled_b(hull_b, 64);
    std::int64_t climbed = 0, sampled = 0;
    tasks.emplace_back([&] { gjk(climb_a, climb_b, places, climbed = 0); });
    tasks.emplace_back([&] { gjk(sampled_a, sampled_b, places, sampled = 0); });
#endif
    const std::vector<double> least = least_times_ns(tasks, 7);
    const auto size = static_cast<double>(n);
    const double own = least[0] / (kGaps * kOwnPasses);
    growth.add(size, own);
    supports.add(size, static_cast<double>(calls) / kCounted);
    nodes.add(size, static_cast<double>(counters.nodes) / kCounted);
    products.add(size, static_cast<double>(counters.dot_products) / kCounted);
    const std::string range = fmt::format("n = {}", n);
    table.add_value(kTime, "d = 3, epsilon = 0.001", "time a query, us", range, own / 1e3);
    table.add_value(kTime, "d = 3, epsilon = 0.001", "kernel points of one body", range,
                    static_cast<double>(a.size().points));
#ifdef PD_BENCH_WITH_CCD
    table.add_value(kTime, "d = 3, epsilon = 0.001", "time / libccd's GJK with a climb", range,
                    own * kGaps * kPasses / least[1],
                    settings.full && n == 1'000'000 ? std::optional(0.01) : std::nullopt);
    table.add_value(kTime, "d = 3, epsilon = 0.001", "time / GJK with a climb from 64 samples", range,
                    own * kGaps * kPasses / least[2],
                    settings.full && n == 1'000'000 ? std::optional(0.1) : std::nullopt);
    table.add_value(kTime, "d = 3, epsilon = 0.001", std::string(kWrongAnswers), range,
                    static_cast<double>(std::abs(climbed - sampled) +
                                        std::max<std::int64_t>(climbed - ours / kOwnPasses * kPasses, 0)),
                    0);
#endif
  }
  for (Growth* g : {&growth, &supports, &nodes, &products}) {
    const auto [least, most] = std::minmax_element(g->y.begin(), g->y.end());
    table.add_value(kFlat, g->family, g->counter + ", most / least",
                    fmt::format("n = {}..{}", g->x.front(), g->x.back()), *most / *least,
                    settings.full || g != &growth ? std::optional(1.1) : std::nullopt);
    table.add_growth(kTime, std::move(*g), 0.1);
  }
}

/// Support calls of queries at places about touching, in the mean, over exact structures.
template <int D>
void calls(const AryaSettings& settings, ClaimTable& table, int cases, dimension::IntersectionSearch search,
           double least_epsilon) {
  const bool ternary = search == dimension::IntersectionSearch::nested_ternary;
  Growth growth{fmt::format("balls' points, d = {}", D), "support calls a query, exact structures",
                ternary ? "log2 1 / epsilon" : "1 / epsilon"};
  for (double epsilon = 0.1; epsilon > 0.99 * least_epsilon; epsilon /= 10) {
    std::mt19937_64 random(settings.seed);
    const auto a =
        *DirectionalWidth<D>::build(*Body<D>::from_points(cloud<D>(Cloud::ball, 300, random)), 0.5, Backend::exact);
    std::int64_t count = 0;
    for (int k = 0; k < cases; ++k) {
      AffineMap<D> map;
      const auto unit = direction<D>(random);
      map.translation = (1.6 + 0.4 * uniform(random)) * unit;
      const std::array<ComposedBody<D>, 2> pair = {*ComposedBody<D>::of(a), *ComposedBody<D>::of(a, map)};
      count += dimension::approximate_intersection<D>(pair, epsilon, search)->support_calls;
    }
    growth.add(ternary ? std::log2(1 / epsilon) : 1 / epsilon, static_cast<double>(count) / cases);
  }
  table.add_growth(ternary ? kTernary : kCalls, std::move(growth), ternary ? D - 1 : 0.2);
}

template <int D>
void hierarchy(const AryaSettings& settings, ClaimTable& table, std::size_t n, std::initializer_list<double> epsilons) {
  std::mt19937_64 random(settings.seed);
  const auto body = *Body<D>::from_points(cloud<D>(Cloud::sphere, n, random));
  const std::string name = fmt::format("sphere, d = {}", D);
  Growth nodes{name, "nodes", "1 / epsilon"};
  Growth caps{name, "nodes", "1 / tan^2 of a cap's angle"};
  Growth visits{name, "nodes visited a query", "log2 1 / epsilon"};
  std::vector<std::pair<std::string, double>> shares;
  for (const double epsilon : epsilons) {
    const auto structure = DirectionalWidth<D>::build(body, epsilon, Backend::macbeath);
    if (!structure) continue;
    QueryCounters counters;
    constexpr int kQueries = 1000;
    for (int i = 0; i < kQueries; ++i) (void)structure->support(direction<D>(random), counters);
    nodes.add(1 / epsilon, static_cast<double>(structure->size().nodes));
    const double depth = epsilon / 2;
    caps.add((1 - depth) * (1 - depth) / (depth * (2 - depth)), static_cast<double>(structure->size().nodes));
    visits.add(std::log2(1 / epsilon), static_cast<double>(counters.nodes) / kQueries);
    const std::string range = fmt::format("epsilon = {:g}", epsilon);
    table.add_value(kNodes, name, "largest out-degree", range, static_cast<double>(structure->size().max_out_degree));
    table.add_value(kNodes, name, "layers", range, static_cast<double>(structure->size().depth));
    shares.emplace_back(range,
                        static_cast<double>(counters.nodes) / kQueries / static_cast<double>(structure->size().nodes));
  }
  table.add_order(kNodes, std::move(nodes), 0.5 * (D - 1), 0.15);
  table.add_order(kCaps, std::move(caps), 0.5 * (D - 1), 0.15);
  table.add_growth(kVisits, std::move(visits), 2);
  for (const auto& [range, share] : shares) table.add_value(kVisits, name, "share of the nodes visited", range, share);
}

template <int D>
void sums(const AryaSettings& settings, ClaimTable& table, std::size_t n, std::initializer_list<double> epsilons) {
  std::mt19937_64 random(settings.seed);
  const auto a = *Body<D>::from_points(cloud<D>(Cloud::sphere, n, random));
  const auto b = *Body<D>::from_points(cloud<D>(Cloud::sphere, n, random));
  const std::string name = fmt::format("two spheres' points, d = {}", D);
  Growth points{name, "points of the sum", "1 / epsilon"};
  Growth caps{name, "points of the sum", "1 / sin^2 of a cap's angle"};
  for (const double epsilon : epsilons) {
    const auto leaf = [&](const Body<D>& body) {
      return *ComposedBody<D>::of(*DirectionalWidth<D>::build(body, epsilon / 4));
    };
    const auto sum = dimension::approximate_minkowski_sum<D>(*ComposedBody<D>::sum_of({leaf(a), leaf(b)}), epsilon,
                                                             dimension::Representation::points);
    points.add(1 / epsilon, static_cast<double>(sum->vertices));
    const double cosine = 1 / (1 + epsilon / 2);
    caps.add(1 / (1 - cosine * cosine), static_cast<double>(sum->vertices));
  }
  table.add_order(kSum, std::move(points), 0.5 * (D - 1), 0.15);
  table.add_order(kSumCaps, std::move(caps), 0.5 * (D - 1), 0.15);
}

}  // namespace

void measure_arya_intersection(const AryaSettings& settings, ClaimTable& table) {
  const int pairs = settings.pairs > 0 ? settings.pairs : settings.full ? 100'000 : 1000;
  const int many = settings.full ? 100 : 2, few = settings.full ? 43 : 1;  // of each family: 301 bodies in all
  for (const double epsilon : {0.1, 1e-3}) {
    for (const Backend backend : {Backend::kernel, Backend::exact}) {
      promises<2>(settings, table, backend, epsilon, many, pairs);
      promises<3>(settings, table, backend, epsilon, many, pairs);
    }
  }
  promises<4>(settings, table, Backend::kernel, 0.1, few, settings.full ? 3000 : 300);
  promises<5>(settings, table, Backend::kernel, 0.3, few, settings.full ? 3000 : 300);
  promises<2>(settings, table, Backend::macbeath, 0.05, many, pairs);
  promises<3>(settings, table, Backend::macbeath, 0.5, many, pairs);
  promises<4>(settings, table, Backend::macbeath, 0.8, few, settings.full ? 3000 : 300);
  if (settings.full) promises<5>(settings, table, Backend::macbeath, 0.95, few, 3000);
}

void measure_arya_queries(const AryaSettings& settings, ClaimTable& table) {
  constexpr auto kCuts = dimension::IntersectionSearch::cutting_planes;
  constexpr auto kThirds = dimension::IntersectionSearch::nested_ternary;
  calls<2>(settings, table, 400, kCuts, 1e-5);
  calls<3>(settings, table, 400, kCuts, 1e-5);
  calls<4>(settings, table, 400, kCuts, 1e-5);
  calls<5>(settings, table, 400, kCuts, 1e-5);
  calls<2>(settings, table, 400, kThirds, 1e-5);
  calls<3>(settings, table, 20, kThirds, 1e-4);
  if (settings.full) calls<4>(settings, table, 4, kThirds, 1e-2);
  times(settings, table);
}

void measure_arya_macbeath(const AryaSettings& settings, ClaimTable& table) {
  if (settings.full) {
    hierarchy<2>(settings, table, 200'000, {1e-1, 1e-2, 1e-3, 1e-4});
    hierarchy<3>(settings, table, 100'000, {1e-1, 3e-2, 1e-2, 3e-3});
    hierarchy<4>(settings, table, 300'000, {0.1, 0.07, 0.05, 0.03, 0.02});
    hierarchy<5>(settings, table, 200'000, {0.3, 0.2, 0.15, 0.1, 0.07, 0.05});
  } else {
    hierarchy<2>(settings, table, 50'000, {1e-1, 1e-2, 1e-3});
    hierarchy<3>(settings, table, 20'000, {2e-1, 1e-1, 5e-2});
    hierarchy<4>(settings, table, 5'000, {0.2, 0.1, 0.05});
  }
}

void measure_arya_sums(const AryaSettings& settings, ClaimTable& table) {
  sums<2>(settings, table, 100'000, {1e-1, 1e-2, 1e-3, 1e-4});
  sums<3>(settings, table, settings.full ? 1'000'000 : 50'000, {1e-1, 3e-2, 1e-2});
  if (settings.full) sums<4>(settings, table, 200'000, {1e-1, 5e-2, 3e-2, 2e-2});
  if (settings.full) sums<5>(settings, table, 200'000, {3e-1, 2e-1, 1.5e-1, 1e-1, 7e-2, 5e-2});
}

}  // namespace pd::bench
