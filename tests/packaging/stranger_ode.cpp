/// @file
/// A stranger's program on the door to ODE: two cubes, their contacts by pdepth.
#include <ode/ode.h>

#include <algorithm>
#include <cstdio>
#include <pd/ode/install.hpp>

int main() {
  dInitODE2(0);
  if (!pd::install_ode()) return 1;
  const dGeomID a = dCreateBox(nullptr, 1, 1, 1), b = dCreateBox(nullptr, 1, 1, 1);
  dGeomSetPosition(b, 0.75, 0, 0);
  dContactGeom contacts[8];
  const int count = dCollide(a, b, 8, contacts, sizeof(dContactGeom));
  double depth = 0;
  for (int i = 0; i < count; ++i) depth = std::max(depth, static_cast<double>(contacts[i].depth));
  std::printf("depth %g, %d points, %lld pair answered\n", depth, count,
              static_cast<long long>(pd::ode_report().answered));
  dGeomDestroy(a);
  dGeomDestroy(b);
  pd::uninstall_ode();
  dCloseODE();
}
