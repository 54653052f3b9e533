/// @file
/// `pdepth demo stacking`: the same bodies under two solvers from the same start, side by side.
///
/// Bodies without margins, where a depth solver is asked at every contact (bullet notes: with Bullet's default margins
/// an ordinary stack asks it never). What is drawn as penetration is measured by pd_core for both.
#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "pd/bullet/contact_recorder.hpp"
#include "pd/render/renderer.hpp"
#include "report/page.hpp"
#include "report/scene_section.hpp"
#include "scenes/dropped_worlds.hpp"
#include "scenes/union_worlds.hpp"
#include "support/complain.hpp"
#include "support/demo_output.hpp"
#include "support/demo_registry.hpp"
#include "support/demo_world.hpp"
#include "support/duel.hpp"
#include "support/printable.hpp"
#include "support/report_parts.hpp"
#include "support/scene_choice.hpp"

namespace pd::demo {

namespace {

/// When the frames of the strip are taken, as shares of the whole: most happens at the start.
constexpr std::array<double, 6> kTellingShares{0, 0.06, 0.14, 0.3, 0.6, 1};
/// Depths below this are not worth an arrow.
constexpr double kStackingDepth = 2e-4;
/// Contacts that brake a body nearer than this to one that is drawn already are not drawn again.
constexpr double kGhostsApart = 0.4;

constexpr std::array<SceneChoice, 7> kStackingScenes{
    SceneChoice{"towers", "two towers of 2 cm bodies that have to stand", true, scenes::small_towers},
    SceneChoice{"tower", "a tower of 1 cm boxes at 60 steps a second, solved at once", false, scenes::centimetre_tower},
    SceneChoice{"pile", "a pile of small bodies that start inside each other", true, scenes::deep_pile},
    SceneChoice{"slide", "a box slides over a flat mesh: contacts that brake it are drawn", false,
                scenes::slide_over_mesh},
    SceneChoice{"gears", "a gear that was spun turns another", false, scenes::two_gears},
    SceneChoice{"peg", "a torus of convex pieces slides down a peg", false, scenes::torus_and_peg},
    SceneChoice{"decomposed", "fifty gears, cut into convex parts with a certified error, fall into a heap", false,
                scenes::pour_of_gears}};
/// Every so many steps contacts are recorded for the page's audit: a record of each step would be 100 MB.
constexpr int kRecordedEvery = 24;

/// One of the two worlds of a run, with all it measured.
struct Contender {
  Contender(const scenes::World& plan, SolverKind solver) : kind(solver), world(plan, solver) {
    history.push_back(world.measure());
    ghosts_by.push_back(0);
  }
  SolverKind kind;
  DemoWorld world;
  std::optional<ContactRecorder> recorder;  ///< for a page
  std::vector<Measurement> history;
  std::vector<Ghost> ghosts;           ///< drawn so far
  std::vector<std::size_t> ghosts_by;  ///< how many were met by each step
  /// Bodies' poses at each frame, so that pictures can be drawn when the shared scale is known.
  std::vector<render::Scene> frames;

  /// Counts the contacts that brake now, and keeps those that are worth drawing.
  void meet_ghosts() {
    const std::vector<Ghost> now = world.ghosts();
    ghosts_by.push_back(ghosts_by.back() + now.size());
    for (const Ghost& ghost : now) {
      const bool near = std::any_of(ghosts.begin(), ghosts.end(), [&](const Ghost& other) {
        return (other.point - ghost.point).norm() < kGhostsApart;
      });
      if (!near) ghosts.push_back(ghost);
    }
  }

