#include <cmath>

#include "bench/peers/solver.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::bench {

namespace {

class OurAttempt final : public Attempt {
 public:
  OurAttempt(const Bodies& bodies, Scratch& scratch, const DepthSettings& settings, bool remembering)
      : a_{&bodies.a, {}}, b_{&bodies.b, {}}, scratch_(scratch), settings_(settings), remembering_(remembering) {}

  void stand(const Pose& a, const Pose& b) override {
    a_.pose = a;
    b_.pose = b;
  }
  // Only a solver that was made with a finite limit asks for less than the distance.
  void limit(double distance) override {
    if (std::isfinite(settings_.beyond)) settings_.beyond = distance;
  }
  void run() override {
    answer_ = penetration_depth(a_, b_, scratch_, settings_, remembering_ ? &certificate_ : nullptr);
  }
  [[nodiscard]] Answer answer() const override {
    if (answer_.contact == ContactClass::separated) {
      const bool farther = answer_.distance_lower > settings_.beyond;
      return {false, 0, answer_.witness_b - answer_.witness_a,
              farther ? std::numeric_limits<double>::infinity() : answer_.distance};
    }
    return {answer_.contact == ContactClass::overlapping, answer_.depth, answer_.translation};
  }
  [[nodiscard]] double supports() const override { return static_cast<double>(answer_.statistics.support_calls); }
  [[nodiscard]] bool warm() const override { return answer_.warm; }

 private:
  PosedShape a_;
  PosedShape b_;
  Scratch& scratch_;
  DepthSettings settings_;
  bool remembering_;
  WarmCertificate certificate_;
  PenetrationDepth answer_;
};

class OurSolver final : public Solver {
 public:
  OurSolver(std::string name, const DepthSettings& settings, bool remembering)
      : name_(std::move(name)), settings_(settings), remembering_(remembering) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary64; }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<OurAttempt>(bodies, scratch_, settings_, remembering_);
  }

 private:
  std::string name_;
  DepthSettings settings_;
  bool remembering_;
  Scratch scratch_;
};

}  // namespace

void add_ours(Solvers& solvers, bool every_engine, bool remembering) {
  const auto add = [&](std::string_view name, const DepthSettings& settings, bool remembers) {
    solvers.push_back(std::make_unique<OurSolver>(std::string(name), settings, remembers));
  };
  const auto certified = [](Method method) { return DepthSettings{.method = method, .bracket = Bracket::certified}; };
  add(kOurs, certified(Method::automatic), remembering);
  if (remembering) add("pdepth-cold", certified(Method::automatic), false);
  if (!every_engine) return;
  add("pdepth-tightest", {.bracket = Bracket::tightest}, remembering);
  add("pdepth-expansion", certified(Method::expansion), false);
  add("pdepth-overlay", certified(Method::overlay), false);
  add("pdepth-decomposition", certified(Method::decomposition), false);
}

void add_ours_curved(Solvers& solvers) {
  const DepthSettings settings{.bracket = Bracket::certified, .delta = 1e-6};
  solvers.push_back(std::make_unique<OurSolver>(std::string(kOurs), settings, false));
  solvers.push_back(std::make_unique<OurSolver>("pdepth-warm", settings, true));
}

void add_ours_apart(Solvers& solvers) {
  for (const bool remembering : {false, true}) {
    const std::string warm = remembering ? "-warm" : "";
    const DepthSettings distance{.bracket = Bracket::certified};
    solvers.push_back(std::make_unique<OurSolver>("pdepth-distance" + warm, distance, remembering));
    const DepthSettings beyond{.bracket = Bracket::certified, .beyond = 0};
    solvers.push_back(std::make_unique<OurSolver>("pdepth-beyond" + warm, beyond, remembering));
  }
}

}  // namespace pd::bench
