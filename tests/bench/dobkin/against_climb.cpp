/// @file
/// Support queries and directional depth of large polytopes beside the sampled climb, and of small ones beside the hull
/// of all pairwise sums.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "bench/dobkin/dobkin.hpp"
#include "bench/dobkin/sum_hulls.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::bench {

namespace {

const Claim kSupport{"Fact 5.1, support", "support of a large polytope beside the sampled climb"};
const Claim kDepth{"Theorem 5.6, time", "directional depth beside support queries and beside the whole difference"};

/// Hulls of every 8th, 64th, ... vertex, and hill climbing in each from the best of the one above: the structure that
/// is usual where there is no hierarchy.
class SampledClimb {
 public:
  SampledClimb(const ConvexPolytope& polytope, scenes::Random& random) {
    std::vector<std::int32_t> ids(static_cast<std::size_t>(polytope.num_vertices()));
    std::iota(ids.begin(), ids.end(), 0);
    levels_.push_back({polytope, {}});
    while (ids.size() > 64) {
      for (std::size_t i = ids.size(); i > 1; --i) {
        std::swap(ids[i - 1], ids[static_cast<std::size_t>(random.next() % i)]);
      }
      ids.resize(ids.size() / 8);
      std::vector<Vec3> points;
      for (const std::int32_t id : ids) points.push_back(polytope.vertex(id));
      const ConvexPolytope hull = ConvexPolytope::from_points(points).value();
      Level level{hull, {}};
      for (int v = 0; v < hull.num_vertices(); ++v) {
        level.in_whole.push_back(ids[static_cast<std::size_t>(hull.caller_id(v))]);
      }
      // From the level below to this one: where the vertices of this one stand there.
      std::vector<std::int32_t> place(static_cast<std::size_t>(polytope.num_vertices()), -1);
      const Level& below = levels_.back();
      for (int v = 0; v < below.hull.num_vertices(); ++v) place[static_cast<std::size_t>(whole(below, v))] = v;
      for (const std::int32_t v : level.in_whole) level.below.push_back(place[static_cast<std::size_t>(v)]);
      levels_.push_back(std::move(level));
    }
  }
  [[nodiscard]] int support(const Vec3& direction) const {
    int v = 0;
    for (std::size_t l = levels_.size(); l-- > 0;) {
      const ConvexPolytope& hull = levels_[l].hull;
      double best = direction.dot(hull.vertex(v));
      for (bool better = true; better;) {
        better = false;
        for (const std::int32_t n : hull.neighbours(v)) {
          const double value = direction.dot(hull.vertex(n));
          if (value <= best) continue;
          best = value;
          v = n;
          better = true;
          break;
        }
      }
      if (l > 0) v = levels_[l].below[static_cast<std::size_t>(v)];
    }
    return v;
  }

 private:
  struct Level {
    ConvexPolytope hull;
    std::vector<std::int32_t> in_whole = {};  ///< per vertex; empty at the whole polytope
    std::vector<std::int32_t> below = {};     ///< its number one level finer
  };
  static std::int32_t whole(const Level& level, int v) {
    return level.in_whole.empty() ? v : level.in_whole[static_cast<std::size_t>(v)];
  }
  std::vector<Level> levels_;
};

std::vector<Vec3> directions_of(int count, scenes::Random& random) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) directions.push_back(random.direction());
  return directions;
}

/// Walks through more memory than a core's caches hold.
class CacheFlush {
 public:
  CacheFlush() : bytes_(std::size_t{96} << 20) {}

  /// Mean nanoseconds of a call on cold caches.
  template <class Call>
  [[nodiscard]] double cold_mean_ns(const std::vector<Vec3>& directions, const Call& call) {
    double sum = 0;
    for (const Vec3& d : directions) {
      for (std::size_t i = 0; i < bytes_.size(); i += 64) bytes_[i] = static_cast<char>(bytes_[i] + 1);
      const auto begin = Clock::now();
      call(d);
      sum += elapsed_ns(begin, Clock::now());
    }
    return sum / static_cast<double>(directions.size());
  }

 private:
  std::vector<char> bytes_;
};

struct ClimbTime {
  std::string range;
  double cold_ns;
};

/// A direction that moves by a thousandth between queries, each with the certificate of the one before.
void measure_warm_start(const PosedShape& a, const PosedShape& b, const std::vector<Vec3>& directions,
                        const ClimbTime& climb, CacheFlush& flush, scenes::Random& random, ClaimTable& table) {
  Scratch scratch;
  std::vector<DirectionalCertificate> certificates(directions.size());
  const auto ask = [&](const Vec3& d, DirectionalCertificate& c) {
    return directional_depth(a, b, d, scratch, DirectionalMethod::portal, nullptr, &c).value().depth;
  };
  double sum = 0, least = HUGE_VAL;
  const auto prepare = [&] {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      sum += ask(directions[i] + 1e-3 * random.direction(), certificates[i]);
    }
  };
  for (int repeat = 0; repeat < 5; ++repeat) {
    prepare();
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < directions.size(); ++i) sum += ask(directions[i], certificates[i]);
    least = std::min(least, elapsed_ns(begin, Clock::now()) / static_cast<double>(directions.size()));
  }
  prepare();
  std::size_t next = 0;
  const double cold = flush.cold_mean_ns(directions, [&](const Vec3& d) { sum += ask(d, certificates[next++]); });
  if (sum < 0) std::abort();
  table.add_value(kDepth, "balls", "portal, from the last direction's: ns", climb.range, least);
  table.add_value(kDepth, "balls", "portal, from the last direction's: warm / cold support", climb.range,
                  least / climb.cold_ns, 2);
  table.add_value(kDepth, "balls", "portal, from the last direction's: cold / cold support", climb.range,
                  cold / climb.cold_ns, 8);
}

