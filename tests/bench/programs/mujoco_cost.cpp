/// @file
/// MuJoCo's steps with its own contacts and with those of pdepth, on the same worlds: processor time of a step, points,
/// and what is left of the motion at the end. With --record it writes records for `pdepth audit`.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/contact_recorder.hpp"
#include "pd/mujoco/install.hpp"

namespace {

using namespace pd;
using bench::processor_seconds;

struct Scene {
  std::string name;
  std::string model;
  double force = 0;  ///< on every actuator
};

std::string text_of(double x) { return std::to_string(x); }

std::string stone(std::mt19937& random, int vertices, double size) {
  std::normal_distribution<double> normal;
  std::string text;
  for (int i = 0; i < vertices; ++i) {
    double p[3] = {normal(random), normal(random), normal(random)};
    const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (const double x : p) text += text_of(size * x / length) + " ";
  }
  return text;
}

constexpr const char* kBasin =
    "<geom type='plane' size='5 5 .1'/>"
    "<geom type='box' size='.02 .5 .3' pos='.5 0 .3'/><geom type='box' size='.02 .5 .3' pos='-.5 0 .3'/>"
    "<geom type='box' size='.5 .02 .3' pos='0 .5 .3'/><geom type='box' size='.5 .02 .3' pos='0 -.5 .3'/>";

/// Bodies that fall into a basin and lie there.
Scene heap(const std::string& name, const std::string& assets, const std::vector<std::string>& geoms) {
  std::string bodies;
  for (int i = 0; i < 48; ++i) {
    bodies += "<body pos='" + text_of(-0.3 + 0.2 * (i % 4)) + " " + text_of(-0.3 + 0.2 * (i / 4 % 4)) + " " +
              text_of(0.15 + 0.22 * (i / 16)) + "' euler='" + text_of(17 * i) + " " + text_of(31 * i) +
              " 0'><freejoint/><geom " + geoms[static_cast<std::size_t>(i) % geoms.size()] + "/></body>";
  }
  return {name, "<size nconmax='2000' njmax='8000'/><asset>" + assets + "</asset><worldbody>" + kBasin + bodies +
                    "</worldbody>"};
}

std::vector<Scene> scenes() {
  std::string boxes;
  for (int i = 0; i < 10; ++i) {
    boxes += "<body pos='0 0 " + text_of(0.1 + 0.2 * i) + "' euler='0 0 " + text_of(7 * i) +
             "'><freejoint/><geom type='box' size='.1 .1 .1'/></body>";
  }
  std::string rods;
  for (int i = 0; i < 5; ++i) {
    rods += "<body pos='0 0 " + text_of(0.1 + 0.2 * i) + "'><freejoint/><geom type='cylinder' size='.1 .1'/></body>";
  }
  const auto finger = [](const char* x, const char* axis) {
    return std::string("<body pos='") + x + " 0 .5'><joint name='f" + axis + "' type='slide' axis='" + axis +
           "' damping='20'/><geom type='box' size='.02 .05 .05' mass='.1' friction='1 .01 .001'/></body>";
  };
  const std::string plane = "<geom type='plane' size='5 5 .1'/>";
  std::mt19937 random(3);
  std::string stones;
  for (int i = 0; i < 8; ++i) {
    stones += "<mesh name='s" + std::to_string(i) + "' vertex='" + stone(random, 24, 0.09) + "'/>";
  }
  std::vector<std::string> meshes;
  for (int i = 0; i < 8; ++i) meshes.push_back("type='mesh' mesh='s" + std::to_string(i) + "'");
  return {{"stack of 10 boxes", "<worldbody>" + plane + boxes + "</worldbody>"},
          {"stack of 5 cylinders", "<worldbody>" + plane + rods + "</worldbody>"},
          {"two fingers hold a cylinder",
           "<worldbody>" + finger("-.13", "1 0 0") + finger(".13", "-1 0 0") +
               "<body pos='0 0 .5' euler='90 0 0'><freejoint/><geom type='cylinder' size='.1 .06' mass='.2' "
               "friction='1 .01 .001'/></body></worldbody><actuator><motor joint='f1 0 0'/><motor joint='f-1 0 0'/>"
               "</actuator>",
           20},
          {"humanoid that falls", test::falling_humanoid()},
          heap("heap of 48 boxes", "", {"type='box' size='.08 .07 .06'"}),
          heap("heap of 48 hulls of 24", stones, meshes),
          heap("heap of 48 round bodies", "",
               {"type='cylinder' size='.07 .06'", "type='capsule' size='.05 .06'",
                "type='ellipsoid' size='.09 .07 .06'", "type='sphere' size='.08'"})};
}

struct Run {
  double microseconds = 0;  ///< of a step
  double collision = 0;     ///< of them, mj_collision
  double points = 0;        ///< of a step, in the mean
  double rounds = 0;        ///< of MuJoCo's solver, in the mean
  double speed = 0;         ///< the fastest coordinate at the end
  double gained = 0;        ///< the largest energy that came from nowhere in a step, in joules; without motors
};

Run run(const Scene& scene, int steps, const std::string& record) {
  const auto model = test::mujoco_model(scene.model);
  const auto data = test::mujoco_data(model);
  for (int i = 0; i < model->nu; ++i) data->ctrl[i] = scene.force;
  std::unique_ptr<MujocoRecorder> recorder;
  if (!record.empty()) recorder = std::make_unique<MujocoRecorder>(model.get(), record.c_str());
  Run result;
  model->opt.enableflags |= mjENBL_ENERGY;
  double before_step = HUGE_VAL;
  for (int step = 0; step < steps; ++step) {
    const double start = processor_seconds();
    mj_step(model.get(), data.get());
    result.microseconds += 1e6 * (processor_seconds() - start);
    result.points += data->ncon;
    result.rounds += data->solver_iter;
    const double energy = data->energy[0] + data->energy[1];
    if (model->nu == 0) result.gained = std::max(result.gained, energy - before_step);
    before_step = energy;
    if (recorder == nullptr && step % 10 == 0) {
      const double before = processor_seconds();
      mj_collision(model.get(), data.get());
      result.collision += 1e7 * (processor_seconds() - before);
    }
  }
  for (int i = 0; i < model->nv; ++i) result.speed = std::max(result.speed, std::abs(data->qvel[i]));
  if (recorder && !recorder->close()) std::fprintf(stderr, "%s is incomplete\n", record.c_str());
  result.microseconds /= steps;
  result.collision /= steps;
  result.points /= steps;
  result.rounds /= steps;
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("MuJoCo's steps with its own contacts and with pdepth's");
  int steps = 1500;
  std::string folder;
  app.add_option("--steps", steps, "steps of 2 ms");
  app.add_option("--record", folder, "folder for records of both, for `pdepth audit`");
  CLI11_PARSE(app, argc, argv);
  std::printf("MuJoCo %s, %d steps; microseconds of processor time a step\n", mj_versionString(), steps);
  std::printf(
      "| world | contacts of | step | of it collision | points | rounds | fastest at the end | energy gained "
      "|\n|---|---|---:|---:|---:|---:|---:|---:|\n");
  int number = 0;
  for (const Scene& scene : scenes()) {
    for (const bool ours : {false, true}) {
      if (ours && !install_mujoco()) return 1;
      const std::string who = ours ? "pdepth" : "MuJoCo";
      const std::string record = folder.empty() ? "" : folder + "/" + who + std::to_string(number) + ".jsonl";
      const Run found = run(scene, steps, record);
      uninstall_mujoco();
      std::printf("| %s | %s | %.1f | %.1f | %.1f | %.1f | %.1e | %.1e |\n", scene.name.c_str(), who.c_str(),
                  found.microseconds, found.collision, found.points, found.rounds, found.speed, found.gained);
      std::fflush(stdout);
    }
    ++number;
  }
}
