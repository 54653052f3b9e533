/// @file
/// Every sample of the guide "pdepth in ODE" (engine_glue/ode/README.md), compiled and run. A check compares the
/// guide's text with the marked parts.
#include <ode/ode.h>

#include <cstdio>
#include <cstdlib>

#include "pd/ode/contact_recorder.hpp"
#include "pd/ode/install.hpp"

namespace {

dJointGroupID joints = nullptr;
dGeomID ground = nullptr;
int contacts_in_all = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "the guide promises: %s\n", what);
  std::exit(1);
}

void near_callback(void* data, dGeomID first, dGeomID second) {
  dContact contacts[8] = {};
  const int count = dCollide(first, second, 8, &contacts[0].geom, sizeof(dContact));
  for (int i = 0; i < count; ++i) {
    contacts[i].surface.mu = 1;
    dJointAttach(dJointCreateContact(*static_cast<dWorldID*>(data), joints, &contacts[i]), dGeomGetBody(first),
                 dGeomGetBody(second));
  }
  contacts_in_all += count;
}

void install_and_uninstall(dWorldID world, dSpaceID space) {
  // [install]
  const auto installed = pd::install_ode();  // after dInitODE2
  if (!installed) {
    std::fprintf(stderr, "%s\n", installed.error().message.c_str());
    std::exit(1);
  }
  for (int step = 0; step < 200; ++step) {
    dSpaceCollide(space, &world, &near_callback);
    dWorldStep(world, 0.01);
    dJointGroupEmpty(joints);
  }
  pd::uninstall_ode();  // ODE's own answers again, bit for bit
  // [/install]
  expect(contacts_in_all >= 4 * 100, "four points under a box");
}

void report_and_convex(dSpaceID space) {
  const dReal planes[] = {0, 0, -1, 0.1, 0.9, 0, 0.4359, 0.1, -0.9, 0.3, 0.3162, 0.1, -0.9, -0.3, 0.3162, 0.1};
  const dReal points[] = {-0.1, -0.1, -0.1, 0.1, -0.1, -0.1, 0, 0.1, -0.1, 0, 0, 0.1};
  const unsigned int polygons[] = {3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3};
  const unsigned int num_planes = 4, num_points = 4;
  if (!pd::install_ode()) std::exit(1);
  // [convex]
  const dGeomID crystal = dCreateConvex(space, planes, num_planes, points, num_points, polygons);
  pd::ode_convex(crystal, points, num_points);
  // [/convex]
  dGeomSetPosition(crystal, 3, 0, 0.05);
  dContactGeom contacts[8];
  expect(dCollide(crystal, ground, 8, contacts, sizeof(dContactGeom)) == 3, "three corners of a crystal");
  // [report]
  const pd::OdeReport report = pd::ode_report();
  const auto bad_poses = report.left[static_cast<std::size_t>(pd::OdeRefusal::pose)];
  std::printf("%lld pairs answered, %lld left for their poses\n", static_cast<long long>(report.answered),
              static_cast<long long>(bad_poses));
  // [/report]
  expect(report.answered == 1, "pairs are answered");
  pd::forget_ode_convex(crystal);
  dGeomDestroy(crystal);
  pd::uninstall_ode();
}

void record(dWorldID world, dSpaceID space) {
  // [record]
  if (!pd::record_ode(space, "contacts.jsonl")) std::exit(1);  // this state

  pd::OdeRecorder recorder("run.jsonl");  // or every step, whoever answers
  for (int step = 0; step < 60; ++step) {
    recorder.set_time(0.01 * step);
    dSpaceCollide(space, &world, &near_callback);
  }
  if (!recorder.close()) std::fprintf(stderr, "run.jsonl is incomplete\n");
  // [/record]
  expect(recorder.contacts() >= 60, "a line for every pair of every step");
  dJointGroupEmpty(joints);
}

}  // namespace

int main() {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  joints = dJointGroupCreate(0);
  dWorldSetGravity(world, 0, 0, -9.81);
  ground = dCreatePlane(space, 0, 0, 1, 0);
  const dBodyID body = dBodyCreate(world);
  const dGeomID box = dCreateBox(space, 0.2, 0.2, 0.2);
  dGeomSetBody(box, body);
  dBodySetPosition(body, 0, 0, 0.1);
  install_and_uninstall(world, space);
  report_and_convex(space);
  record(world, space);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  dCloseODE();
}
