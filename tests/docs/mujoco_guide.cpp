/// @file
/// Every sample of the guide "pdepth in MuJoCo" (engine_glue/mujoco/README.md), compiled and run. A check compares the
/// guide's text with the marked parts.
#include <cstdio>
#include <cstdlib>

#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/contact_recorder.hpp"
#include "pd/mujoco/install.hpp"

namespace {

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "the guide promises: %s\n", what);
  std::exit(1);
}

void install_and_uninstall(mjModel* model, mjData* data) {
  // [install]
  const auto installed = pd::install_mujoco();
  if (!installed) {
    std::fprintf(stderr, "%s\n", installed.error().message.c_str());
    std::exit(1);
  }
  for (int step = 0; step < 500; ++step) mj_step(model, data);
  pd::uninstall_mujoco();  // MuJoCo's own table again, bit for bit
  // [/install]
  expect(data->ncon == 4, "four points under a box");
}

void options(mjModel* model, mjData* data) {
  // [options]
  pd::MujocoOptions options;
  options.delta = 1e-9;           // for cylinders and ellipsoids
  options.remember_pairs = true;  // the last bits depend on the history
  options.takes_pair = [](const mjModel* m, int geom1, int geom2, void*) {
    return m->geom_group[geom1] != 5 && m->geom_group[geom2] != 5;  // geoms of group 5 keep MuJoCo's contacts
  };
  if (!pd::install_mujoco(options)) std::exit(1);
  // [/options]
  mj_step(model, data);
  // [report]
  const pd::MujocoReport report = pd::mujoco_report();
  const auto bad_poses = report.left[static_cast<std::size_t>(pd::MujocoRefusal::pose)];
  std::printf("%lld pairs answered, %lld left for their poses\n", static_cast<long long>(report.answered),
              static_cast<long long>(bad_poses));
  // [/report]
  expect(report.answered > 0, "pairs are answered");
  pd::uninstall_mujoco();
}

void record(mjModel* model, mjData* data) {
  // [record]
  if (!pd::record_mujoco(model, data, "contacts.jsonl")) std::exit(1);  // this state

  pd::MujocoRecorder recorder(model, "run.jsonl");  // or every step, whoever answers
  for (int step = 0; step < 60; ++step) mj_step(model, data);
  if (!recorder.close()) std::fprintf(stderr, "run.jsonl is incomplete\n");
  // [/record]
  expect(recorder.contacts() >= 60, "a line for every pair of every step");
}

}  // namespace

int main() {
  const auto model = pd::test::mujoco_model(
      "<worldbody><geom type='plane' size='5 5 .1'/>"
      "<body pos='0 0 .1'><freejoint/><geom type='box' size='.1 .1 .1'/></body></worldbody>");
  const auto data = pd::test::mujoco_data(model);
  install_and_uninstall(model.get(), data.get());
  options(model.get(), data.get());
  record(model.get(), data.get());
}
