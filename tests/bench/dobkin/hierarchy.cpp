/// @file
/// [D] Theorem 5.6: steps of the descent over n and m apart from each other. Fact 5.1 and Lemma 5.2: the outer
/// hierarchies of all inner levels, their sizes and lines by them.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "bench/dobkin/dobkin.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/level_queries.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

namespace {

const Claim kDescent{"Theorem 5.6", "directional depth of two polytopes by their hierarchies in O(log n log m) steps"};
const Claim kLines{"Lemma 5.2", "a line against any inner level by that level's outer hierarchy in O(log n) steps"};
const Claim kMemory{"Fact 5.1", "hierarchies have O(n) size and O(log n) levels"};

enum class Family { ball, needle, prism, roof };

ConvexPolytope body(Family family, int n, scenes::Random& random) {
  const auto points = [&] {
    switch (family) {
      case Family::ball:
        return scenes::sphere_hull(n, random);
      case Family::needle:
        return scenes::needle(n, random);
      case Family::prism:
        return scenes::prism(n);
      case Family::roof:
        break;
    }
    return scenes::roof(std::max(n, 10), {}, random);
  };
  return *ConvexPolytope::from_points(points());
}

struct Prepared {
  ConvexPolytope body;
  PolyhedralHierarchy inner;
};

/// 8, and the powers of 4 from 16 on.
std::vector<int> sizes_up_to(int most) {
  std::vector<int> sizes{8};
  for (int n = 16; n <= most; n *= 4) sizes.push_back(n);
  return sizes;
}

std::vector<Prepared> prepare(Family family, const std::vector<int>& sizes, scenes::Random& random) {
  std::vector<Prepared> all;
  for (const int n : sizes) {
    const ConvexPolytope p = body(family, n, random);
    all.push_back({p, PolyhedralHierarchy::build(p, HierarchyKind::inner).value()});
  }
  return all;
}

struct Counted {
  double steps = 0;  ///< of the worst direction found
  double certificate = 0;
  std::int64_t repairs = 0;
  int wrong = 0;
};

/// Random directions, and from the worst of them a climb by smaller and smaller turns.
template <class Ask>
Vec3 worst_direction(scenes::Random& random, const Ask& steps_of) {
  Vec3 worst = Vec3::UnitX();
  double most = 0;
  const auto ask = [&](const Vec3& d) {
    const double steps = steps_of(d);
    if (steps <= most) return;
    most = steps;
    worst = d;
  };
  for (int i = 0; i < 40; ++i) ask(random.direction());
  for (int i = 0; i < 40; ++i) ask((worst + std::ldexp(1.0, -1 - i / 4) * random.direction()).normalized());
  return worst;
}

Counted worst_of(const Prepared& p, const Prepared& q, scenes::Random& random) {
  const ConvexShape a(p.body), b(q.body);
  const DirectionalHierarchies hierarchies{&p.inner, &q.inner};
  const Pose turned = random.pose(Vec3(0.001, 0.002, -0.001));
  const PosedShape posed_a{&a, turned}, posed_b{&b, Pose()};
  Scratch scratch;
  Counted counted;
  const Vec3 worst = worst_direction(random, [&](const Vec3& d) {
    const auto found = directional_depth(posed_a, posed_b, d, scratch, DirectionalMethod::hierarchy, &hierarchies);
    counted.certificate = std::max(counted.certificate, static_cast<double>(found->descent.certificate));
    counted.repairs += found->descent.repairs;
    counted.steps = std::max(counted.steps, static_cast<double>(found->descent.steps));
    return static_cast<double>(found->descent.steps);
  });
  for (int i = 0; i < 10; ++i) {
    const Vec3 d = i == 0 ? worst : random.direction();
    const auto found = directional_depth(posed_a, posed_b, d, scratch, DirectionalMethod::hierarchy, &hierarchies);
    const auto expected = directional_depth(posed_a, posed_b, d, scratch);
    counted.wrong += found->lower != expected->lower || found->upper != expected->upper ? 1 : 0;
  }
  return counted;
}

/// Least squares of log steps = c + a log log2 n + b log log2 m over all pairs of sizes: a and b.
std::array<double, 2> powers_of_logarithms(const std::vector<std::array<double, 3>>& points) {
  Eigen::MatrixXd x(points.size(), 3);
  Eigen::VectorXd y(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    x.row(row) << 1, std::log(points[i][0]), std::log(points[i][1]);
    y[row] = std::log(points[i][2]);
  }
  const Eigen::VectorXd fit = x.colPivHouseholderQr().solve(y);
  return {fit[1], fit[2]};
}

/// Every size against every size.
void measure_descents(const std::string& name, const std::vector<Prepared>& all, const std::vector<int>& sizes,
                      scenes::Random& random, ClaimTable& table) {
  Counted sum;
  std::vector<std::array<double, 3>> points;
  const std::size_t large = all.size() - 2;
  for (std::size_t j = 0; j <= all.size(); ++j) {
    const bool equal = j == all.size();
    const std::string title = equal ? name + ", m = n" : fmt::format("{}, m = {}", name, sizes[j]);
    Growth plain{title, "steps", "n"}, share{title, "steps / (log2 n log2 m)", "n"};
    Growth certificate{title, "edges in the final check", "n"};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const int n = sizes[i], m = sizes[equal ? i : j];
      const Counted c = worst_of(all[i], all[equal ? i : j], random);
      plain.add(n, c.steps);
      share.add(n, c.steps / (std::log2(n) * std::log2(m)));
      certificate.add(n, c.certificate);
      if (!equal) points.push_back({std::log2(n), std::log2(m), c.steps});
      sum.wrong += c.wrong;
      sum.repairs += c.repairs;
    }
    if (!equal && j != 1 && j != large) continue;
    table.add_growth(kDescent, std::move(plain));
    table.add_growth(kDescent, std::move(share), 0.1);
    table.add_growth(kDescent, std::move(certificate));
  }
  const std::string range = fmt::format("n, m = 8..{}", sizes.back());
  const auto [of_n, of_m] = powers_of_logarithms(points);
  table.add_value(kDescent, name, "steps, power of log2 n", range, of_n, 1.1);
  table.add_value(kDescent, name, "steps, power of log2 m", range, of_m, 1.1);
  table.add_value(kDescent, name, "vertices that rounding hid from the descent", "all",
                  static_cast<double>(sum.repairs));
  table.add_value(kDescent, name, std::string(kWrongAnswers), "all", sum.wrong, 0);
}

