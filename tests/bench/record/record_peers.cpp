/// @file
/// What a peer says of generated pairs, as a contact record for `pdepth audit` and `pdepth accuracy`.
///
///   record_peers --list
///   record_peers --engine fcl-contact --family prism --pairs 25 --out prism.jsonl    (prints its nanoseconds a query)
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

#include "bench/peers/solver.hpp"
#include "pd/record/pd_record.h"
#include "scenes/shape_families.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {
namespace {

struct RecordOptions {
  std::string engine;
  std::string family;
  std::string out;
  int pairs = 25;
  int vertices = 32;
  std::uint64_t seed = 1;
};

/// A pair in the numbers that the engine gets.
struct CorpusPair {
  Bodies bodies;
  Pose pose_a;
  Pose pose_b;
};

Vec3 rounded(const Vec3& v, Precision precision) { return precision == Precision::binary32 ? scenes::to_single(v) : v; }

Pose rounded(const Pose& pose, Precision precision) {
  return precision == Precision::binary32 ? scenes::to_single(pose) : pose;
}

/// The body moved in its frame so that `centre` is the origin, and its pose so that it stays where it was (to
/// rounding).
void move_origin(scenes::Points& points, Pose& pose) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : points) centre += p / static_cast<double>(points.size());
  for (Vec3& p : points) p -= centre;
  pose = Pose::from_trusted_matrix(pose.rotation(), pose.translation() + pose.rotation() * centre);
}

std::optional<CorpusPair> corpus_pair(scenes::PointPair pair, const Solver& solver) {
  const Precision precision = solver.precision();
  if (solver.name() == kOde) {
    move_origin(pair.a, pair.pose_a);
    move_origin(pair.b, pair.pose_b);
  }
  for (scenes::Points* points : {&pair.a, &pair.b}) {
    for (Vec3& p : *points) p = rounded(p, precision);
  }
  auto a = ConvexPolytope::from_points(pair.a);
  auto b = ConvexPolytope::from_points(pair.b);
  // The families hold sizes that no float holds, and flat bodies, which ODE and FCL do not take as hulls.
  if (!a || !b) return std::nullopt;
  const bool needs_solids = solver.name() == kOde || solver.name().starts_with("fcl");
  if (needs_solids && (a->affine_dimension() < 3 || b->affine_dimension() < 3)) return std::nullopt;
  const Pose pose_a = rounded(pair.pose_a, precision);
  const Pose pose_b = rounded(pair.pose_b, precision);
  if (!pose_a.translation().allFinite() || !pose_b.translation().allFinite()) return std::nullopt;
  return CorpusPair{{std::move(a).value(), std::move(b).value()}, pose_a, pose_b};
}

void write_shape(pd_record& record, const std::string& id, const ConvexShape& shape) {
  std::vector<double> numbers;
  for (const Vec3& p : vertices_of(shape)) numbers.insert(numbers.end(), p.data(), p.data() + 3);
  pd_record_convex(&record, id.c_str(), numbers.data(), numbers.size() / 3, 0);
}

pd_record_pose to_record(const Pose& pose) {
  pd_record_pose written{};
  std::copy_n(pose.translation().data(), 3, written.translation);
  written.rotation = PD_RECORD_MATRIX;
  for (int i = 0; i < 9; ++i) written.matrix_row_major[i] = pose.rotation()(i / 3, i % 3);
  return written;
}

void write_answer(pd_record& record, const std::string& name, const CorpusPair& pair, const Answer& answer) {
  const std::string a = name + "a";
  const std::string b = name + "b";
  write_shape(record, a, pair.bodies.a);
  write_shape(record, b, pair.bodies.b);
  const pd_record_pose pose_a = to_record(pair.pose_a);
  const pd_record_pose pose_b = to_record(pair.pose_b);
  const Vec3 normal = answer.translation.stableNormalized();
  const bool direction = normal.allFinite() && !normal.isZero(0);
  const pd_record_report report{answer.depth, direction ? normal.data() : nullptr, nullptr, 0};
  pd_record_contact(&record, a.c_str(), &pose_a, b.c_str(), &pose_b, answer.overlapping ? &report : nullptr);
}

int record(const RecordOptions& options, Solver& solver, scenes::PairFamily family) {
  pd_record file;
  const Precision precision = solver.precision();
  pd_record_open(&file, options.out.c_str(), options.engine.c_str(),
                 precision == Precision::binary32 ? PD_RECORD_FLOAT32 : PD_RECORD_FLOAT64, nullptr);
  double nanoseconds = 0;
  int asked = 0;
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (int i = 0; i < options.pairs; ++i) {
      const std::uint64_t seed = options.seed * 1'000'003U + static_cast<std::uint64_t>(i);
      const auto pair =
          corpus_pair(scenes::make_pair(family, options.vertices, static_cast<scenes::DepthClass>(d), seed), solver);
      if (!pair) continue;
      const auto attempt = solver.prepare(pair->bodies);
      attempt->stand(pair->pose_a, pair->pose_b);
      const auto start = std::chrono::steady_clock::now();
      attempt->run();
      nanoseconds += std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
      write_answer(file, std::to_string(asked++), *pair, attempt->answer());
    }
  }
  if (pd_record_close(&file) == 0) {
    std::fprintf(stderr, "record_peers: %s cannot be written\n", options.out.c_str());
    return 1;
  }
  std::printf("%.0f\n", asked > 0 ? nanoseconds / asked : 0);
  return 0;
}

int run(const RecordOptions& options, bool list) {
  Solvers solvers;
  add_ours(solvers, false, false);
  add_peers(solvers);
#ifdef PD_BENCH_WITH_ODE
  add_ode(solvers);
#endif
  for (const auto& solver : solvers) {
    if (list) {
      std::printf("%s%s\n", std::string(solver->name()).c_str(),
                  solver->name().starts_with("bullet") && solver->precision() == Precision::binary64 ? "-double" : "");
      continue;
    }
    if (solver->name() != options.engine && std::string(solver->name()) + "-double" != options.engine) continue;
    for (int f = 0; f < scenes::kPairFamilies; ++f) {
      const auto family = static_cast<scenes::PairFamily>(f);
      if (to_string(family) == options.family) return record(options, *solver, family);
    }
    std::fprintf(stderr, "record_peers: there is no family \"%s\"\n", options.family.c_str());
    return 2;
  }
  if (list) return 0;
  std::fprintf(stderr, "record_peers: there is no engine \"%s\" here; --list names them\n", options.engine.c_str());
  return 2;
}

}  // namespace
}  // namespace pd::bench

int main(int argc, char** argv) {
  pd::bench::RecordOptions options;
  bool list = false;
  CLI::App app("Contacts of generated pairs as an engine reports them, recorded", "record_peers");
  app.add_flag("--list", list, "names the engines");
  app.add_option("--engine", options.engine);
  app.add_option("--family", options.family);
  app.add_option("--pairs", options.pairs, "for each of four depths")->check(CLI::PositiveNumber);
  app.add_option("--vertices", options.vertices)->check(CLI::Range(4, 100'000));
  app.add_option("--seed", options.seed);
  app.add_option("--out", options.out);
  CLI11_PARSE(app, argc, argv);
  return pd::bench::run(options, list);
}
