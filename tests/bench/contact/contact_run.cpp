#include "bench/contact/contact_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/measure/processor_time.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/solver_settings.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/bullet/convex_pieces.hpp"

namespace pd::bench {

namespace {

using scenes::BulletScene;
using scenes::ContactGoal;
using scenes::ContactScene;
using scenes::ConvexPiece;

double quantile_or_zero(const std::vector<double>& values, double q) {
  return values.empty() ? 0 : quantile(values, q);
}

scenes::World planned(scenes::World world, const ContactSetting& setting) {
  world.solved_at_once = setting.stacks;
  return world;
}

class Runner {
 public:
  Runner(const ContactScene& scene, const ContactSetting& setting, double seconds)
      : scene_(scene),
        setting_(setting),
        num_steps_(static_cast<int>(std::lround(seconds * setting.steps_per_second))),
        bullet_(planned(scene.world, setting), setting.run) {
    if (setting.recommended) {
      apply_recommended(bullet_.world().getSolverInfo());
    }
    if (setting.stacks) {
      bullet_.world().getSolverInfo().m_numIterations = 10;
    }
    if (setting.iterations > 0) {
      bullet_.world().getSolverInfo().m_numIterations = setting.iterations;
    }
    for (int i = 0; i < bullet_.num_bodies(); ++i) {
      starts_.push_back(to_pd(bullet_.body(i).getWorldTransform().getOrigin()));
      weight_ += scene.world.bodies[i].mass * scene.world.gravity.norm() * scene.size;
    }
    pieces_ = scenes::convex_pieces(scene.world);
    if (scene.goal == ContactGoal::rebound) rebounds_.resize(starts_.size());
    start_energy_ = scenes::mechanical_energy(bullet_).total();
    figures_.fall_seconds = seconds;
    sample_every_ = std::max(1, static_cast<int>(setting.steps_per_second / 30));
  }

  [[nodiscard]] bool done() const { return done_; }

  void step() {
    const BulletSolverStatistics before = bullet_.solver().statistics();
    const double begin = processor_seconds();
    bullet_.step(setting_.steps_per_second);
    const double end = processor_seconds();
    const BulletSolverStatistics after = bullet_.solver().statistics();
    step_ms_.push_back(1e3 * (end - begin));
    if (after.calls > before.calls) {
      query_ns_.push_back(static_cast<double>(after.nanoseconds - before.nanoseconds) /
                          static_cast<double>(after.calls - before.calls));
    }
    ++steps_;
    watch_motion();
    watch_rebounds();
    const bool late = 4 * steps_ > 3 * num_steps_;
    if (steps_ % sample_every_ == 0) {
      const double deepest = deepest_penetration();
      figures_.deepest = std::max(figures_.deepest, deepest);
      figures_.deepest_late = late ? std::max(figures_.deepest_late, deepest) : 0;
    }
    if (late) {
      count_points();
    }
    done_ = done_ || steps_ >= num_steps_;
  }

  [[nodiscard]] ContactStart finish() {
    figures_.query_ns = quantile_or_zero(query_ns_, 0.5);
    figures_.tail_speed = tail_steps_ > 0 ? tail_speed_ / tail_steps_ : 0;
    figures_.contacts = late_steps_ > 0 ? points_ / late_steps_ : 0;
    figures_.new_points = points_ > 0 ? young_ / points_ : 0;
    figures_.final_speed = static_cast<double>(bullet_.body(bullet_.first_moving()).getLinearVelocity().x());
    figures_.lost = lost();
    figures_.toppled = toppled();
    for (const Rebound& body : rebounds_) figures_.bounce_error = std::max(figures_.bounce_error, error_of(body));
    const BulletSolverStatistics statistics = bullet_.solver().statistics();
    figures_.queries = static_cast<double>(statistics.calls);
    figures_.exact_signs = static_cast<double>(statistics.exact_signs);
    figures_.wider = static_cast<double>(statistics.wider_brackets);
    return {figures_, std::move(step_ms_)};
  }

 private:
  /// A body that fell, and how high it came after that.
  struct Rebound {
    bool moves = false;
    bool up = false;    ///< it has turned
    bool down = false;  ///< it is past the top
    double top = 0;
    double low = 0;  ///< where it lies on the floor
  };

  void watch_rebounds() {
    for (std::size_t i = 0; i < rebounds_.size(); ++i) {
      Rebound& body = rebounds_[i];
      const int number = static_cast<int>(i);
      body.moves = scene_.world.bodies[i].mass > 0;
      body.low = starts_[i].z() - scene_.drop;
      const double speed = static_cast<double>(bullet_.body(number).getLinearVelocity().z());
      body.up = body.up || speed > 0;
      body.down = body.down || (body.up && speed < 0);
      if (body.up && !body.down) {
        body.top = static_cast<double>(bullet_.body(number).getWorldTransform().getOrigin().z());
      }
    }
  }
  [[nodiscard]] double error_of(const Rebound& body) const {
    if (!body.moves) return 0;
    const double kept = body.up ? (body.top - body.low) / scene_.drop : 0;
    return std::abs(kept / scene_.kept_height - 1);
  }
  [[nodiscard]] double toppled() {
    double count = 0, moving = 0;
    for (int i = 0; i < bullet_.num_bodies(); ++i) {
      if (scene_.world.bodies[i].mass == 0) continue;
      const Vec3 way = to_pd(bullet_.body(i).getWorldTransform().getOrigin()) - starts_[i];
      count += way.head<2>().norm() <= 0.5 * scene_.size ? 0 : 1;
      ++moving;
    }
    return moving > 0 ? count / moving : 0;
  }

