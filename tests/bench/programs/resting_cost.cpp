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
      for (const double width : {0.0, 1.0, 20.0, 200.0, 1e4}) {
        const auto ground = width == 0 ? pd::bench::RestingGround::triangle : pd::bench::RestingGround::floor;
        const RestingCase rest(static_cast<pd::bench::RestingBody>(k), ground, width == 0 ? 2 : width, 256);
        const Cost warm = measure(rest, true, bracket, rounds);
        const Cost cold = measure(rest, false, bracket, std::max(1, rounds / 4));
        std::printf("%-10s %-9s %8s %10.0f %10.0f  %d of %d, %lld\n", name.c_str(), word.c_str(),
                    width == 0 ? "triangle" : std::to_string(static_cast<int>(width)).c_str(), warm.nanoseconds,
                    cold.nanoseconds, warm.warm, rest.frames(), static_cast<long long>(warm.exact_signs));
      }
    }
  }
  return 0;
}