  [[nodiscard]] double deepest() const {
    double result = 0;
    for (const Measurement& m : history) {
      result = std::max(result, m.deepest);
    }
    return result;
  }
  /// Of the last quarter: what is left when the start has settled.
  [[nodiscard]] double late_mean(double Measurement::*field) const {
    const std::size_t first = history.size() - std::max<std::size_t>(history.size() / 4, 1);
    double sum = 0;
    for (std::size_t i = first; i < history.size(); ++i) {
      sum += history[i].*field;
    }
    return sum / static_cast<double>(history.size() - first);
  }
  [[nodiscard]] double calls_per_step() const {
    double sum = 0;
    for (const Measurement& m : history) {
      sum += static_cast<double>(m.solver_calls);
    }
    return sum / std::max<double>(1, static_cast<double>(history.size() - 1));
  }
  [[nodiscard]] double mean(double Measurement::*field) const {
    double sum = 0;
    for (const Measurement& m : history) {
      sum += m.*field;
    }
    return sum / std::max<double>(1, static_cast<double>(history.size() - 1));
  }
};

struct Run {
  scenes::World plan;
  std::vector<std::unique_ptr<Contender>> contenders;
  std::vector<std::size_t> frame_steps;  ///< step shown by each frame
};

/// @return false where a table cannot be written.
bool write_csv(const Run& run, const std::filesystem::path& folder) {
  for (const auto& contender : run.contenders) {
    CsvFile csv(folder / fmt::format("{}_{}.csv", run.plan.name, to_string(contender->kind)),
                "step,time_s,deepest_penetration_m,total_penetration_m,overlapping_pairs,drift_m,kinetic_energy_J,"
                "potential_energy_J,contacts,solver_calls,solver_us,step_us");
    for (std::size_t i = 0; i < contender->history.size(); ++i) {
      const Measurement& m = contender->history[i];
      csv.row({static_cast<double>(i), static_cast<double>(i) / run.plan.steps_per_second, m.deepest, m.total_depth,
               static_cast<double>(m.overlapping_pairs), m.drift, m.kinetic_energy, m.potential_energy,
               static_cast<double>(m.contacts), static_cast<double>(m.solver_calls), m.solver_microseconds,
               m.step_microseconds});
    }
    if (!csv.finish()) return false;
  }
  return true;
}

nlohmann::json summary(const Run& run) {
  nlohmann::json result{{"scene", run.plan.name},
                        {"bodies", run.plan.bodies.size() - 1},
                        {"steps", run.contenders[0]->history.size() - 1},
                        {"steps_per_second", run.plan.steps_per_second}};
  for (const auto& contender : run.contenders) {
    result["solvers"].push_back({{"solver", to_string(contender->kind)},
                                 {"deepest_penetration_m", contender->deepest()},
                                 {"late_mean_penetration_m", contender->late_mean(&Measurement::deepest)},
                                 {"final_drift_m", contender->history.back().drift},
                                 {"final_forward_speed_m_s", contender->history.back().forward_speed},
                                 {"braking_contacts", contender->ghosts_by.back()},
                                 {"late_mean_kinetic_energy_J", contender->late_mean(&Measurement::kinetic_energy)},
                                 {"solver_calls_per_step", contender->calls_per_step()},
                                 {"solver_us_per_step", contender->mean(&Measurement::solver_microseconds)},
                                 {"step_us", contender->mean(&Measurement::step_microseconds)}});
  }
  return result;
}

/// "penetration 0.01 mm / 2.31 mm      moved from the start 0.2 mm / 34 mm"
std::string statement(const Run& run, std::size_t step) {
  const Measurement& first = run.contenders[0]->history[step];
  const Measurement& second = run.contenders[1]->history[step];
  const std::string depth = fmt::format("penetration {} / {}", length_text(first.deepest), length_text(second.deepest));
  if (run.plan.should_glide) {
    return fmt::format("speed {:.2f} / {:.2f} m/s      contacts that brake {} / {}", first.forward_speed,
                       second.forward_speed, run.contenders[0]->ghosts_by[step], run.contenders[1]->ghosts_by[step]);
  }
  return run.plan.should_stand ? fmt::format("{}      moved from the start {} / {}", depth, length_text(first.drift),
                                             length_text(second.drift))
                               : fmt::format("{}      kinetic energy {} / {}", depth, energy_text(first.kinetic_energy),
                                             energy_text(second.kinetic_energy));
}

/// Where a body should keep its speed, that is what is said of its world.
void show_speed(const Contender& contender, std::size_t step, Half& half) {
  const double wanted = contender.history.front().forward_speed;
  const double speed = contender.history[step].forward_speed;
  half.headline = render::Headline{fmt::format("{:.2f} m/s", speed), "speed",
                                   speed > 0.99 * wanted ? render::palette::kGood : render::palette::kTrouble};
  for (std::size_t i = 0; i < contender.history.size(); ++i) {
    half.curve.values[i] = std::max(contender.history[i].forward_speed, 0.0);
  }
  half.curve.meaning = "speed";
  half.curve.full_scale = wanted;
  half.curve.full_scale_text = fmt::format("{:.0f} m/s", wanted);
}

/// One of the two worlds at one of its frames.
Half half_of(const Contender& contender, const Run& run, std::size_t frame, double full_scale) {
  const std::size_t step = run.frame_steps[frame];
  Half half;
  half.scene = contender.frames[frame];
  half.depth = contender.history[step].deepest;
  half.heading = std::string(describe(contender.kind));
  half.status = fmt::format("{:.2f} s   step {}", static_cast<double>(step) / run.plan.steps_per_second, step);
  for (const Measurement& m : contender.history) {
    half.curve.values.push_back(m.deepest);
  }
  half.curve.now = step;
  half.curve.meaning = "deepest penetration";
  half.curve.full_scale = full_scale;
  half.curve.full_scale_text = length_text(full_scale);
  if (run.plan.should_glide) show_speed(contender, step, half);
  return half;
}

/// Steps both worlds together and keeps what each frame will show.
void simulate(Run& run, int steps) {
  const int steps_per_frame = std::max(1, static_cast<int>(run.plan.steps_per_second) / kFramesPerSecond);
  const auto keep_frame = [&](std::size_t step) {
    run.frame_steps.push_back(step);
    for (const auto& contender : run.contenders) {
      const Measurement& now = contender->history[step];
      render::Scene scene = contender->world.picture(now, kStackingDepth);
      if (now.deepest > kStackingDepth && !run.plan.should_glide) {
        const PenetrationDepth& answer = now.deepest_answer;
        scene.arrows.push_back({answer.witness_a, answer.witness_b, length_text(answer.depth)});
      }
      for (const Ghost& ghost : contender->ghosts) {
        scene.arrows.push_back({ghost.point, ghost.point + 0.8 * ghost.normal, {}, render::palette::kTrouble, 4});
      }
      contender->frames.push_back(std::move(scene));
    }
  };
  Progress progress(run.plan.name + ": simulating", steps);
  keep_frame(0);
  for (int step = 1; step <= steps && !interrupted(); ++step) {
    for (const auto& contender : run.contenders) {
      contender->history.push_back(contender->world.step());
      if (run.plan.should_glide) contender->meet_ghosts();
    }
    if (step % steps_per_frame == 0) {
      keep_frame(static_cast<std::size_t>(step));
    }
    progress.show(step);
  }
}

Expected<int> draw_run(const Run& run, const DemoOptions& options, const std::filesystem::path& folder,
                       render::Renderer& renderer) {
  DuelPlan plan{folder,
                run.plan.name,
                run.plan.title,
                run.plan.should_glide ? "below: speed; arrows: contacts that braked"
                                      : "below: deepest penetration of any two bodies",
                {options.width, options.height},
                {},
                {run.plan.view_azimuth, run.plan.view_elevation},
                kStackingDepth,
                options.video};
  plan.view.include(run.plan.view_lower);
  plan.view.include(run.plan.view_upper);
  auto opened = DuelFilm::open(plan, renderer);
  if (!opened) {
    return opened.error();
  }
  DuelFilm film = std::move(opened).value();
  double full_scale = 1e-4;
  for (const auto& contender : run.contenders) {
    full_scale = std::max(full_scale, contender->deepest());
  }
  const int frames = static_cast<int>(run.frame_steps.size());
  std::array<int, kTellingShares.size()> telling{};
  for (std::size_t i = 0; i < telling.size(); ++i) {
    telling[i] = static_cast<int>(kTellingShares[i] * (frames - 1));
  }
  Progress progress(run.plan.name + ": drawing", frames);
  for (int i = 0; i < frames && !interrupted(); ++i) {
    const auto frame = static_cast<std::size_t>(i);
    const Half left = half_of(*run.contenders[0], run, frame, full_scale);
    const Half right = half_of(*run.contenders[1], run, frame, full_scale);
    const auto added = film.add_frame(left, right, statement(run, run.frame_steps[frame]));
    if (!added) {
      return added.error();
    }
    if (std::find(telling.begin(), telling.end(), i) != telling.end()) {
      const double seconds = static_cast<double>(run.frame_steps[frame]) / run.plan.steps_per_second;
      const auto kept = film.add_moment(left, right, fmt::format("{:.2f} s", seconds));
      if (!kept) {
        return kept.error();
      }
    }
    progress.show(i + 1);
  }
  return film.finish();
}

std::filesystem::path record_of(const Run& run, const Contender& contender) {
  return fmt::format("{}_{}.jsonl", run.plan.name, to_string(contender.kind));
}

/// The deepest pair of a contender's whole run.
std::string deepest_pair(const Run& run, const Contender& contender) {
  const auto deepest = std::max_element(contender.history.begin(), contender.history.end(),
                                        [](const auto& x, const auto& y) { return x.deepest < y.deepest; });
  if (deepest->deepest_a < 0) return {};
  const Measurement& m = *deepest;
  const auto step = static_cast<double>(deepest - contender.history.begin());
  return report::pair_figure(answered_pair(
      {m.deepest_piece_a.get(), m.deepest_pose_a}, {m.deepest_piece_b.get(), m.deepest_pose_b}, m.deepest_answer,
      fmt::format("{}: deepest pair of the run, {} at {:.2f} s", describe(contender.kind), length_text(m.deepest),
                  step / run.plan.steps_per_second),
      fmt::format("{}_{}_deepest", run.plan.name, to_string(contender.kind))));
}

/// The scene as a section of the page: frames, curves, pairs and the audit of what was recorded.
std::string section_of(const Run& run, const DemoOptions& options, const std::filesystem::path& folder) {
  report::SceneSection section;
  section.name = run.plan.name;
  section.title = run.plan.title;
  section.text =
      "The same start under two solvers. Penetration is the exact depth of the deepest pair of bodies, "
      "measured on the poses that each solver arrived at.";
  for (std::size_t i = 0; i < run.contenders[0]->history.size(); ++i) {
    section.times.push_back(static_cast<double>(i) / run.plan.steps_per_second);
  }
  const auto add = [&](const char* name, const char* unit, const auto& value) {
    report::Quantity quantity{name, unit, {}};
    for (const auto& contender : run.contenders) {
      quantity.values.emplace_back();
      for (const Measurement& m : contender->history) quantity.values.back().push_back(static_cast<double>(value(m)));
    }
    section.quantities.push_back(std::move(quantity));
  };
  add("deepest penetration", "m", [](const Measurement& m) { return m.deepest; });
  add("moved from the start", "m", [](const Measurement& m) { return m.drift; });
  if (run.plan.should_glide) add("speed forward", "m/s", [](const Measurement& m) { return m.forward_speed; });
  add("kinetic energy", "J", [](const Measurement& m) { return m.kinetic_energy; });
  add("contact points", "", [](const Measurement& m) { return m.contacts; });
  add("overlapping pairs", "", [](const Measurement& m) { return m.overlapping_pairs; });
  add("depth queries a step", "", [](const Measurement& m) { return m.solver_calls; });
  std::vector<RecordOfRun> records;
  std::vector<std::string> deepest;
  for (const auto& contender : run.contenders) {
    section.contenders.emplace_back(describe(contender->kind));
    records.push_back({folder / record_of(run, *contender), std::string(describe(contender->kind))});
    deepest.push_back(deepest_pair(run, *contender));
  }
  for (std::size_t i = 0; i < run.frame_steps.size(); ++i) {
    const std::string file = fmt::format("frames/{}_{:04d}.png", run.plan.name, i);
    section.frames.push_back({page_file(options, file), run.frame_steps[i]});
  }
  section.shown = section.frames.size() * 3 / 10;
  section.more = report::picture(page_file(options, run.plan.name + "_strip.png"), run.plan.title + ": six moments") +
                 "<h3>The deepest pairs</h3>\n" + report::pairs(deepest) + audited_records(options, records);
  return report::scene_section(section);
}

void add_to_page(const Run& run, const DemoOptions& options, const std::filesystem::path& folder) {
  using Rank = report::Card::Rank;
  std::vector<double> late;
  for (const auto& contender : run.contenders) late.push_back(contender->late_mean(&Measurement::deepest));
  for (std::size_t i = 0; i < late.size(); ++i) {
    options.page->cards.push_back(
        {length_text(late[i]),
         fmt::format("{}: penetration left, {}", run.plan.name, to_string(run.contenders[i]->kind)),
         late[i] <= *std::min_element(late.begin(), late.end()) ? Rank::good : Rank::bad});
  }
  options.page->sections.push_back(section_of(run, options, folder));
}

void print_headline(const Run& run) {
  fmt::print("{}: {} bodies, {} steps of 1/{:.0f} s\n", run.plan.title, run.plan.bodies.size() - 1,
             run.contenders[0]->history.size() - 1, run.plan.steps_per_second);
  fmt::print("  {:<46} {:>12} {:>12} {:>12} {:>14} {:>12}\n", "", "deepest", "late mean", "moved", "calls a step",
             "step");
  for (const auto& contender : run.contenders) {
    fmt::print("  {:<46} {:>12} {:>12} {:>12} {:>14.1f} {:>9.0f} us\n", describe(contender->kind),
               length_text(contender->deepest()), length_text(contender->late_mean(&Measurement::deepest)),
               length_text(contender->history.back().drift), contender->calls_per_step(),
               contender->mean(&Measurement::step_microseconds));
  }
}

}  // namespace

int run_stacking(const DemoOptions& options) {
  const auto first = solver_kind(options.solver.empty() ? "exact" : options.solver);
  if (!first) {
    report_failure(first.error());
    return kDemoBadUsage;
  }
  // The rival of a pdepth solver is Bullet's EPA; Bullet's solvers are shown against the exact one.
  const bool ours = *first == SolverKind::exact || *first == SolverKind::approximate;
  const SolverKind second = ours ? SolverKind::bullet_epa : SolverKind::exact;
  const auto worlds = choose_scenes(options, kStackingScenes);
  if (!worlds) {
    report_failure(worlds.error());
    return kDemoBadUsage;
  }
  if (worlds.value().empty()) return kDemoDone;
  std::filesystem::path folder;
  if (const int code = open_output_folder(options, "stacking", folder); code != kDemoDone) return code;
  auto renderer = render::Renderer::create();
  if (!renderer) {
    return report_failure(renderer.error());
  }
  auto device = std::move(renderer).value();
  note_interrupts();
  nlohmann::json figures = nlohmann::json::array();
  for (const scenes::World& plan : worlds.value()) {
    Run run;
    run.plan = plan;
    run.contenders.push_back(std::make_unique<Contender>(plan, *first));
    run.contenders.push_back(std::make_unique<Contender>(plan, second));
    if (options.page != nullptr) {
      for (const auto& contender : run.contenders) {
        contender->recorder.emplace(contender->world.bullet(), (folder / record_of(run, *contender)).c_str(),
                                    ContactRecorderSettings{kRecordedEvery});
      }
    }
    simulate(run, options.steps > 0 ? options.steps : plan.steps);
    for (const auto& contender : run.contenders) {
      if (contender->recorder && !contender->recorder->close()) {
        return report_failure({ErrorCode::bad_value, "a record cannot be written", folder.string()});
      }
    }
    if (!write_csv(run, folder)) {
      return report_failure({ErrorCode::bad_value, "a table cannot be written", folder.string()});
    }
    figures.push_back(summary(run));
    if (!write_whole_file(folder / "stacking.json", figures.dump(2) + "\n")) {
      return report_failure({ErrorCode::bad_value, "stacking.json cannot be written", folder.string()});
    }
    const auto drawn = draw_run(run, options, folder, device);
    if (!drawn) {
      return report_failure(drawn.error());
    }
    print_headline(run);
    if (options.page != nullptr) add_to_page(run, options, folder);
    if (interrupted()) {
      complain("stopped; what was done is in {}", folder.string());
      return kDemoInterrupted;
    }
  }
  fmt::print("Pictures, figures and films: {}\n", printable(folder.string()));
  return kDemoDone;
}

}  // namespace pd::demo
