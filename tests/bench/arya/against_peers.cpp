/// @file
/// [M] Theorem 3 against Qhull's hull, kernels against plain passes over the points, enclosing ellipsoids.
#include <fmt/format.h>

#include <array>
#include <functional>

#include "bench/agarwal/agarwal.hpp"
#include "bench/arya/arya.hpp"
#include "bench/arya/clouds.hpp"
#ifdef PD_BENCH_WITH_CGAL
#include "bench/arya/ellipsoid_peers.hpp"
#endif
#include "pd/dimension/approximate_width.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"
#include "pd/dimension/epsilon_kernel.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace pd::bench {

namespace {

using dimension::Body;
using dimension::Vector;

const Claim kWidth{"Theorem 3, width",
                   "width within epsilon, in a fraction of the time of Qhull's hull of the same points"};
const Claim kKernel{"Section 1.1, kernel of many points", "at most ten times a pass of 64 dot products a point"};
const Claim kEllipsoid{"Lemma 6, enclosing ellipsoid", "passes over the points do not grow with their number"};

/// Number of facets of Qhull's hull: what anybody needs before a width can be read off a hull.
template <int D>
std::int64_t qhull_facets(std::vector<double>& coordinates) {
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, stderr);
  char options[] = "qhull Qt";
  std::int64_t facets = -1;
  if (qh_new_qhull(qh, D, static_cast<int>(coordinates.size() / D), coordinates.data(), False, options, nullptr,
                   stderr) == 0) {
    facets = qh->num_facets;
  }
  qh_freeqhull(qh, qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(qh, &current, &total);
  return facets;
}

template <int D>
std::vector<double> flat(const std::vector<Vector<D>>& points) {
  std::vector<double> r;
  r.reserve(points.size() * D);
  for (const Vector<D>& p : points) r.insert(r.end(), p.data(), p.data() + D);
  return r;
}

template <int D>
void width_against_qhull(const AryaSettings& settings, ClaimTable& table, Cloud kind, std::size_t n, double epsilon,
                         std::optional<double> most, int rounds) {
  std::mt19937_64 random(settings.seed);
  const std::vector<Vector<D>> points = cloud<D>(kind, n, random);
  std::vector<double> coordinates = flat<D>(points);
  dimension::ApproximateWidth<D> width;
  // The copy into a body and its checks are ours; Qhull's copy is not counted against it either.
  const std::array<std::function<void()>, 2> tasks = {
      [&] { width = *dimension::approximate_width<D>(*Body<D>::from_points(points), epsilon); },
      [&] { (void)qhull_facets<D>(coordinates); }};
  const std::vector<double> times = least_times_ns(tasks, rounds, false);
  const std::string name = fmt::format("{}, d = {}, epsilon = {:g}", to_string(kind), D, epsilon);
  const std::string range = fmt::format("n = {}", n);
  table.add_value(kWidth, name, "upper / lower - 1, over epsilon", range, (width.upper / width.lower - 1) / epsilon, 1);
  table.add_value(kWidth, name, "time, ms", range, times[0] / 1e6);
  table.add_value(kWidth, name, "time / Qhull", range, times[0] / times[1], most);
  table.add_value(kWidth, name, std::string(kWrongAnswers), range, width.upper <= (1 + epsilon) * width.lower ? 0 : 1,
                  0);
}

#ifdef PD_BENCH_WITH_CGAL
/// The same accuracy asked of both: eta bounds our ratio over D, and CGAL's epsilon that of its lifted points, which
/// for the same number is the looser promise of the two.
void ellipsoid_against_cgal(const AryaSettings& settings, ClaimTable& table, Cloud kind) {
  constexpr double kEta = 1e-2;
  const std::size_t n = settings.full ? 1'000'000 : 50'000;
  std::mt19937_64 random(settings.seed);
  const std::vector<Vector<3>> points = cloud<3>(kind, n, random);
  double ratio = 0;
  PeerEllipsoid certified, plain;
  const std::array<std::function<void()>, 3> tasks = {
      [&] { ratio = dimension::enclosing_ellipsoid<3>(points, kEta)->sandwich.ratio; },
      [&] { certified = cgal_ellipsoid(points, kEta); }, [&] { plain = cgal_ellipsoid_in_doubles(points, kEta); }};
  const std::vector<double> times = least_times_ns(tasks, 3, false);
  const std::string name = fmt::format("{}, d = 3, eta = {:g}", to_string(kind), kEta);
  const std::string range = fmt::format("n = {}", n);
  const double broken = (ratio <= 3 * (1 + kEta) ? 0 : 1) + (certified.answered && plain.answered ? 0 : 1);
  table.add_value(kEllipsoid, name, "time, ms", range, times[0] / 1e6);
  table.add_value(kEllipsoid, name, "time / CGAL's", range, times[0] / times[1],
                  settings.full ? std::optional(1.0 / 40) : std::nullopt);
  table.add_value(kEllipsoid, name, "time / CGAL's in doubles, uncertified", range, times[0] / times[2]);
  table.add_value(kEllipsoid, name, std::string(kWrongAnswers), range, broken, 0);
}
#endif

/// The least that any algorithm of 64 directions does: the sum keeps the compiler honest.
template <int D>
double pass_of_64(const std::vector<Vector<D>>& points, const std::vector<Vector<D>>& directions) {
  std::array<double, 64> most{};
  for (const Vector<D>& p : points) {
    for (std::size_t k = 0; k < 64; ++k) most[k] = std::max(most[k], p.dot(directions[k]));
  }
  double sum = 0;
  for (const double m : most) sum += m;
  return sum;
}

void kernel_against_passes(const AryaSettings& settings, ClaimTable& table, Cloud kind, std::size_t n, double epsilon) {
  std::mt19937_64 random(settings.seed);
  const std::vector<Vector<3>> points = cloud<3>(kind, n, random);
  std::vector<Vector<3>> directions;
  for (int k = 0; k < 64; ++k) directions.push_back(direction<3>(random));
  double sum = 0;
  dimension::EpsilonKernel<3> kernel;
  // As a stream, in chunks, so that the points are all that is in memory.
  const auto stream = [&] {
    auto k = *dimension::EpsilonKernelStream<3>::create(epsilon);
    const std::span<const Vector<3>> all = points;
    constexpr std::size_t kChunk = 65536;
    for (std::size_t i = 0; i < n; i += kChunk) (void)k.survey(all.subspan(i, std::min(kChunk, n - i)));
    (void)k.end_survey();
    for (std::size_t i = 0; i < n; i += kChunk) k.select(all.subspan(i, std::min(kChunk, n - i)));
    kernel = k.finish();
  };
  const std::array<std::function<void()>, 2> tasks = {stream, [&] { sum += pass_of_64<3>(points, directions); }};
  const std::vector<double> times = least_times_ns(tasks, 3, false);
  const std::string name = fmt::format("{}, d = 3, epsilon = {:g}", to_string(kind), epsilon);
  const std::string range = fmt::format("n = {}", n);
  table.add_value(kKernel, name, "time / pass", range, sum > 0 ? times[0] / times[1] : NAN, 10);
  table.add_value(kKernel, name, "kernel points", range, static_cast<double>(kernel.indices.size()));
  table.add_value(kKernel, name, "cones visited a point", range,
                  static_cast<double>(kernel.cones_visited) / static_cast<double>(n));
}

void ellipsoids(const AryaSettings& settings, ClaimTable& table) {
  for (const Cloud kind : {Cloud::sphere, Cloud::box, Cloud::needle}) {
    Growth passes{std::string(to_string(kind)) + ", d = 3, eta = 0.01", "passes", "n"};
    for (std::size_t n = 1000; n <= (settings.full ? 1'000'000u : 64'000u); n *= 4) {
      std::mt19937_64 random(settings.seed);
      const auto e = dimension::enclosing_ellipsoid<3>(cloud<3>(kind, n, random), 0.01);
      passes.add(static_cast<double>(n), static_cast<double>(e->passes));
    }
    table.add_growth(kEllipsoid, std::move(passes), 0.2);
  }
#ifdef PD_BENCH_WITH_CGAL
  for (const Cloud kind : {Cloud::sphere, Cloud::ball, Cloud::needle}) ellipsoid_against_cgal(settings, table, kind);
#endif
}

}  // namespace

void measure_arya_kernels(const AryaSettings& settings, ClaimTable& table) {
  const std::size_t n = settings.full ? 10'000'000 : 300'000;
  for (const Cloud kind : {Cloud::sphere, Cloud::ball, Cloud::box}) {
    kernel_against_passes(settings, table, kind, n, 1e-2);
  }
  ellipsoids(settings, table);
}

void measure_arya_width(const AryaSettings& settings, ClaimTable& table) {
  const std::size_t n = settings.full ? 1'000'000 : 50'000;
  const double fine = settings.full ? 1e-3 : 1e-2;
  const auto target = [&](double most) { return settings.full ? std::optional(most) : std::nullopt; };
  width_against_qhull<3>(settings, table, Cloud::ball, n, fine, target(1.0 / 5), 3);
  width_against_qhull<3>(settings, table, Cloud::box, n, fine, target(1.0 / 3), 3);
  width_against_qhull<3>(settings, table, Cloud::sphere, n, fine, target(1.0 / 80), 3);
  if (settings.full) {
    width_against_qhull<4>(settings, table, Cloud::ball, n, 1e-2, target(1.0 / 6), 1);
    width_against_qhull<4>(settings, table, Cloud::sphere, 100'000, 1e-2, {}, 1);
    width_against_qhull<4>(settings, table, Cloud::sphere, n, 1e-2, target(1.0 / 100), 1);
  } else {
    width_against_qhull<4>(settings, table, Cloud::ball, 20'000, 5e-2, {}, 1);
  }
}

}  // namespace pd::bench