/// Outer hierarchies of all inner levels: their size, and lines by them, each answer beside the inner descent's.
void measure_twins(const std::string& name, const std::vector<Prepared>& all, int most, scenes::Random& random,
                   ClaimTable& table) {
  Growth memory{name, "bytes of the twin hierarchies", "n"}, elements{name, "vertices and facets of all levels", "n"};
  Growth steps{name, "steps of a line / log2 n, level 0", "n"}, any{name, "steps of a line / log2 n, any level", "n"};
  Growth outer_levels{name, "steps of a line / outer levels, level 0", "n"};
  Growth check{name, "facets looked at in a line's final check", "n"};
  Growth build{name, "processor time to build the twin hierarchies, ns", "n"};
  int wrong = 0;
  std::int64_t repairs = 0, lines = 0;
  for (const Prepared& p : all) {
    const int n = p.body.num_vertices();
    if (n < 64 || n > most) continue;
    const std::clock_t begin = std::clock();
    const TwinHierarchy twin = TwinHierarchy::build(p.body).value();
    build.add(n, 1e9 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    double count = 0, worst_level = 0, worst_finest = 0, worst_check = 0;
    for (int i = 0; i < twin.num_levels(); ++i) {
      for (const auto& level : twin.outer(i).levels()) count += level.vertices + level.facets;
      double most_steps = 0;
      (void)worst_direction(random, [&](const Vec3& d) {
        const Vec3 point = p.body.centre() + random.vector(0, p.body.radius());
        const LevelCrossing found = crossing_of_level(twin, i, point, d).value();
        repairs += found.repairs;
        ++lines;
        most_steps = std::max(most_steps, static_cast<double>(found.steps));
        worst_check = std::max(worst_check, static_cast<double>(found.certificate));
        return static_cast<double>(found.steps);
      });
      worst_level = std::max(worst_level, most_steps);
      if (i == 0) worst_finest = most_steps;
    }
    for (int k = 0; k < 50; ++k) {
      const Vec3 point = p.body.centre() + random.vector(0, 0.5 * p.body.radius());
      const Vec3 d = random.direction();
      const LevelCrossing outer = crossing_of_level(twin, 0, point, d).value();
      const ConvexPolytope small = ConvexPolytope::from_points({&point, 1}).value();
      const LevelCrossing inner = crossing_of_level(twin.inner(), 0, small, d).value();
      wrong +=
          outer.meets != inner.meets || outer.enter_lower != inner.enter_lower || outer.leave_upper != inner.leave_upper
              ? 1
              : 0;
    }
    memory.add(n, static_cast<double>(twin.memory_bytes()));
    elements.add(n, count);
    steps.add(n, worst_finest / std::log2(n));
    any.add(n, worst_level / std::log2(n));
    outer_levels.add(n, worst_finest / static_cast<double>(twin.outer(0).levels().size()));
    check.add(n, worst_check);
  }
  table.add_growth(kMemory, std::move(memory), 1.02);
  table.add_growth(kMemory, std::move(elements), 1.02);
  table.add_growth(kMemory, std::move(build), 1.2);
  table.add_growth(kLines, std::move(steps), 0.1);
  table.add_growth(kLines, std::move(any), 0.1);
  table.add_growth(kLines, std::move(outer_levels), 0.1);
  table.add_growth(kLines, std::move(check));
  table.add_value(kLines, name, "scans of a level that rounding asked for", fmt::format("{} lines", lines),
                  static_cast<double>(repairs));
  table.add_value(kLines, name, std::string(kWrongAnswers), "all", wrong, 0);
}

}  // namespace

