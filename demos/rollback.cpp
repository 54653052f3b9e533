/// @file
/// `pdepth demo rollback`: bodies thrown fast at each other. A plain step ends deep inside; the rollback stepper
/// restores the state, bit for bit, and advances it to the first contact.
#include "pd/bullet/rollback.hpp"

#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/render/composition.hpp"
#include "pd/render/renderer.hpp"
#include "rollback/rollback_course.hpp"
#include "support/demo_output.hpp"
#include "support/demo_registry.hpp"
#include "support/demo_world.hpp"
#include "support/duel.hpp"
#include "support/printable.hpp"
#include "support/scene_choice.hpp"

namespace pd::demo {

namespace {

/// Frames of the film for one step (slow motion), and for a step in which a contact was taken back.
constexpr int kFramesPerStep = 2;
constexpr int kFramesPerImpact = 15;
/// Depths below this are not worth an arrow.
constexpr double kRollbackDepth = 2e-3;

constexpr std::array<SceneChoice, 2> kRollbackScenes{
    SceneChoice{"throws", "a crystal, a box and a stone meet a wall and each other", true, scenes::fast_throws},
    SceneChoice{"foil", "spinning rods meet a wall of one millimetre", false, scenes::rods_at_a_foil}};

double signed_depth(const MovingShape& a, const MovingShape& b, double time, Scratch& scratch) {
  return -penetration_depth({a.start.shape, pose_at(a, time)}, {b.start.shape, pose_at(b, time)}, scratch)
              .signed_distance();
}

btTransform to_transform(const Pose& pose) {
  const Mat3& r = pose.rotation();
  const btMatrix3x3 basis(
      static_cast<btScalar>(r(0, 0)), static_cast<btScalar>(r(0, 1)), static_cast<btScalar>(r(0, 2)),
      static_cast<btScalar>(r(1, 0)), static_cast<btScalar>(r(1, 1)), static_cast<btScalar>(r(1, 2)),
      static_cast<btScalar>(r(2, 0)), static_cast<btScalar>(r(2, 1)), static_cast<btScalar>(r(2, 2)));
  return btTransform(basis, to_bullet(pose.translation()));
}

/// The exact time beside what Bullet's own casts say about the same motion.
std::vector<Verdict> compare_methods(const Impact& impact, const btConvexShape& shape_a, const btConvexShape& shape_b) {
  Scratch scratch;
  std::vector<Verdict> verdicts;
  const TimeOfImpact exact = time_of_impact(impact.moving_a, impact.moving_b, impact.step, scratch);
  verdicts.push_back({"pdepth, exact", exact.hit, exact.time, 0});

  const btTransform a0 = to_transform(pose_at(impact.moving_a, 0));
  const btTransform a1 = to_transform(pose_at(impact.moving_a, impact.step));
  const btTransform b0 = to_transform(pose_at(impact.moving_b, 0));
  const btTransform b1 = to_transform(pose_at(impact.moving_b, impact.step));
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver epa;
  btContinuousConvexCollision continuous(&shape_a, &shape_b, &simplex, &epa);
  btGjkConvexCast gjk(&shape_a, &shape_b, &simplex);
  btSubsimplexConvexCast subsimplex(&shape_a, &shape_b, &simplex);
  const std::pair<const char*, btConvexCast*> casts[] = {
      {"btContinuousConvexCollision", &continuous}, {"btGjkConvexCast", &gjk}, {"btSubsimplexConvexCast", &subsimplex}};
  for (const auto& [name, cast] : casts) {
    btConvexCast::CastResult result;
    result.m_fraction = btScalar(1);
    const bool hit = cast->calcTimeOfImpact(a0, a1, b0, b1, result);
    verdicts.push_back({name, hit, static_cast<double>(result.m_fraction) * impact.step, 0});
  }
  for (Verdict& verdict : verdicts) {
    const double when = verdict.hit ? verdict.time : impact.step;
    verdict.depth = signed_depth(impact.moving_a, impact.moving_b, when, scratch);
  }
  return verdicts;
}

MovingShape moving(DemoWorld& world, int i, const btTransform& start, const btTransform& end, double step) {
  MovingShape result{{&world.shape(i), to_pd(start)}, {}};
  btVector3 linear;
  btVector3 angular;
  btTransformUtil::calculateVelocity(start, end, static_cast<btScalar>(step), linear, angular);
  result.motion = {to_pd(linear), to_pd(angular)};
  return result;
}

/// Pictures of the two bodies of one impact from nearby.
class CloseUp {
 public:
  CloseUp(render::Renderer& renderer, render::Size whole) : renderer_(renderer), size_(render::panel_size(whole, 3)) {}

