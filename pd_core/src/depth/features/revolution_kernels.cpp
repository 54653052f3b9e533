#include "depth/features/revolution_kernels.hpp"

#include <cstddef>
#include <limits>

#include "numeric/lanes.hpp"

namespace pd::detail {

namespace {

struct CoreAxis {
  double x, y, z;
};

/// Coordinates of four normals or vertices.
PD_INLINE void gather_four(Lanes& to, const double* from, const std::int64_t (&at)[kLanes]) {
  to = Lanes{from[at[0]], from[at[1]], from[at[2]], from[at[3]]};
}

PD_INLINE int facet_touches_in_lanes(const PosedPolytope& polytope, const double* normals, const CoreAxis& axis,
                                     double radius, double half_height, bool pointed, FacetTouch* touches,
                                     double& least_height) {
  const ConvexPolytope::Storage& s = polytope.storage;
  const double* const m = polytope.cofactors;
  const Lanes zero = {0, 0, 0, 0};
  Lanes lowest = zero + std::numeric_limits<double>::infinity();
  Lanes of_lowest = zero, number = {0, 1, 2, 3};
  for (int f = 0; f < s.num_facets; f += kLanes) {
    std::int64_t normal_at[kLanes], vertex_at[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const int facet = f + i < s.num_facets ? f + i : s.num_facets - 1;
      normal_at[i] = 3 * std::int64_t{facet};
      vertex_at[i] = s.facet_vertices[s.facet_offsets[facet]];
    }
    Lanes lx, ly, lz, vx, vy, vz;
    gather_four(lx, normals, normal_at);
    gather_four(ly, normals + 1, normal_at);
    gather_four(lz, normals + 2, normal_at);
    gather_four(vx, s.x, vertex_at);
    gather_four(vy, s.y, vertex_at);
    gather_four(vz, s.z, vertex_at);
    Lanes nx = lx * m[0] + ly * m[1] + lz * m[2];
    Lanes ny = lx * m[3] + ly * m[4] + lz * m[5];
    Lanes nz = lx * m[6] + ly * m[7] + lz * m[8];
    Lanes inverse = nx * nx + ny * ny + nz * nz;
    take_roots(inverse);
    inverse = 1 / inverse;
    nx *= inverse;
    ny *= inverse;
    nz *= inverse;
    Lanes level = (lx * vx + ly * vy + lz * vz) * (polytope.determinant * inverse) +
                  (nx * polytope.offset[0] + ny * polytope.offset[1] + nz * polytope.offset[2]);
    Lanes along = nx * axis.x + ny * axis.y + nz * axis.z;
    // Not by 1 - along^2, which is lost where a normal runs along the axis.
    const Lanes cx = ny * axis.z - nz * axis.y, cy = nz * axis.x - nx * axis.z, cz = nx * axis.y - ny * axis.x;
    const Lanes across_squared = cx * cx + cy * cy + cz * cz;
    Lanes across = across_squared;
    take_roots(across);
    const Lanes width = across * radius;
    const Flags upper = pointed ? 2 * half_height * along > width : along >= zero;
    const Lanes z = upper ? zero + half_height : zero - half_height;
    const Lanes middle = level + z * along;
    const Flags is_apex = pointed ? upper : Flags{0, 0, 0, 0};
    Lanes height = is_apex ? middle : middle + width;
    const Lanes told =
        number < zero + static_cast<double>(s.num_facets) ? height : zero + std::numeric_limits<double>::infinity();
    of_lowest = told < lowest ? number : of_lowest;
    lowest = told < lowest ? told : lowest;
    number += kLanes;
    const Flags by_middle = is_apex | (across_squared < zero + kNearAxis);
    Lanes rise = by_middle ? zero : radius / across;
    Lanes shift = z - along * rise;
    height = by_middle ? middle : height;
    transpose(nx, ny, nz, along);
    transpose(level, rise, shift, height);
    const Lanes first[kLanes] = {nx, ny, nz, along};
    const Lanes second[kLanes] = {level, rise, shift, height};
    for (int i = 0; i < kLanes; ++i) {
      __builtin_memcpy(touches[f + i].normal, &first[i], sizeof(Lanes));
      __builtin_memcpy(&touches[f + i].level, &second[i], sizeof(Lanes));
    }
  }
  int best = 0;
  for (int i = 1; i < kLanes; ++i) {
    if (lowest[i] < lowest[best] || (lowest[i] == lowest[best] && of_lowest[i] < of_lowest[best])) best = i;
  }
  least_height = lowest[best];
  return static_cast<int>(of_lowest[best]);
}

PD_INLINE double vertex_circles_in_lanes(const PosedPolytope& polytope, const CoreAxis& axis, double flat, double steep,
                                         double* least) {
  const ConvexPolytope::Storage& s = polytope.storage;
  const double* const m = polytope.matrix;
  Lanes most = {0, 0, 0, 0};
  most -= std::numeric_limits<double>::infinity();
  // Padded with copies of vertex 0.
  for (int i = 0; i < s.num_vertices; i += kLanes) {
    Lanes lx, ly, lz;
    load(lx, s.x + i);
    load(ly, s.y + i);
    load(lz, s.z + i);
    Lanes x = lx * m[0] + ly * m[1] + lz * m[2] + polytope.offset[0];
    Lanes y = lx * m[3] + ly * m[4] + lz * m[5] + polytope.offset[1];
    Lanes z = lx * m[6] + ly * m[7] + lz * m[8] + polytope.offset[2];
    const Lanes along = x * axis.x + y * axis.y + z * axis.z;
    x -= along * axis.x;
    y -= along * axis.y;
    z -= along * axis.z;
    Lanes aside = x * x + y * y + z * z;
    take_roots(aside);
    const Lanes value = flat * along - steep * aside;
    store(least + i, value);
    most = value > most ? value : most;
  }
  return greatest(most);
}

}  // namespace

PD_CLONES int facet_touches(const PosedPolytope& polytope, const RevolvedCore& core, FacetTouch* touches,
                            double& least) {
  const double* const axis = core.axis.data();
  const double* const normals = polytope.storage.facet_normals[0].data();
  return facet_touches_in_lanes(polytope, normals, {axis[0], axis[1], axis[2]}, core.radius, core.half_height,
                                core.pointed, touches, least);
}

PD_CLONES double vertex_circles(const PosedPolytope& polytope, const RevolvedCore& core, double* least) {
  const double* const axis = core.axis.data();
  const double steep = __builtin_sqrt(1 - core.kink * core.kink);
  return vertex_circles_in_lanes(polytope, {axis[0], axis[1], axis[2]}, core.kink, steep, least);
}

}  // namespace pd::detail
