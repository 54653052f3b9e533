#include "bench/pairs/shuffled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "bench/measure/stopwatch.hpp"
#include "bench/pairs/pair_source.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {

namespace {

using scenes::Random;
using scenes::to_single;

constexpr int kHotCalls = 3;

double size(Random& random) { return to_single(random.uniform(0.2, 1)); }
Vec3 sizes(Random& random) {
  const double x = size(random), y = size(random);
  return {x, y, size(random)};
}

ConvexShape body(Random& random) {
  switch (random.integer(0, 6)) {
    case 0:
      return *ConvexPolytope::box(sizes(random));
    case 1:
      return *ConvexShape::sphere(size(random));
    case 2: {
      const double radius = size(random);
      return *ConvexShape::capsule(radius, size(random), 2);
    }
    case 3: {
      const double radius = size(random);
      return *ConvexShape::cylinder(radius, size(random), 2);
    }
    case 4: {
      scenes::Points corners;
      for (int i = 0; i < 3; ++i) corners.push_back(to_single(random.direction()));
      return *ConvexPolytope::from_points(corners);
    }
    default: {
      const Vec3 semi_axes = sizes(random);
      scenes::Points points = scenes::sphere_hull(8 << random.integer(0, 4), random);
      for (Vec3& p : points) p = to_single(Vec3(semi_axes.cwiseProduct(p)));
      return *ConvexPolytope::from_points(points);
    }
  }
}

/// Places B along a random direction from A, deeper by 1 or 10 % of a half size than where they first touch.
Draw mixed_pair(Random& random, Scratch& scratch) {
  ConvexShape a = body(random);
  Draw d{{std::move(a), body(random)}, random.pose(Vec3::Zero()), Pose()};
  const auto turn = random.quaternion();
  const Vec3 direction = random.direction();
  const auto at = [&](double way) { return *Pose::from_quaternion(turn, way * direction); };
  double near = 0, far = 6;
  for (int step = 0; step < 24; ++step) {
    const double way = 0.5 * (near + far);
    const PenetrationDepth found =
        penetration_depth({&d.bodies.a, d.pose_a}, {&d.bodies.b, at(way)}, scratch, {.bracket = Bracket::certified});
    (found.contact == ContactClass::overlapping ? near : far) = way;
  }
  d.pose_b = at(near - (random.integer(0, 1) != 0 ? 0.02 : 0.002));
  return d;
}

/// Other data of a program: a walk over it leaves little of what lay in the caches.
class OtherData {
 public:
  explicit OtherData(int megabytes) : words_(static_cast<std::size_t>(megabytes) << 17, 1) {}
  void read() {
    for (std::size_t i = 0; i < words_.size(); i += 8) words_[i] += sum_ += words_[i];
  }

 private:
  std::vector<std::uint64_t> words_;
  std::uint64_t sum_ = 0;
};

double timed_ns(Attempt& attempt) {
  const auto begin = Clock::now();
  attempt.run();
  return elapsed_ns(begin, Clock::now());
}

/// The pairs that a solver takes, in one random order, and what they took.
class SolversPairs {
 public:
  SolversPairs(Solver& solver, const std::vector<Draw>& draws) : name_(solver.name()) {
    for (const Draw& d : draws) {
      if (!solver.takes(d.bodies)) continue;
      attempts_.push_back(solver.prepare(d.bodies));
      attempts_.back()->stand(d.pose_a, d.pose_b);
    }
  }
  void ask_hot() {
    for (const auto& attempt : attempts_) {
      double least = std::numeric_limits<double>::infinity();
      for (int call = 0; call <= kHotCalls; ++call) least = std::min(least, timed_ns(*attempt));
      hot_ns_ += least;
    }
  }
  void ask_shuffled() {
    for (const auto& attempt : attempts_) shuffled_ns_ += timed_ns(*attempt);
  }
  void ask_after(OtherData& other) {
    for (const auto& attempt : attempts_) {
      other.read();
      other_data_ns_ += timed_ns(*attempt);
    }
  }
  /// Puts the pairs of all solvers into orders that have nothing to do with that in which they were made.
  void shuffle(Random random) {
    for (std::size_t i = attempts_.size(); i > 1; --i) {
      std::swap(attempts_[i - 1], attempts_[static_cast<std::size_t>(random.integer(0, static_cast<int>(i) - 1))]);
    }
  }
  [[nodiscard]] ShuffledRow row() const {
    const auto count = static_cast<double>(attempts_.size());
    return {name_, static_cast<int>(attempts_.size()), hot_ns_ / count, shuffled_ns_ / count, other_data_ns_ / count};
  }

 private:
  std::string name_;
  std::vector<std::unique_ptr<Attempt>> attempts_;
  double hot_ns_ = 0, shuffled_ns_ = 0, other_data_ns_ = 0;
};

}  // namespace

std::vector<ShuffledRow> run_shuffled(const ShuffledSettings& settings, Solvers& solvers) {
  Random random(settings.seed * 0x9E3779B97F4A7C15ULL + 41);
  Scratch scratch;
  std::vector<Draw> draws;
  for (int i = 0; i < settings.pairs; ++i) draws.push_back(mixed_pair(random, scratch));
  OtherData other(settings.other_megabytes);
  std::vector<ShuffledRow> rows;
  fmt::print("{:<18} {:>7} {:>9} {:>9} {:>11}   ns a query\n", "solver", "pairs", "hot", "shuffled", "other data");
  for (const auto& solver : solvers) {
    SolversPairs pairs(*solver, draws);
    pairs.ask_hot();
    pairs.shuffle(random);
    pairs.ask_shuffled();
    pairs.ask_after(other);
    const ShuffledRow& row = rows.emplace_back(pairs.row());
    fmt::print("{:<18} {:>7} {:>9.0f} {:>9.0f} {:>11.0f}\n", row.solver, row.pairs, row.hot_ns, row.shuffled_ns,
               row.other_data_ns);
    std::fflush(stdout);
  }
  return rows;
}

std::string to_csv(const std::vector<ShuffledRow>& rows) {
  std::string out = "solver,pairs,hot_ns,shuffled_ns,other_data_ns\n";
  for (const ShuffledRow& r : rows) {
    out += fmt::format("{},{},{:.1f},{:.1f},{:.1f}\n", r.solver, r.pairs, r.hot_ns, r.shuffled_ns, r.other_data_ns);
  }
  return out;
}

}  // namespace pd::bench