const std::vector<std::string>& hierarchy_families() {
  static const std::vector<std::string> names{"balls", "needles", "prisms", "roofs"};
  return names;
}

void measure_hierarchy(const DobkinSettings& settings, ClaimTable& table) {
  const std::vector<int> sizes = sizes_up_to(settings.full ? 1 << 20 : 1 << 12);
  for (const Family family : {Family::roof, Family::prism, Family::ball, Family::needle}) {
    const std::string& name = hierarchy_families()[static_cast<std::size_t>(family)];
    const auto& asked = settings.families;
    if (!asked.empty() && std::find(asked.begin(), asked.end(), name) == asked.end()) continue;
    scenes::Random random(settings.seed);
    const std::vector<Prepared> all = prepare(family, sizes, random);
    measure_descents(name, all, sizes, random, table);
    Growth memory{name, "bytes of an inner hierarchy", "n"}, levels{name, "levels / log2 n", "n"};
    for (const Prepared& p : all) {
      if (p.body.num_vertices() < 64) continue;
      memory.add(p.body.num_vertices(), static_cast<double>(p.inner.memory_bytes()));
      levels.add(p.body.num_vertices(),
                 static_cast<double>(p.inner.levels().size()) / std::log2(p.body.num_vertices()));
    }
    table.add_growth(kMemory, std::move(memory), 1.02);
    table.add_growth(kMemory, std::move(levels), 0.05);
    measure_twins(name, all, settings.full ? 1 << 16 : 1 << 10, random, table);
  }
}

}  // namespace pd::bench
