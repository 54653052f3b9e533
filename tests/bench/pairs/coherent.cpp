#include "bench/pairs/coherent.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "bench/measure/allocation_counter.hpp"
#include "bench/measure/stopwatch.hpp"
#include "bench/pairs/judge.hpp"

namespace pd::bench {

namespace {

using scenes::PairFamily;

struct Shape {
  PairFamily family;
  int vertices;
  bool quick;
};
constexpr Shape kShapes[] = {{PairFamily::box, 8, true},       {PairFamily::sphere, 8, true},
                             {PairFamily::sphere, 32, true},   {PairFamily::sphere, 128, true},
                             {PairFamily::needle, 128, false}, {PairFamily::prism, 128, true},
                             {PairFamily::roofs, 32, false},   {PairFamily::roofs, 128, false},
                             {PairFamily::sphere, 512, false}, {PairFamily::sphere, 2048, false}};
constexpr double kSteps[] = {0.002, 0.01, 0.05};
constexpr double kShares[] = {0.01, 0.1, 0.4};

struct Frame {
  Pose a;
  Pose b;
};

std::array<double, 4> turned(const std::array<double, 4>& q, const Vec3& axis, double angle) {
  const Eigen::Quaterniond r =
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  const Eigen::Quaterniond unit = r.normalized();
  return {unit.w(), unit.x(), unit.y(), unit.z()};
}

/// Both bodies turn by the step about slowly drifting axes; B hangs at A's extreme point in a direction that drifts as
/// well, deeper by the wanted share of the smaller body's least extent.
std::vector<Frame> frames_of(const Sequence& sequence, const Bodies& bodies, int count, scenes::Random& random) {
  const double size =
      std::min(extent_of(vertices_of(bodies.a)).size.minCoeff(), extent_of(vertices_of(bodies.b)).size.minCoeff());
  std::array<double, 4> qa = random.quaternion();
  std::array<double, 4> qb = random.quaternion();
  Vec3 axis_a = random.direction();
  Vec3 axis_b = random.direction();
  Vec3 out = random.direction();
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) {
    const double step = sequence.step_radians;
    qa = turned(qa, axis_a, step / 2);
    qb = turned(qb, axis_b, step / 2);
    for (Vec3* v : {&axis_a, &axis_b, &out}) *v = (*v + 0.25 * step * random.direction()).normalized();
    const Pose a = *Pose::from_quaternion(qa, Vec3::Zero());
    const Pose turned_b = *Pose::from_quaternion(qb, Vec3::Zero());
    const Vec3 t = extreme(bodies.a, a.rotation(), out) - extreme(bodies.b, turned_b.rotation(), -out) -
                   sequence.depth_share * size * out;
    frames.push_back({a, *Pose::from_quaternion(qb, t)});
  }
  return frames;
}

struct Lane {
  std::vector<double> least_ns;
  std::vector<double> errors;
  int wrong = 0;
  int run = 0;
  int longest_run = 0;
  int warm = 0;
  std::int64_t allocations = 0;
  std::int64_t calls = 0;
};

/// Every pass starts with fresh memories. A pass keeps several of them side by side, all in the same state, so that one
/// reading of the clock covers several calls.
void measure(const Bodies& bodies, const std::vector<Frame>& frames, Solvers& solvers, std::vector<Lane>& lanes) {
  constexpr int kPasses = 3;
  constexpr int kSideBySide = 4;
  const JudgedBodies judged(bodies);
  std::vector<std::unique_ptr<Judge>> judges;
  for (const Frame& f : frames) judges.push_back(std::make_unique<Judge>(judged, f.a, f.b));
  for (Lane& lane : lanes) lane.least_ns.assign(frames.size(), std::numeric_limits<double>::infinity());

  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<std::vector<std::unique_ptr<Attempt>>> attempts(solvers.size());
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      if (!solvers[s]->takes(bodies)) continue;
      for (int k = 0; k < kSideBySide; ++k) attempts[s].push_back(solvers[s]->prepare(bodies));
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (std::size_t s = 0; s < solvers.size(); ++s) {
        if (attempts[s].empty()) continue;
        Lane& lane = lanes[s];
        for (auto& attempt : attempts[s]) attempt->stand(frames[i].a, frames[i].b);
        const std::int64_t before = allocations();
        const auto t0 = Clock::now();
        for (auto& attempt : attempts[s]) attempt->run();
        const auto t1 = Clock::now();
        // The first frame of a pass grows buffers, and belongs to no sequence's steady state.
        if (i > 0) {
          lane.allocations += allocations() - before;
          lane.calls += kSideBySide;
        }
        lane.least_ns[i] = std::min(lane.least_ns[i], elapsed_ns(t0, t1) / kSideBySide);
        if (pass > 0) continue;
        const Attempt& first = *attempts[s].front();
        const Judgement j = judges[i]->judge(first.answer(), solvers[s]->precision());
        lane.errors.push_back(j.relative_error);
        lane.wrong += j.wrong ? 1 : 0;
        lane.run = j.wrong ? lane.run + 1 : 0;
        lane.longest_run = std::max(lane.longest_run, lane.run);
        lane.warm += first.warm() ? 1 : 0;
      }
      if (pass == 0) judges[i].reset();
    }
  }
}