  /// A camera that sees both bodies through all of the step.
  void look_at(const Impact& impact) {
    view_ = render::Box();
    for (const MovingShape* body : {&impact.moving_a, &impact.moving_b}) {
      if (body->motion.linear_velocity.norm() == 0) {
        continue;
      }
      const render::MeshRef mesh = render::shape_mesh(*body->start.shape);
      for (const double time : {0.7 * impact.contact.time, impact.contact.time, impact.step}) {
        view_.include(render::posed_bounds(*mesh, pose_at(*body, time)));
      }
    }
    camera_ = render::frame_box(view_, size_, {-102, 13}, {0.05, 0.05, 0.06, 0.06});
  }

  Expected<render::Image> draw(render::Scene scene) {
    scene.focus = view_;
    return renderer_.draw(scene, camera_, size_);
  }

 private:
  render::Renderer& renderer_;
  render::Size size_;
  render::Box view_;
  render::Camera camera_;
};

/// The two bodies of an impact at a time of the step, everything else left out of focus.
render::Scene moment(DemoWorld& world, const Impact& impact, double time, bool contact_disc) {
  Scratch scratch;
  render::Scene scene;
  const Pose pose_a = pose_at(impact.moving_a, time);
  const Pose pose_b = pose_at(impact.moving_b, time);
  for (const auto& [index, pose] : {std::pair{impact.a, pose_a}, std::pair{impact.b, pose_b}}) {
    render::Body body;
    body.mesh = render::shape_mesh(world.shape(index));
    body.pose = pose;
    body.colour = render::palette::categorical(static_cast<std::size_t>(world.description(index).colour));
    body.highlight = world.description(index).mass > 0;
    body.opacity = world.description(index).mass > 0 ? 1.0f : 0.4f;
    scene.bodies.push_back(std::move(body));
  }
  const PenetrationDepth answer =
      penetration_depth({impact.moving_a.start.shape, pose_a}, {impact.moving_b.start.shape, pose_b}, scratch);
  if (answer.contact == ContactClass::overlapping) {
    scene.arrows.push_back(
        {answer.witness_a, answer.witness_b,
         fmt::format("{}\n[{:.6g}, {:.6g}] m", length_text(answer.depth), answer.lower, answer.upper)});
  } else if (contact_disc) {
    scene.discs.push_back({answer.witness_b, answer.normal});
  }
  return scene;
}

/// Before, at and after the contact, in one picture.
Expected<std::filesystem::path> draw_triptych(DemoWorld& world, const Impact& impact, int number, CloseUp& close_up,
                                              render::Size whole, const std::filesystem::path& folder) {
  close_up.look_at(impact);
  const double first = impact.verdicts[0].time;
  struct Moment {
    double time;
    std::string heading;
    bool disc;
  };
  const Moment moments[] = {{0.7 * first, fmt::format("before, {}", time_text(0.7 * first)), false},
                            {first, fmt::format("first contact, {}", time_text(first)), true},
                            {impact.step, fmt::format("end of the plain step, {}", time_text(impact.step)), false}};
  std::vector<render::Panel> panels;
  for (const Moment& m : moments) {
    auto drawn = close_up.draw(moment(world, impact, m.time, m.disc));
    if (!drawn) {
      return drawn.error();
    }
    panels.push_back({std::move(drawn).value(), m.heading});
  }
  const std::string undone = impact.plain_depth > 0 ? length_text(impact.plain_depth) + " deep"
                                                    : std::string("behind each other, no contact left");
  return render::write_png(
      render::side_by_side(
          panels, "Taken back to the first contact",
          fmt::format("a plain step ends {}, the rollback {} apart", undone, length_text(impact.contact.gap)), whole),
      folder / fmt::format("impact_{}.png", number));
}

/// Replays the coming step from a snapshot and compares every number of every body.
bool replay_is_exact(DemoWorld& world, double step) {
  const auto numbers = [&] {
    std::vector<btScalar> result;
    for (int i = 0; i < world.num_bodies(); ++i) {
      const btRigidBody& body = world.body(i);
      for (const btVector3& v : {body.getWorldTransform().getOrigin(), body.getWorldTransform().getBasis()[0],
                                 body.getWorldTransform().getBasis()[1], body.getWorldTransform().getBasis()[2],
                                 body.getLinearVelocity(), body.getAngularVelocity()}) {
        result.insert(result.end(), {v.x(), v.y(), v.z()});
      }
    }
    return result;
  };
  const BulletSnapshot snapshot(world.bullet(), &world.solver());
  world.bullet().stepSimulation(static_cast<btScalar>(step), 0);
  const auto first = numbers();
  const bool back = snapshot.restore() == Restored::yes;
  world.bullet().stepSimulation(static_cast<btScalar>(step), 0);
  const bool same = back && numbers() == first;
  return snapshot.restore() == Restored::yes && same;
}

nlohmann::json to_json(const Course& course, DemoWorld& world) {
  nlohmann::json result{{"steps", course.steps},
                        {"simulation_steps", course.simulation_steps},
                        {"deepest_plain_m", course.deepest_plain},
                        {"deepest_rollback_m", course.deepest_rollback},
                        {"replay_bit_for_bit", course.replay_same_bits},
                        {"impacts", nlohmann::json::array()}};
  for (const Impact& impact : course.impacts) {
    nlohmann::json entry{
        {"body_a", impact.a},
        {"body_b", impact.b},
        {"speed_m_per_s", (impact.moving_a.motion.linear_velocity - impact.moving_b.motion.linear_velocity).norm()},
        {"time_in_step_s", impact.contact.time},
        {"trials", impact.contact.trials},
        {"gap_m", impact.contact.gap},
        {"plain_step_depth_m", impact.plain_depth}};
    for (const Verdict& verdict : impact.verdicts) {
      entry["methods"].push_back({{"method", verdict.method},
                                  {"hit", verdict.hit},
                                  {"time_in_step_s", verdict.time},
                                  {"depth_then_m", verdict.depth}});
    }
    result["impacts"].push_back(entry);
  }
  result["bodies"] = world.num_bodies();
  return result;
}

void print_headline(const Course& course) {
  fmt::print("Rollback: {} first contacts in {} steps of 1/60 s; {} simulation steps in all\n", course.impacts.size(),
             course.steps, course.simulation_steps);
  fmt::print("  deepest penetration of thrown bodies: plain {}, with rollback {}\n", length_text(course.deepest_plain),
             length_text(course.deepest_rollback));
  fmt::print("  a step replayed from its snapshot gives {}\n",
             course.replay_same_bits ? "the same bits, in every step" : "OTHER BITS");
  for (std::size_t i = 0; i < course.impacts.size(); ++i) {
    const Impact& impact = course.impacts[i];
    fmt::print("  impact {}: plain step ends {} deep; stopped {} apart after {} trials\n", i + 1,
               length_text(impact.plain_depth), length_text(impact.contact.gap), impact.contact.trials);
    for (const Verdict& verdict : impact.verdicts) {
      fmt::print("    {:<28} {:>14}   {}\n", verdict.method, verdict.hit ? time_text(verdict.time) : "missed",
                 verdict.depth > 0 ? length_text(verdict.depth) + " deep by then"
                                   : length_text(-verdict.depth) + " apart then");
    }
  }
}

/// The rollback world's next step: what a plain step would do, then the step that stops at contacts.
void advance(DemoWorld& world, RollbackStepper& stepper, double step, Course& course) {
  const int count = world.num_bodies();
  const auto poses = [&] {
    std::vector<btTransform> result;
    for (int i = 0; i < count; ++i) {
      result.push_back(world.body(i).getWorldTransform());
    }
    return result;
  };
  course.replay_same_bits = replay_is_exact(world, step) && course.replay_same_bits;
  const std::vector<btTransform> start = poses();
  const BulletSnapshot snapshot(world.bullet(), &world.solver());
  world.bullet().stepSimulation(static_cast<btScalar>(step), 0);
  const std::vector<btTransform> plain_end = poses();
  course.replay_same_bits = snapshot.restore() == Restored::yes && course.replay_same_bits;
  const RollbackReport report = stepper.step(static_cast<btScalar>(step));
  course.simulation_steps += report.simulation_steps;
  ++course.steps;
  std::vector<bool> met(static_cast<std::size_t>(count), false);
  for (const FirstContact& contact : report.contacts) {
    Impact impact;
    impact.a = world.index_of(contact.body_a);
    impact.b = world.index_of(contact.body_b);
    // A body that met something earlier in this step no longer moves as the plain step said.
    const bool undisturbed = !met[impact.a] && !met[impact.b];
    met[impact.a] = met[impact.a] || world.description(impact.a).mass > 0;
    met[impact.b] = met[impact.b] || world.description(impact.b).mass > 0;
    if (!undisturbed || !world.description(impact.a).drawn || !world.description(impact.b).drawn) {
      continue;
    }
    impact.step = step;
    impact.contact = contact;
    impact.moving_a = moving(world, impact.a, start[impact.a], plain_end[impact.a], step);
    impact.moving_b = moving(world, impact.b, start[impact.b], plain_end[impact.b], step);
    Scratch scratch;
    impact.plain_depth = std::max(0.0, signed_depth(impact.moving_a, impact.moving_b, step, scratch));
    impact.verdicts =
        compare_methods(impact, static_cast<const btConvexShape&>(*world.body(impact.a).getCollisionShape()),
                        static_cast<const btConvexShape&>(*world.body(impact.b).getCollisionShape()));
    course.impacts.push_back(std::move(impact));
  }
}

/// One of the two worlds at the end of a step.
Half half_of(DemoWorld& world, const Measurement& now, const std::vector<double>& depths, double full_scale,
             const std::string& heading, const std::string& status) {
  Half half{world.picture(now, kRollbackDepth), now.deepest, {}, heading, status, {}};
  if (now.deepest > kRollbackDepth) {
    const PenetrationDepth& answer = now.deepest_answer;
    half.scene.arrows.push_back({answer.witness_a, answer.witness_b, length_text(answer.depth)});
  }
  half.curve = {depths, depths.size() - 1, "deepest penetration", full_scale, length_text(full_scale)};
  return half;
}

/// Adds a step to the film: longer where it tells something, and then to the strip, too.
std::optional<Error> film_step(DuelFilm& film, const Half& first, const Half& second, const std::string& said,
                               bool telling, bool moment, const std::string& time) {
  const auto added = film.add_frame(first, second, said, telling ? kFramesPerImpact : kFramesPerStep);
  if (!added) return added.error();
  if (!moment || film.num_moments() >= 6) return std::nullopt;
  const auto kept = film.add_moment(first, second, time);
  if (!kept) return kept.error();
  return std::nullopt;
}

/// The impacts from number `known` on, each before, at and after its first contact.
std::optional<Error> draw_impacts(DemoWorld& world, const Course& course, std::size_t known, CloseUp& close_up,
                                  render::Size size, const std::filesystem::path& folder) {
  for (std::size_t k = known; k < course.impacts.size(); ++k) {
    const auto drawn = draw_triptych(world, course.impacts[k], static_cast<int>(k) + 1, close_up, size, folder);
    if (!drawn) return drawn.error();
  }
  return std::nullopt;
}

/// Runs both worlds, drawing as they go. @return how many frames there are.
Expected<int> run_course(const scenes::World& plan, SolverKind kind, int steps, const DemoOptions& options,
                         const std::filesystem::path& folder, render::Renderer& renderer, Course& course,
                         CourseRows& rows, std::vector<std::string>& figures) {
  const double step = 1 / plan.steps_per_second;
  DemoWorld plain(plan, kind);
  DemoWorld guarded(plan, SolverKind::exact);
  RollbackStepper stepper(guarded.bullet(), guarded.solver());
  const render::Size whole{options.width, options.height};
  CloseUp close_up(renderer, whole);
  DuelPlan duel{folder,
                "rollback",
                plan.title,
                "below: penetration at the end of the step",
                whole,
                {},
                {plan.view_azimuth, plan.view_elevation},
                kRollbackDepth,
                options.video};
  duel.view.include(plan.view_lower);
  duel.view.include(plan.view_upper);
  auto opened = DuelFilm::open(duel, renderer);
  if (!opened) {
    return opened.error();
  }
  DuelFilm film = std::move(opened).value();
  CsvFile csv(folder / "rollback.csv",
              "step,time_s,plain_deepest_m,rollback_deepest_m,plain_kinetic_energy_J,rollback_kinetic_energy_J");
  // The scale of the sparkline stays put: the smallest thrown body.
  const double full_scale = 0.3;
  Progress progress("rollback", steps);
  for (int i = 0; i <= steps && !interrupted(); ++i) {
    const std::size_t known = course.impacts.size();
    if (i > 0) {
      plain.bullet().stepSimulation(static_cast<btScalar>(step), 0);
      advance(guarded, stepper, step, course);
    }
    const Measurement left = plain.measure();
    const Measurement right = guarded.measure();
    course.deepest_plain = std::max(course.deepest_plain, left.deepest);
    course.deepest_rollback = std::max(course.deepest_rollback, right.deepest);
    csv.row({static_cast<double>(i), i * step, left.deepest, right.deepest, left.kinetic_energy, right.kinetic_energy});
    rows.times.push_back(i * step);
    rows.plain_depths.push_back(left.deepest);
    rows.rollback_depths.push_back(right.deepest);
    rows.plain_energies.push_back(left.kinetic_energy);
    rows.rollback_energies.push_back(right.kinetic_energy);
    const std::string status = fmt::format("{:.1f} ms   step {}", 1e3 * i * step, i);
    const Half first = half_of(plain, left, rows.plain_depths, full_scale, "plain steps", status);
    const Half second =
        half_of(guarded, right, rows.rollback_depths, full_scale, "taken back to first contact", status);
    const std::string said = fmt::format("penetration at the end of the step {} / {}", length_text(left.deepest),
                                         length_text(right.deepest));
    const bool telling = course.impacts.size() > known || left.deepest > 10 * kRollbackDepth;
    const std::string time = fmt::format("{:.0f} ms", 1e3 * i * step);
    if (auto error = film_step(film, first, second, said, telling, telling || i == 0, time)) return *std::move(error);
    if (auto error = draw_impacts(guarded, course, known, close_up, whole, folder)) return *std::move(error);
    if (!write_whole_file(folder / "rollback.json", to_json(course, guarded).dump(2) + "\n")) {
      return Error{ErrorCode::bad_value, "rollback.json cannot be written", folder.string()};
    }
    progress.show(i);
  }
  if (!csv.finish()) return Error{ErrorCode::bad_value, "rollback.csv cannot be written", folder.string()};
  for (std::size_t k = 0; options.page != nullptr && k < course.impacts.size(); ++k) {
    if (course.impacts[k].plain_depth > 0) figures.push_back(plain_end_figure(course.impacts[k], k + 1));
  }
  return film.finish();
}

}  // namespace

int run_rollback(const DemoOptions& options) {
  // The plain world's solver; the other world has the exact one, whose signed distance the search needs.
  const auto kind = solver_kind(options.solver.empty() ? "exact" : options.solver);
  if (!kind) {
    report_failure(kind.error());
    return kDemoBadUsage;
  }
  const auto worlds = choose_scenes(options, kRollbackScenes);
  if (!worlds) {
    report_failure(worlds.error());
    return kDemoBadUsage;
  }
  if (worlds.value().empty()) return kDemoDone;
  std::filesystem::path folder;
  if (const int code = open_output_folder(options, "rollback", folder); code != kDemoDone) return code;
  auto renderer = render::Renderer::create();
  if (!renderer) {
    return report_failure(renderer.error());
  }
  auto device = std::move(renderer).value();
  note_interrupts();
  const scenes::World& plan = worlds.value().front();
  Course course;
  CourseRows rows;
  std::vector<std::string> figures;
  const auto frames = run_course(plan, *kind, options.steps > 0 ? options.steps : plan.steps, options, folder, device,
                                 course, rows, figures);
  if (!frames) {
    return report_failure(frames.error());
  }
  print_headline(course);
  if (options.page != nullptr) add_to_page(course, rows, figures, plan.title, options);
  fmt::print("Pictures, figures and films: {}\n", printable(folder.string()));
  return interrupted() ? kDemoInterrupted : kDemoDone;
}

}  // namespace pd::demo