  void watch_motion() {
    double farthest = 0;
    double fastest = 0;
    for (int i = 0; i < bullet_.num_bodies(); ++i) {
      if (scene_.world.bodies[i].mass == 0) {
        continue;
      }
      farthest = std::max(farthest, (to_pd(bullet_.body(i).getWorldTransform().getOrigin()) - starts_[i]).norm());
      fastest = std::max(fastest, static_cast<double>(bullet_.body(i).getLinearVelocity().length()));
    }
    figures_.drift = farthest / scene_.size;
    figures_.energy_gained =
        std::max(figures_.energy_gained,
                 (scenes::mechanical_energy(bullet_).total() - start_energy_) / std::max(weight_, 1e-30));
    if (10 * steps_ > 9 * num_steps_) {
      tail_speed_ += fastest;
      ++tail_steps_;
    }
    if (scene_.goal == ContactGoal::stand && !(figures_.drift <= 0.5)) {
      figures_.fall_seconds = steps_ / setting_.steps_per_second;
      done_ = true;
    }
  }

  double deepest_penetration() {
    DepthSettings settings;
    settings.bracket = Bracket::certified;
    double deepest = 0;
    scenes::for_each_near_pair(bullet_, pieces_, [&](const scenes::PosedPiece& a, const scenes::PosedPiece& b) {
      deepest = std::max(
          deepest,
          penetration_depth({a.piece.shape.get(), a.pose}, {b.piece.shape.get(), b.pose}, scratch_, settings).depth);
    });
    return deepest / scene_.size;
  }

  void count_points() {
    ++late_steps_;
    for (int i = 0; i < bullet_.dispatcher().getNumManifolds(); ++i) {
      const btPersistentManifold* manifold = bullet_.dispatcher().getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        ++points_;
        young_ += manifold->getContactPoint(k).getLifeTime() <= 1 ? 1 : 0;
      }
    }
  }

  [[nodiscard]] double lost() {
    double count = 0;
    for (int i = 0; i < bullet_.num_bodies(); ++i) {
      const Vec3 at = to_pd(bullet_.body(i).getWorldTransform().getOrigin());
      count += scene_.world.bodies[i].mass > 0 && !(at.z() > -2 * scene_.size && at.norm() < 1e3) ? 1 : 0;
    }
    return count;
  }

  const ContactScene& scene_;
  ContactSetting setting_;
  int num_steps_;
  BulletScene bullet_;
  std::vector<ConvexPiece> pieces_;
  std::vector<Vec3> starts_;
  std::vector<Rebound> rebounds_;
  Scratch scratch_;
  ContactFigures figures_;
  std::vector<double> step_ms_;
  std::vector<double> query_ns_;
  double start_energy_ = 0;
  double weight_ = 0;
  double tail_speed_ = 0;
  int tail_steps_ = 0;
  double points_ = 0;
  double young_ = 0;
  int late_steps_ = 0;
  int steps_ = 0;
  int sample_every_ = 1;
  bool done_ = false;
};

}  // namespace

void quantiles_of_steps(const std::vector<ContactStart>& starts, ContactFigures& figures) {
  std::size_t longest = 0;
  for (const ContactStart& start : starts) {
    longest = std::max(longest, start.step_ms.size());
  }
  std::vector<double> steps;
  for (std::size_t i = 0; i < longest; ++i) {
    std::vector<double> times;
    for (const ContactStart& start : starts) {
      if (i < start.step_ms.size()) {
        times.push_back(start.step_ms[i]);
      }
    }
    steps.push_back(quantile(times, 0.5));
  }
  figures.step_p50_ms = quantile_or_zero(steps, 0.5);
  figures.step_p99_ms = quantile_or_zero(steps, 0.99);
  figures.step_max_ms = quantile_or_zero(steps, 1);
}

std::vector<ContactStart> run_contact_scene(const ContactScene& scene, const std::vector<ContactSetting>& settings,
                                            double seconds) {
  std::vector<std::unique_ptr<Runner>> runners;
  for (const ContactSetting& setting : settings) {
    runners.push_back(std::make_unique<Runner>(scene, setting, seconds));
  }
  for (bool busy = true; busy;) {
    busy = false;
    for (const auto& runner : runners) {
      if (!runner->done()) {
        runner->step();
        busy = true;
      }
    }
  }
  std::vector<ContactStart> result;
  for (const auto& runner : runners) {
    result.push_back(runner->finish());
  }
  return result;
}

}  // namespace pd::bench