CoherentRow to_row(const Sequence& sequence, const Lane& lane, std::string_view solver) {
  CoherentRow row;
  row.family = scenes::to_string(sequence.family);
  row.vertices = sequence.vertices;
  row.step_radians = sequence.step_radians;
  row.depth_share = sequence.depth_share;
  row.solver = solver;
  row.frames = static_cast<int>(lane.errors.size());
  row.p50_ns = quantile(lane.least_ns, 0.5);
  row.p99_ns = quantile(lane.least_ns, 0.99);
  row.wrong = lane.wrong;
  row.worst_error = *std::max_element(lane.errors.begin(), lane.errors.end());
  row.longest_wrong_run = lane.longest_run;
  row.warm_share = static_cast<double>(lane.warm) / row.frames;
  row.allocations = static_cast<double>(lane.allocations) / static_cast<double>(lane.calls);
  return row;
}

std::string ratio_text(double value) { return std::isfinite(value) ? fmt::format("{:.3f}", value) : "-"; }

void print_block(const std::vector<CoherentRow>& block) {
  for (const CoherentRow& r : block) {
    fmt::print(
        "{:<7} {:>8} {:>6} {:>5.0f}% {:<17} {:>9.0f} {:>10.0f} {:>8} {:>8} {:>6} {:>9.1e} {:>5} {:>5.0f}% {:>7.1f}{}\n",
        r.family, r.vertices, r.step_radians, 100 * r.depth_share, r.solver, r.p50_ns, r.p99_ns,
        ratio_text(r.ratio_to_bullet), ratio_text(r.p99_ratio_to_bullet), r.wrong, r.worst_error, r.longest_wrong_run,
        100 * r.warm_share, r.allocations, r.wrong > 0 ? "  WRONG" : "");
  }
  std::fflush(stdout);
}

void print_totals(const std::vector<CoherentRow>& rows) {
  fmt::print("\n{:<17} {:>14} {:>9} {:>13} {:>12} {:>11} {:>6}\n", "all sequences", "geometric mean", "p99 ratio",
             "wrong frames", "worst error", "longest run", "warm");
  std::vector<std::string> names;
  for (const CoherentRow& r : rows) {
    if (std::find(names.begin(), names.end(), r.solver) == names.end()) names.push_back(r.solver);
  }
  for (const std::string& name : names) {
    std::vector<double> ratios;
    std::vector<double> tails;
    CoherentRow sum;
    double warm = 0;
    for (const CoherentRow& r : rows) {
      if (r.solver != name) continue;
      ratios.push_back(r.ratio_to_bullet);
      tails.push_back(r.p99_ratio_to_bullet);
      sum.frames += r.frames;
      sum.wrong += r.wrong;
      sum.worst_error = std::max(sum.worst_error, r.worst_error);
      sum.longest_wrong_run = std::max(sum.longest_wrong_run, r.longest_wrong_run);
      warm += r.warm_share * r.frames;
    }
    fmt::print("{:<17} {:>14} {:>9} {:>11.2f} % {:>12.1e} {:>11} {:>4.0f} %\n", name,
               ratio_text(geometric_mean(ratios)), ratio_text(geometric_mean(tails)), 100.0 * sum.wrong / sum.frames,
               sum.worst_error, sum.longest_wrong_run, 100 * warm / sum.frames);
  }
}

}  // namespace

