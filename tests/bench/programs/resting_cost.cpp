/// @file
/// `resting_cost`: nanoseconds of one query for bodies at rest, warm and cold, on floors of any width.
///
/// A figure is the least mean of its rounds of 256 frames each: the work is deterministic, and everything that adds to
/// it is disturbance.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

#include "bench/programs/resting_cases.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace {

using pd::bench::RestingCase;

struct Cost {
  double nanoseconds = std::numeric_limits<double>::infinity();
  int warm = 0;
  std::int64_t exact_signs = 0;
};

struct Ground {
  const char* name;
  pd::bench::RestingGround kind;
  double width;
  [[nodiscard]] bool is_round() const {
    return kind == pd::bench::RestingGround::sphere || kind == pd::bench::RestingGround::capsule;
  }
};
constexpr Ground kGrounds[] = {
    {"triangle", pd::bench::RestingGround::triangle, 2}, {"sphere", pd::bench::RestingGround::sphere, 0},
    {"capsule", pd::bench::RestingGround::capsule, 0.4}, {"1", pd::bench::RestingGround::floor, 1},
    {"20", pd::bench::RestingGround::floor, 20},         {"200", pd::bench::RestingGround::floor, 200},
    {"10000", pd::bench::RestingGround::floor, 1e4}};

/// Spheres and capsules also rest on each other.
bool is_round(pd::bench::RestingBody body) {
  return body == pd::bench::RestingBody::sphere || body == pd::bench::RestingBody::capsule;
}

Cost measure(const RestingCase& rest, bool warm, pd::Bracket bracket, int rounds) {
  pd::Scratch scratch;
  pd::WarmCertificate memory;
  const pd::DepthSettings settings = {.bracket = bracket, .contact_tolerance = rest.tolerance()};
  Cost cost;
  const pd::PosedShape ground = rest.ground();
  for (int round = 0; round < rounds; ++round) {
    Cost own;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < rest.frames(); ++i) {
      const pd::PenetrationDepth answer =
          penetration_depth(rest.body(i), ground, scratch, settings, warm ? &memory : nullptr);
      own.warm += answer.warm;
      own.exact_signs += answer.statistics.exact_signs;
    }
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    own.nanoseconds = std::min(cost.nanoseconds, 1e9 * spent / rest.frames());
    cost = own;
  }
  return cost;
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 40;
  std::vector<std::string> bodies;
  std::vector<std::string> brackets{"contact"};
  CLI::App app{"Times pd::penetration_depth on bodies at rest."};
  app.add_option("--rounds", rounds, "of 256 frames")->capture_default_str();
  app.add_option("--bodies", bodies, "box, hull_32, sphere, capsule, cylinder, cone; default: all")->delimiter(',');
  app.add_option("--brackets", brackets, "contact, certified, tightest")->capture_default_str()->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  std::printf("%-10s %-9s %8s %10s %10s  %s\n", "body", "bracket", "ground", "warm ns", "cold ns",
              "warm frames, exact");
  for (std::size_t k = 0; k < std::size(pd::bench::kRestingBodies); ++k) {
    const std::string name(pd::bench::kRestingBodies[k]);
    if (!bodies.empty() && std::find(bodies.begin(), bodies.end(), name) == bodies.end()) continue;
    for (const std::string& word : brackets) {
      const pd::Bracket bracket = word == "tightest"    ? pd::Bracket::tightest
                                  : word == "certified" ? pd::Bracket::certified
                                                        : pd::Bracket::contact;
      for (const Ground& ground : kGrounds) {
        const auto body = static_cast<pd::bench::RestingBody>(k);
        if (ground.is_round() && !is_round(body)) continue;
        const RestingCase rest(body, ground.kind, ground.width, 256);
        const Cost warm = measure(rest, true, bracket, rounds);
        const Cost cold = measure(rest, false, bracket, std::max(1, rounds / 4));
        std::printf("%-10s %-9s %8s %10.0f %10.0f  %d of %d, %lld\n", name.c_str(), word.c_str(), ground.name,
                    warm.nanoseconds, cold.nanoseconds, warm.warm, rest.frames(),
                    static_cast<long long>(warm.exact_signs));
      }
    }
  }
  return 0;
}
