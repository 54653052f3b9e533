#include "bench/peers/solver.hpp"

namespace pd::bench {

scenes::Points vertices_of(const ConvexShape& shape) {
  scenes::Points points;
  const ConvexPolytope& polytope = *shape.polytope();
  for (int v = 0; v < polytope.num_vertices(); ++v) points.push_back(polytope.vertex(v));
  return points;
}

std::optional<Vec3> half_extents_of(const ConvexShape& shape) {
  const scenes::Points corners = vertices_of(shape);
  if (corners.size() != 8) return std::nullopt;
  const Vec3 half = corners[0].cwiseAbs();
  for (const Vec3& corner : corners) {
    if (corner.cwiseAbs() != half) return std::nullopt;
  }
  return half;
}

double length_of(const ConvexShape& shape) {
  return (shape.polytope()->vertex(1) - shape.polytope()->vertex(0)).norm();
}

namespace {

/// Those that take curved shapes as they take hulls.
void add_all_but_bullet([[maybe_unused]] Solvers& solvers) {
#ifdef PD_BENCH_WITH_CCD
  add_ccd(solvers);
#endif
#ifdef PD_BENCH_WITH_FCL
  add_fcl(solvers);
#endif
#ifdef PD_BENCH_WITH_JOLT
  add_jolt(solvers);
#endif
#ifdef PD_BENCH_WITH_MUJOCO
  add_mujoco(solvers);
#endif
#ifdef PD_BENCH_WITH_BOX3D
  add_box3d(solvers);
#endif
}

}  // namespace

void add_peers(Solvers& solvers) {
#ifdef PD_BENCH_WITH_BULLET
  add_bullet(solvers);
#endif
  add_all_but_bullet(solvers);
}

void add_peers_apart([[maybe_unused]] Solvers& solvers) {
#ifdef PD_BENCH_WITH_BULLET
  add_bullet_apart(solvers);
#endif
#ifdef PD_BENCH_WITH_CCD
  add_ccd_apart(solvers);
#endif
#ifdef PD_BENCH_WITH_FCL
  add_fcl_apart(solvers);
#endif
#ifdef PD_BENCH_WITH_JOLT
  add_jolt_apart(solvers);
#endif
#ifdef PD_BENCH_WITH_MUJOCO
  add_mujoco_apart(solvers);
#endif
#ifdef PD_BENCH_WITH_BOX3D
  add_box3d_apart(solvers);
#endif
}

void add_peers_curved(Solvers& solvers) {
#ifdef PD_BENCH_WITH_BULLET
  add_bullet_curved(solvers);
#endif
  add_all_but_bullet(solvers);
}

std::vector<std::string> peer_notes() {
  std::vector<std::string> notes;
#ifdef PD_BENCH_WITH_BULLET
  notes.push_back(bullet_note());
#else
  notes.emplace_back("Bullet: missing when this was built, so there are no ratios");
#endif
#ifdef PD_BENCH_WITH_CCD
  notes.emplace_back("libccd 2 (double)");
#else
  notes.emplace_back("libccd: missing when this was built");
#endif
#ifdef PD_BENCH_WITH_FCL
  notes.push_back(fcl_note());
#else
  notes.emplace_back("FCL: missing when this was built");
#endif
#ifdef PD_BENCH_WITH_JOLT
  notes.push_back(jolt_note());
#endif
#ifdef PD_BENCH_WITH_MUJOCO
  notes.push_back(mujoco_note());
#endif
#ifdef PD_BENCH_WITH_BOX3D
  notes.push_back(box3d_note());
#endif
  return notes;
}

}  // namespace pd::bench