Expected<std::vector<Sequence>> choose_sequences(const std::vector<std::string>& families,
                                                 const std::vector<int>& vertices, bool quick) {
  std::vector<Sequence> sequences;
  for (const Shape& shape : kShapes) {
    const std::string name(scenes::to_string(shape.family));
    if (!families.empty() && std::find(families.begin(), families.end(), name) == families.end()) continue;
    if (!vertices.empty() && std::find(vertices.begin(), vertices.end(), shape.vertices) == vertices.end()) continue;
    if (quick && families.empty() && !shape.quick) continue;
    for (const double step : kSteps) {
      for (const double share : kShares) sequences.push_back({shape.family, shape.vertices, step, share});
    }
  }
  if (sequences.empty()) return Error{ErrorCode::bad_value, "no sequence has this family and size", "--families"};
  return sequences;
}

std::vector<CoherentRow> run_coherent(const CoherentSettings& settings, Solvers& solvers) {
  std::vector<CoherentRow> rows;
  fmt::print("{:<7} {:>8} {:>6} {:>6} {:<17} {:>9} {:>10} {:>8} {:>8} {:>6} {:>9} {:>5} {:>6} {:>7}\n", "family",
             "vertices", "step", "depth", "solver", "p50 ns", "p99 ns", "x bullet", "x p99", "wrong", "error", "run",
             "warm", "allocs");
  std::uint64_t number = 0;
  for (const Sequence& sequence : settings.sequences) {
    std::optional<Draw> bodies;
    const Cell cell{sequence.family, sequence.vertices, scenes::DepthClass::mid};
    while (!bodies) bodies = draw(cell, settings.seed, number++);
    scenes::Random random(settings.seed * 0x9E3779B97F4A7C15ULL + number);
    std::vector<Lane> lanes(solvers.size());
    measure(bodies->bodies, frames_of(sequence, bodies->bodies, settings.frames, random), solvers, lanes);
    std::vector<CoherentRow> block;
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      if (lanes[s].errors.empty()) continue;
      block.push_back(to_row(sequence, lanes[s], solvers[s]->name()));
    }
    for (const CoherentRow& bullet : std::vector<CoherentRow>(block)) {
      if (bullet.solver != kBulletEpa) continue;
      for (CoherentRow& row : block) {
        row.ratio_to_bullet = row.p50_ns / bullet.p50_ns;
        row.p99_ratio_to_bullet = row.p99_ns / bullet.p99_ns;
      }
    }
    print_block(block);
    rows.insert(rows.end(), block.begin(), block.end());
  }
  print_totals(rows);
  return rows;
}

std::string to_csv(const std::vector<CoherentRow>& rows) {
  std::string text =
      "family,vertices,step,depth,solver,frames,p50_ns,p99_ns,ratio_to_bullet,p99_ratio_to_bullet,wrong,worst_error,"
      "longest_wrong_run,warm_share,allocations\n";
  const auto ratio = [](double x) { return std::isfinite(x) ? fmt::format("{:.4f}", x) : std::string(); };
  for (const CoherentRow& r : rows) {
    text += fmt::format("{},{},{},{},{},{},{:.1f},{:.1f},{},{},{},{:.3g},{},{:.3f},{:g}\n", r.family, r.vertices,
                        r.step_radians, r.depth_share, r.solver, r.frames, r.p50_ns, r.p99_ns, ratio(r.ratio_to_bullet),
                        ratio(r.p99_ratio_to_bullet), r.wrong, r.worst_error, r.longest_wrong_run, r.warm_share,
                        r.allocations);
  }
  return text;
}

}  // namespace pd::bench
