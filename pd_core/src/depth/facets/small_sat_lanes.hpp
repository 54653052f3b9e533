/// @file
/// What the two parts of the kernel for small solids share: small_sat_kernels.cpp, which most pairs of bodies run
/// alone, and small_sat_open_sides.cpp for edges whose sides single precision leaves open. How pairs of edges are
/// measured serves all_facets_kernels.cpp, too.
///
/// Everything here becomes a part of the function that uses it (numeric/lanes.hpp).
#pragma once

#include <cstdint>
#include <limits>

#include "depth/facets/small_sat_kernels.hpp"
#include "numeric/lanes.hpp"

namespace pd::detail::small_sat {

typedef std::uint32_t Bits __attribute__((vector_size(32)));
typedef std::uint32_t HalfBits __attribute__((vector_size(16)));

inline constexpr int kFacets = SmallGaussMap::kMostFacets;
inline constexpr int kBlocks = kFacets / kLanes;
inline constexpr int kEdges = SmallGaussMap::kMostEdges;
inline constexpr std::uint32_t kSign = 0x80000000;
static_assert(kBlocks == 3 && kFacets == kFloats + kLanes);

struct LaneVectors {
  Lanes x, y, z;
};

struct TurnedNormals {
  LaneVectors n[kBlocks];
};

PD_INLINE void turn_normals(TurnedNormals& out, const SmallSatBody& body) {
  const double* const m = body.normals;
  for (int k = 0; k < kBlocks; ++k) {
    Lanes x, y, z;
    load(x, body.map.nx + kLanes * k);
    load(y, body.map.ny + kLanes * k);
    load(z, body.map.nz + kLanes * k);
    out.n[k].x = x * m[0] + y * m[1] + z * m[2];
    out.n[k].y = x * m[3] + y * m[4] + z * m[5];
    out.n[k].z = x * m[6] + y * m[7] + z * m[8];
  }
}

/// Where the vertices of one body lie along the facets' normals of the other, in single precision.
struct HeightRows {
  alignas(32) float row[SmallGaussMap::kMostVertices][2 * kFloats];
};

/// sign * square of distance, where height = distance * length of the normal; the lowest where there is no normal.
PD_INLINE void key_of(Lanes& key, const Lanes& height, const Lanes& squared) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes size = height < zero ? -height : height;
  key = squared > zero ? height * size / squared : zero - std::numeric_limits<double>::max();
}

/// Edges of a body by their numbers.
struct KeptEdges {
  int count;
  int edge[kEdges + 1];
};

/// By facet: how much higher one vertex lies than another.
PD_INLINE void rise_between(Floats& low, HalfFloats& high, const float* above, const float* below) {
  Floats a, b;
  HalfFloats c, d;
  load(a, above);
  load(b, below);
  __builtin_memcpy(&c, above + kFloats, sizeof(c));
  __builtin_memcpy(&d, below + kFloats, sizeof(d));
  low = a - b;
  high = c - d;
}

/// Pairs of edges whose arcs cross.
struct Crossings {
  static constexpr int kRoom = kEdges * kEdges + kLanes;
  static constexpr int kStride = 32;
  int count = 0;
  std::uint32_t pair[kRoom];  ///< kStride * edge of B + edge of A
  double sign[kRoom];         ///< of b x a, to point outwards

  [[nodiscard]] PD_INLINE int edge_a(int k) const { return static_cast<int>(pair[k] % kStride); }
  [[nodiscard]] PD_INLINE int edge_b(int k) const { return static_cast<int>(pair[k] / kStride); }
};

/// The edges of a body on whose left and right side the facets of a set lie.
struct EdgeSet {
  std::uint32_t left, right;
};

PD_INLINE void edges_around(EdgeSet& out, const SmallGaussMap& map, std::uint32_t facets) {
  const std::uint64_t edges = map.edges_of_facets[0][facets & 15] | map.edges_of_facets[1][facets >> 4 & 15] |
                              map.edges_of_facets[2][facets >> 8];
  out = {static_cast<std::uint32_t>(edges), static_cast<std::uint32_t>(edges >> 32)};
}

PD_INLINE void gather(LaneVectors& to, const VertexArrays& v, const int (&ids)[kLanes]) {
  to.x = Lanes{v.x[ids[0]], v.x[ids[1]], v.x[ids[2]], v.x[ids[3]]};
  to.y = Lanes{v.y[ids[0]], v.y[ids[1]], v.y[ids[2]], v.y[ids[3]]};
  to.z = Lanes{v.z[ids[0]], v.z[ids[1]], v.z[ids[2]], v.z[ids[3]]};
}

/// Parallelograms of an edge of -A from p to e and one of B from q to f, which become vectors: the height of the lowest
/// corner along the normal, sign * b x a, and the square of its length. Rounding moves corners off the plane, and the
/// piece of P lies above the lowest.
PD_INLINE void lowest_corners(Lanes& lowest, Lanes& squared, const LaneVectors& p, LaneVectors& e, const LaneVectors& q,
                              LaneVectors& f, const Lanes& sign, const double (&offset)[3]) {
  const Lanes zero = {0, 0, 0, 0};
  e.x = p.x - e.x;
  e.y = p.y - e.y;
  e.z = p.z - e.z;
  f.x = f.x - q.x;
  f.y = f.y - q.y;
  f.z = f.z - q.z;
  const LaneVectors n = {sign * (f.y * e.z - f.z * e.y), sign * (f.z * e.x - f.x * e.z),
                         sign * (f.x * e.y - f.y * e.x)};
  const Lanes height = n.x * (q.x + p.x + offset[0]) + n.y * (q.y + p.y + offset[1]) + n.z * (q.z + p.z + offset[2]);
  const Lanes along_e = n.x * e.x + n.y * e.y + n.z * e.z;
  const Lanes along_f = n.x * f.x + n.y * f.y + n.z * f.z;
  lowest = height - (along_e > zero ? along_e : zero) + (along_f < zero ? along_f : zero);
  squared = n.x * n.x + n.y * n.y + n.z * n.z;
}

/// What the kernel was asked.
struct Question {
  const SmallSatBody& a;
  const SmallSatBody& b;
  const double (&offset)[3];
  const SmallSatErrors& errors;
};

/// What it knows by the time that it has told all sides.
struct Sides {
  const HeightRows& of_a;
  const HeightRows& of_b;
  const KeptEdges& kept_a;
  const KeptEdges& kept_b;
  const std::uint32_t (&sides_a)[kFacets];
  const std::uint32_t (&facets_b)[kEdges];
};

/// Lists the pairs that cross for certain in `certain` and measures those that may.
void try_open_sides(const Question& question, const Sides& known, Crossings& certain, SmallSatNearest& out);

}  // namespace pd::detail::small_sat
