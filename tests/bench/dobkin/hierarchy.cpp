/// @file
/// [D] Theorem 5.6: steps of the descent over n and m apart from each other.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "bench/agarwal/agarwal.hpp"
#include "bench/dobkin/dobkin.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

namespace {

const Claim kDescent{"Theorem 5.6", "directional depth of two polytopes by their hierarchies in O(log n log m) steps"};
const Claim kMemory{"Fact 5.1", "a hierarchy has O(n) size and O(log n) levels"};

enum class Family { ball, needle, prism, roof };
constexpr std::array<std::string_view, 4> kNames{"balls", "needles", "prisms", "roofs"};

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

struct Counted {
  double steps = 0;  ///< of the worst direction found
  double certificate = 0;
  std::int64_t repairs = 0;
  int wrong = 0;
};

/// Random directions, and from the worst of them a climb by smaller and smaller turns.
Counted worst_of(const ConvexPolytope& p, const ConvexPolytope& q, scenes::Random& random) {
  const ConvexShape a(p), b(q);
  const PolyhedralHierarchy ha = *PolyhedralHierarchy::build(p, HierarchyKind::inner);
  const PolyhedralHierarchy hb = *PolyhedralHierarchy::build(q, HierarchyKind::inner);
  const DirectionalHierarchies hierarchies{&ha, &hb};
  const Pose turned = *Pose::from_quaternion(random.quaternion(), Vec3(0.001, 0.002, -0.001));
  const PosedShape posed_a{&a, turned}, posed_b{&b, Pose()};
  Scratch scratch;
  Counted counted;
  Vec3 worst = Vec3::UnitX();
  const auto ask = [&](const Vec3& d) {
    const auto found = directional_depth(posed_a, posed_b, d, scratch, DirectionalMethod::hierarchy, &hierarchies);
    counted.certificate = std::max(counted.certificate, static_cast<double>(found->descent.certificate));
    counted.repairs += found->descent.repairs;
    const auto steps = static_cast<double>(found->descent.steps);
    if (steps <= counted.steps) return;
    counted.steps = steps;
    worst = d;
  };
  for (int i = 0; i < 40; ++i) ask(random.direction());
  for (int i = 0; i < 40; ++i) ask((worst + std::ldexp(1.0, -1 - i / 4) * random.direction()).normalized());
  for (int i = 0; i < 10; ++i) {
    const Vec3 d = i == 0 ? worst : random.direction();
    const auto found = directional_depth(posed_a, posed_b, d, scratch, DirectionalMethod::hierarchy, &hierarchies);
    const auto expected = directional_depth(posed_a, posed_b, d, scratch);
    counted.wrong += found->lower != expected->lower || found->upper != expected->upper ? 1 : 0;
  }
  return counted;
}

}  // namespace

void measure_hierarchy(const DobkinSettings& settings, ClaimTable& table) {
  const int most = settings.full ? 1 << 20 : 1 << 13;
  for (const Family family : {Family::ball, Family::needle, Family::prism, Family::roof}) {
    const std::string name(kNames[static_cast<std::size_t>(family)]);
    int wrong = 0;
    std::int64_t repairs = 0;
    // Equal sizes, and the other size held small and large.
    for (const int other : {0, 16, most / 4}) {
      const std::string title = other == 0 ? name + ", m = n" : fmt::format("{}, m = {}", name, other);
      Growth plain{title, "steps", "n"}, share{title, "steps / (log2 n log2 m)", "n"};
      Growth certificate{title, "edges in the final check", "n"};
      scenes::Random random(settings.seed);
      for (int n = 8; n <= most; n *= 4) {
        const int m = other == 0 ? n : other;
        const Counted c = worst_of(body(family, n, random), body(family, m, random), random);
        plain.add(n, c.steps);
        share.add(n, c.steps / (std::log2(n) * std::log2(m)));
        certificate.add(n, c.certificate);
        wrong += c.wrong;
        repairs += c.repairs;
      }
      table.add_growth(kDescent, std::move(plain));
      table.add_growth(kDescent, std::move(share), 0.1);
      table.add_growth(kDescent, std::move(certificate));
    }
    table.add_value(kDescent, name, "vertices that rounding hid from the descent", "all", static_cast<double>(repairs));
    table.add_value(kDescent, name, std::string(kWrongAnswers), "all", wrong, 0);

    Growth memory{name, "bytes of an inner hierarchy", "n"}, levels{name, "levels / log2 n", "n"};
    scenes::Random random(settings.seed + 1);
    for (int n = 64; n <= most; n *= 4) {
      const ConvexPolytope p = body(family, n, random);
      const PolyhedralHierarchy h = *PolyhedralHierarchy::build(p, HierarchyKind::inner);
      memory.add(p.num_vertices(), static_cast<double>(h.memory_bytes()));
      levels.add(p.num_vertices(), static_cast<double>(h.levels().size()) / std::log2(p.num_vertices()));
    }
    table.add_growth(kMemory, std::move(memory), 1.02);
    table.add_growth(kMemory, std::move(levels), 0.05);
  }
}

}  // namespace pd::bench
