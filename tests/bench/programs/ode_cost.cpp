/// @file
/// ODE's steps with its own contacts and with those of pdepth, on the same worlds: processor time of a step, points,
/// and where the bodies are at the end. With --record it writes records for `pdepth audit`.
#include <ode/ode.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "ode/ode_world.hpp"
#include "pd/ode/contact_recorder.hpp"
#include "pd/ode/install.hpp"

namespace {

using namespace pd;
using bench::processor_seconds;
using test::OdeWorld;

struct Scene {
  std::string name;
  std::function<void(OdeWorld&)> build;
};

Mat3 turned(double angle, const Vec3& axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

std::vector<Vec3> stone(std::mt19937& random, int vertices, double size) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; ++i) {
    points.push_back(size * Vec3{normal(random), normal(random), normal(random)}.normalized());
  }
  return points;
}

/// Four walls around the ground, into which bodies fall.
void add_basin(OdeWorld& world) {
  for (const double side : {-1.0, 1.0}) {
    test::place(dCreateBox(world.space(), 0.04, 1, 0.6), {0.5 * side, 0, 0.3});
    test::place(dCreateBox(world.space(), 1, 0.04, 0.6), {0, 0.5 * side, 0.3});
  }
}

using MakeGeom = std::function<dGeomID(OdeWorld&, int)>;

Scene heap(const std::string& name, const MakeGeom& make) {
  return {name, [make](OdeWorld& world) {
            add_basin(world);
            for (int i = 0; i < 48; ++i) {
              const Vec3 at(-0.3 + 0.2 * (i % 4), -0.3 + 0.2 * (i / 4 % 4), 0.15 + 0.22 * (i / 16));
              world.body(make(world, i), at, {0.15, 0.15, 0.15}, turned(0.3 * i, {1, 0.5 * (i % 3), 0.2}));
            }
          }};
}

std::vector<Scene> scenes() {
  return {{"stack of 10 boxes",
           [](OdeWorld& world) {
             for (int i = 0; i < 10; ++i) {
               world.box({0.2, 0.2, 0.2}, {0, 0, 0.1 + 0.2 * i}, turned(0.12 * i, Vec3::UnitZ()));
             }
           }},
          {"stack of 5 cylinders",
           [](OdeWorld& world) {
             for (int i = 0; i < 5; ++i) {
               world.body(dCreateCylinder(world.space(), 0.1, 0.2), {0, 0, 0.1 + 0.2 * i}, {0.17, 0.17, 0.2});
             }
           }},
          {"stack of 5 convex prisms",
           [](OdeWorld& world) {
             std::vector<Vec3> prism;
             for (int i = 0; i < 12; ++i) {
               const double angle = std::numbers::pi / 3 * (i / 2);
               prism.emplace_back(0.1 * std::cos(angle), 0.1 * std::sin(angle), i % 2 == 0 ? -0.1 : 0.1);
             }
             for (int i = 0; i < 5; ++i) {
               world.body(world.keep(prism).geom(world.space()), {0, 0, 0.1 + 0.2 * i}, {0.17, 0.17, 0.2},
                          turned(0.2 * i, Vec3::UnitZ()));
             }
           }},
          {"vehicle on four cylinders",
           [](OdeWorld& world) {
             test::drive_vehicle(world, Vec3::Zero(), 5);
             for (int i = 1; i < 8; ++i) test::place(dCreateBox(world.space(), 0.2, 2, 0.04), {-0.6 * i, 0, 0});
           }},
          heap("heap of 48 boxes", [](OdeWorld& world, int) { return dCreateBox(world.space(), 0.16, 0.14, 0.12); }),
          heap("heap of 48 hulls of 24",
               [](OdeWorld& world, int i) {
                 std::mt19937 random(static_cast<unsigned>(i % 8));
                 return world.keep(stone(random, 24, 0.09)).geom(world.space());
               }),
          heap("heap of 48 round bodies", [](OdeWorld& world, int i) {
            if (i % 3 == 0) return dCreateCylinder(world.space(), 0.07, 0.12);
            return i % 3 == 1 ? dCreateCapsule(world.space(), 0.05, 0.12) : dCreateSphere(world.space(), 0.08);
          })};
}

struct Run {
  double microseconds = 0;   ///< of a step
  double collision = 0;      ///< of these, until the contact joints are there
  double points = 0;         ///< of a step, in the mean
  double speed = 0;          ///< the fastest body at the end
  Vec3 last = Vec3::Zero();  ///< the position of the first body at the end
  double highest = 0;        ///< the height of the highest body at the end
};

Run run(const Scene& scene, int steps, const std::string& record) {
  OdeWorld world;
  dRandSetSeed(1);
  dCreatePlane(world.space(), 0, 0, 1, 0);
  scene.build(world);
  std::unique_ptr<OdeRecorder> recorder;
  if (!record.empty()) recorder = std::make_unique<OdeRecorder>(record.c_str());
  Run result;
  for (int step = 0; step < steps; ++step) {
    if (recorder) recorder->set_time(0.005 * step);
    const double start = processor_seconds();
    world.collide();
    result.collision += 1e6 * (processor_seconds() - start) / steps;
    world.solve(0.005);
    result.microseconds += 1e6 * (processor_seconds() - start) / steps;
    result.points += static_cast<double>(world.contacts_of_step()) / steps;
  }
  result.speed = world.fastest();
  result.last = OdeWorld::position(world.bodies().front());
  for (const dBodyID body : world.bodies()) result.highest = std::max(result.highest, OdeWorld::position(body).z());
  if (recorder && !recorder->close()) std::fprintf(stderr, "%s is incomplete\n", record.c_str());
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("ODE's steps with its own contacts and with pdepth's");
  int steps = 1000;
  int only = -1;
  std::string folder, only_who;
  OdeOptions options;
  app.add_option("--steps", steps, "steps of 5 ms");
  app.add_option("--world", only, "only this world, by its number from 0");
  app.add_option("--contacts-of", only_who, "ODE or pdepth alone")->check(CLI::IsMember({"ODE", "pdepth"}));
  app.add_flag("--remember", options.remember_pairs, "pdepth begins each pair at its last answer");
  app.add_option("--record", folder, "folder for records of both, for `pdepth audit`");
  CLI11_PARSE(app, argc, argv);
  const test::OdeLibrary library;
  std::printf("%d steps; microseconds of processor time a step\n", steps);
  std::printf(
      "| world | contacts of | step | of it collision | points | fastest at the end | highest body | first body at x "
      "|\n");
  std::printf("|---|---|---:|---:|---:|---:|---:|---:|\n");
  int number = 0;
  for (const Scene& scene : scenes()) {
    for (const bool ours : {false, true}) {
      const std::string who = ours ? "pdepth" : "ODE";
      if ((only >= 0 && only != number) || (!only_who.empty() && only_who != who)) continue;
      // The points of convex geoms are told in both runs, so that both can be recorded.
      if (ours && !install_ode(options)) return 1;
      const Run found = run(scene, steps, folder.empty() ? "" : folder + "/" + who + std::to_string(number) + ".jsonl");
      uninstall_ode();
      std::printf("| %s | %s | %.0f | %.0f | %.1f | %.1e | %.3f | %.3f |\n", scene.name.c_str(), who.c_str(),
                  found.microseconds, found.collision, found.points, found.speed, found.highest, found.last.x());
      std::fflush(stdout);
    }
    ++number;
  }
}