void measure_large(const DobkinSettings& settings, ClaimTable& table) {
  const int n = settings.full ? 1 << 20 : 1 << 14;
  scenes::Random random(settings.seed);
  const ConvexPolytope p = ConvexPolytope::from_points(scenes::sphere_hull(n, random)).value();
  const ConvexPolytope q = ConvexPolytope::from_points(scenes::sphere_hull(n, random)).value();
  const SampledClimb climb(p, random);
  const std::vector<Vec3> directions = directions_of(2000, random);
  double sum = 0;
  const auto by_climb = [&](const Vec3& d) { sum += climb.support(d); };
  const double climbing = least_mean_ns(directions, 5, by_climb);
  const double supports = least_mean_ns(directions, 5, [&](const Vec3& d) { sum += detail::support_vertex(p, d, -1); });
  const std::string range = fmt::format("n = {}", n), title = "balls";
  table.add_value(kSupport, title, "support, ns", range, supports);
  table.add_value(kSupport, title, "sampled climb, ns", range, climbing);
  table.add_value(kSupport, title, "support / sampled climb", range, supports / climbing, 0.7);

  const PolyhedralHierarchy hp = PolyhedralHierarchy::build(p, HierarchyKind::inner).value();
  const PolyhedralHierarchy hq = PolyhedralHierarchy::build(q, HierarchyKind::inner).value();
  const DirectionalHierarchies both{&hp, &hq};
  const ConvexShape a(p), b(q);
  const Pose moved = Pose::from_quaternion(random.quaternion(), Vec3(0.2, -0.1, 0.3)).value();
  const PosedShape posed_a{&a, moved}, posed_b{&b, Pose()};
  Scratch scratch;
  CacheFlush flush;
  const std::vector<Vec3> few(directions.begin(), directions.begin() + 60);
  const double cold_climb = flush.cold_mean_ns(few, by_climb);
  table.add_value(kDepth, title, "cold support by sampled climb, ns", range, cold_climb);
  for (const auto& [method, name] :
       {std::pair{DirectionalMethod::hierarchy, "hierarchies"}, std::pair{DirectionalMethod::portal, "portal"}}) {
    const auto ask = [&, m = method](const Vec3& d) {
      sum += directional_depth(posed_a, posed_b, d, scratch, m, &both).value().depth;
    };
    const double warm = least_mean_ns(few, 5, ask);
    const double cold = flush.cold_mean_ns(few, ask);
    table.add_value(kDepth, title, fmt::format("{}: warm, ns", name), range, warm);
    table.add_value(kDepth, title, fmt::format("{}: warm / cold support", name), range, warm / cold_climb, 2);
    table.add_value(kDepth, title, fmt::format("{}: cold / cold support", name), range, cold / cold_climb, 8);
  }
  measure_warm_start(posed_a, posed_b, few, {range, cold_climb}, flush, random, table);
  if (sum < 0) std::abort();
}

/// All b - a.
std::vector<Vec3> differences(const ConvexPolytope& p, const ConvexPolytope& q) {
  std::vector<Vec3> points;
  for (int i = 0; i < p.num_vertices(); ++i) {
    for (int k = 0; k < q.num_vertices(); ++k) points.push_back(q.vertex(k) - p.vertex(i));
  }
  return points;
}

void measure_small(const DobkinSettings& settings, ClaimTable& table) {
  const int n = settings.full ? 512 : 128;
  scenes::Random random(settings.seed + 3);
  const ConvexPolytope p = ConvexPolytope::from_points(scenes::sphere_hull(n, random)).value();
  const ConvexPolytope q = ConvexPolytope::from_points(scenes::sphere_hull(n, random)).value();
  const ConvexShape a(p), b(q);
  const PosedShape posed_a{&a, Pose()}, posed_b{&b, Pose()};
  Scratch scratch;
  double sum = 0;
  const double ours = least_mean_ns(directions_of(500, random), 5, [&](const Vec3& d) {
    sum += directional_depth(posed_a, posed_b, d, scratch).value().depth;
  });
  if (sum < 0) std::abort();
  const std::string range = fmt::format("n = m = {}", n);
  const std::vector<Vec3> points = differences(p, q);
  const TimedHull by_qhull = qhull_hull(points);
  table.add_value(kDepth, "balls", "portal, ns", range, ours);
  table.add_value(kDepth, "balls", "time / Qhull's hull of pairwise sums", range, ours * 1e-9 / by_qhull.seconds, 0.01);
#ifdef PD_BENCH_WITH_CGAL
  const TimedHull by_cgal = cgal_hull(points);
  table.add_value(kDepth, "balls", "time / CGAL's hull of pairwise sums", range, ours * 1e-9 / by_cgal.seconds, 0.01);
  table.add_value(kDepth, "balls", "vertices of CGAL's hull less Qhull's", range, by_cgal.vertices - by_qhull.vertices);
#endif
}

}  // namespace

void measure_against_climb(const DobkinSettings& settings, ClaimTable& table) {
  measure_small(settings, table);
  measure_large(settings, table);
}

}  // namespace pd::bench
