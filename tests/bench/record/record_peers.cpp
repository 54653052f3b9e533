/// @file
/// What a peer says of generated pairs, as a contact record for `pdepth audit` and `pdepth accuracy`.
///
///   record_peers --list
///   record_peers --engine fcl-contact --family prism --pairs 25 --out prism.jsonl
///   record_peers --engine fcl-contact --cases contacts.jsonl --out fcl.jsonl         (the pairs of a record)
///
/// Prints the median nanoseconds of a query, by the processor clock of its thread, and how many pairs have no line,
/// because the engine ended on an assertion of its own or crashed: the work is done by a child, and after such an end
/// by another one that leaves that pair out.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "bench/peers/solver.hpp"
#include "pd/record/pd_record.h"
#include "scenes/shape_families.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {
namespace {

struct RecordOptions {
  std::string engine;
  std::string family;
  std::string cases;
  std::string out;
  int pairs = 25;
  int bodies = 0;  ///< pairs of the family share the bodies of this many; 0: each has its own
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
  // Engines of whole worlds want the origin inside of a body.
  const bool of_worlds =
      solver.name().starts_with(kOde) || solver.name().starts_with(kMujoco) || solver.name().starts_with("dart");
  if (of_worlds) {
    move_origin(pair.a, pair.pose_a);
    move_origin(pair.b, pair.pose_b);
  }
  for (scenes::Points* points : {&pair.a, &pair.b}) {
    for (Vec3& p : *points) p = rounded(p, precision);
  }
  auto a = ConvexPolytope::from_points(pair.a);
  auto b = ConvexPolytope::from_points(pair.b);
  // The families hold sizes that no float holds, and flat bodies, which these engines and FCL do not take as hulls.
  if (!a || !b) return std::nullopt;
  const bool needs_solids = of_worlds || solver.name().starts_with("fcl");
  if (needs_solids && (a->affine_dimension() < 3 || b->affine_dimension() < 3)) return std::nullopt;
  const Pose pose_a = rounded(pair.pose_a, precision);
  const Pose pose_b = rounded(pair.pose_b, precision);
  if (!pose_a.translation().allFinite() || !pose_b.translation().allFinite()) return std::nullopt;
  CorpusPair taken{{std::move(a).value(), std::move(b).value()}, pose_a, pose_b};
  if (!solver.takes(taken.bodies)) return std::nullopt;
  return taken;
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

/// A pair to ask about; the ids name bodies that several pairs may share.
struct NamedPair {
  scenes::PointPair points;
  std::string id_a;
  std::string id_b;
};

/// The middle of some numbers; 0 of none.
double median(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// Seconds that two readings of the clock with nothing in between are apart.
double clock_seconds() {
  std::vector<double> seconds;
  for (int i = 0; i < 101; ++i) {
    const double start = processor_seconds();
    seconds.push_back(processor_seconds() - start);
  }
  return median(seconds);
}

/// The pairs at which the engine ended, and the one that it works on, in memory that outlives the child.
struct Progress {
  std::set<int> ended_at;
  std::atomic<int>* current;
};

/// Asks the solver and writes what it says.
class Recording {
 public:
  Recording(const RecordOptions& options, Solver& solver, const Progress& progress)
      : solver_(solver), progress_(progress) {
    pd_record_open(&file_, options.out.c_str(), options.engine.c_str(),
                   solver.precision() == Precision::binary32 ? PD_RECORD_FLOAT32 : PD_RECORD_FLOAT64, nullptr);
  }

  void ask(const NamedPair& named) {
    const auto pair = corpus_pair(named.points, solver_);
    if (!pair) return;
    *progress_.current = number_++;
    if (progress_.ended_at.contains(*progress_.current)) return;
    const auto attempt = solver_.prepare(pair->bodies);
    attempt->stand(pair->pose_a, pair->pose_b);
    const double start = processor_seconds();
    attempt->run();
    seconds_.push_back(processor_seconds() - start);
    if (written_.insert(named.id_a).second) write_shape(file_, named.id_a, pair->bodies.a);
    if (written_.insert(named.id_b).second) write_shape(file_, named.id_b, pair->bodies.b);
    write_answer(named, *pair, attempt->answer());
  }

  /// Closes the file and prints the nanoseconds of a query and the pairs without a line. @return the exit code
  int close(const std::string& name) {
    if (pd_record_close(&file_) == 0) {
      std::fprintf(stderr, "record_peers: %s cannot be written\n", name.c_str());
      return 1;
    }
    const double nanoseconds = 1e9 * (median(seconds_) - clock_seconds());
    std::printf("%.0f %zu\n", seconds_.empty() ? 0 : std::max(1.0, nanoseconds), progress_.ended_at.size());
    return 0;
  }

 private:
  void write_answer(const NamedPair& named, const CorpusPair& pair, const Answer& answer) {
    const pd_record_pose pose_a = to_record(pair.pose_a);
    const pd_record_pose pose_b = to_record(pair.pose_b);
    const Vec3 normal = answer.translation.stableNormalized();
    const bool direction = normal.allFinite() && !normal.isZero(0);
    const pd_record_report report{answer.depth, direction ? normal.data() : nullptr, nullptr, 0};
    pd_record_contact(&file_, named.id_a.c_str(), &pose_a, named.id_b.c_str(), &pose_b,
                      answer.overlapping ? &report : nullptr);
  }

  Solver& solver_;
  const Progress& progress_;
  int number_ = 0;  ///< of pairs that the engine takes
  pd_record file_{};
  std::set<std::string> written_;
  std::vector<double> seconds_;  ///< of each query
};

int record_family(const RecordOptions& options, Solver& solver, const Progress& progress, scenes::PairFamily family) {
  Recording recording(options, solver, progress);
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    const auto pair_of = [&](int i) {
      const std::uint64_t seed = options.seed * 1'000'003U + static_cast<std::uint64_t>(i);
      return scenes::make_pair(family, options.vertices, static_cast<scenes::DepthClass>(d), seed);
    };
    for (int i = 0; i < options.pairs; ++i) {
      NamedPair named{pair_of(i), "", ""};
      const int body = options.bodies > 0 ? i % options.bodies : i;
      if (body != i) {
        scenes::PointPair shared = pair_of(body);
        named.points.a = std::move(shared.a);
        named.points.b = std::move(shared.b);
      }
      const std::string name = std::to_string(d) + "_" + std::to_string(body);
      named.id_a = name + "a";
      named.id_b = name + "b";
      recording.ask(named);
    }
  }
  return recording.close(options.out);
}

Vec3 vector_of(const nlohmann::json& numbers) {
  const auto v = numbers.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

Pose pose_of(const nlohmann::json& contact, const char* key) {
  if (!contact.contains(key)) return {};
  const nlohmann::json& pose = contact.at(key);
  const Vec3 at = pose.contains("translation") ? vector_of(pose.at("translation")) : Vec3(Vec3::Zero());
  if (pose.contains("quaternion_wxyz")) {
    return Pose::from_quaternion(pose.at("quaternion_wxyz").get<std::array<double, 4>>(), at).value();
  }
  if (!pose.contains("rotation_row_major")) return Pose::from_trusted_matrix(Mat3::Identity(), at);
  const auto numbers = pose.at("rotation_row_major").get<std::array<double, 9>>();
  Mat3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = numbers[static_cast<std::size_t>(i)];
  return Pose::from_matrix(rotation, at).value();
}

/// The points of a shape of a record that is the hull of points; empty for others.
scenes::Points points_of(const nlohmann::json& shape) {
  scenes::Points points;
  if (shape.value("margin", 0.0) != 0) return points;
  if (shape.at("type") == "box") return scenes::box(vector_of(shape.at("half_extents")));
  if (shape.at("type") != "convex") return points;
  for (const nlohmann::json& vertex : shape.at("vertices")) points.push_back(vector_of(vertex));
  return points;
}

/// The pairs of hulls of a contact record; other lines are passed over and counted on stderr.
int record_cases(const RecordOptions& options, Solver& solver, const Progress& progress) {
  std::ifstream cases(options.cases);
  std::map<std::string, scenes::Points> shapes;
  Recording recording(options, solver, progress);
  int passed_over = 0;
  for (std::string text; std::getline(cases, text);) {
    const auto line = nlohmann::json::parse(text, nullptr, false);
    try {
      if (line.is_discarded() || line.contains("record")) continue;
      if (line.contains("shape")) {
        shapes[line.at("shape").get<std::string>()] = points_of(line.at("is"));
        continue;
      }
      const NamedPair named{
          scenes::PointPair{shapes.at(line.at("a").get<std::string>()), shapes.at(line.at("b").get<std::string>()),
                            pose_of(line, "pose_a"), pose_of(line, "pose_b")},
          line.at("a").get<std::string>(), line.at("b").get<std::string>()};
      if (named.points.a.empty() || named.points.b.empty()) throw std::invalid_argument("no hull of points");
      recording.ask(named);
    } catch (const std::exception&) {
      ++passed_over;
    }
  }
  if (passed_over > 0) std::fprintf(stderr, "record_peers: %d lines are no pairs of hulls\n", passed_over);
  return recording.close(options.out);
}

/// Whether a child ended by the engine's own doing, and not by a limit or by a hand from outside.
bool ended_by_itself(int status) {
  return WIFSIGNALED(status) && (WTERMSIG(status) == SIGABRT || WTERMSIG(status) == SIGSEGV ||
                                 WTERMSIG(status) == SIGFPE || WTERMSIG(status) == SIGBUS);
}

/// Calls `record(progress)` in a child, and again without the pair at which one ended. @return the exit code
template <class Record>
int in_children(Record&& record) {
  void* shared = ::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return 1;
  Progress progress{{}, new (shared) std::atomic<int>(-1)};
  for (;;) {
    *progress.current = -1;
    const pid_t child = ::fork();
    if (child < 0) return 1;
    if (child == 0) {
      const int code = record(progress);
      std::fflush(stdout);
      std::_Exit(code);
    }
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return 1;
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    // Before the first pair, or at one that was left out: no pair is to blame.
    if (!ended_by_itself(status) || *progress.current < 0 || !progress.ended_at.insert(*progress.current).second) {
      return 1;
    }
  }
}

int run(const RecordOptions& options, bool list) {
  Solvers solvers;
  add_ours(solvers, false, false);
  add_peers(solvers);
#ifdef PD_BENCH_WITH_ODE
  add_ode(solvers);
#endif
#ifdef PD_BENCH_WITH_MUJOCO_LIBRARY
  add_mujoco_library(solvers);
#endif
#ifdef PD_BENCH_WITH_DART
  add_dart(solvers);
#endif
  for (const auto& solver : solvers) {
    if (list) {
      std::printf("%s%s\n", std::string(solver->name()).c_str(),
                  solver->name().starts_with("bullet") && solver->precision() == Precision::binary64 ? "-double" : "");
      continue;
    }
    if (solver->name() != options.engine && std::string(solver->name()) + "-double" != options.engine) continue;
    if (!options.cases.empty()) {
      return in_children([&](const Progress& progress) { return record_cases(options, *solver, progress); });
    }
    for (int f = 0; f < scenes::kPairFamilies; ++f) {
      const auto family = static_cast<scenes::PairFamily>(f);
      if (to_string(family) != options.family) continue;
      return in_children([&](const Progress& progress) { return record_family(options, *solver, progress, family); });
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
  app.add_option("--cases", options.cases, "the pairs of this contact record in place of a family")
      ->check(CLI::ExistingFile);
  app.add_option("--bodies", options.bodies, "pairs of the family share the bodies of this many")
      ->check(CLI::PositiveNumber);
  app.add_option("--pairs", options.pairs, "for each of four depths")->check(CLI::PositiveNumber);
  app.add_option("--vertices", options.vertices)->check(CLI::Range(4, 100'000));
  app.add_option("--seed", options.seed);
  app.add_option("--out", options.out);
  CLI11_PARSE(app, argc, argv);
  return pd::bench::run(options, list);
}
