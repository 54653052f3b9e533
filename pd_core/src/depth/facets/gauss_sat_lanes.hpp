/// @file
/// What the two parts of the kernel for Gauss maps share: gauss_sat_kernels.cpp, which most pairs of bodies run alone,
/// and gauss_sat_slivers.cpp for slivers.
///
/// Everything here becomes a part of the function that uses it (numeric/lanes.hpp).
#pragma once

#include <cstdint>
#include <limits>

#include "depth/facets/gauss_sat_kernels.hpp"
#include "numeric/lanes.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail::gauss_sat {

typedef std::uint32_t Bits __attribute__((vector_size(32)));

/// Both bodies have a small Gauss map, whose arrays hold all facets and edges.
struct Small {
  static constexpr int kVertices = SmallGaussMap::kMostVertices;
  static constexpr int kFacets = SmallGaussMap::kFacetSlots;
  static constexpr int kEdges = SmallGaussMap::kMostEdges;
  static constexpr int kKept = kEdges;  ///< edges of a body that may be near, by bits of a word
  static constexpr int kMostCrossings = kKept * kKept;
  using Word = std::uint32_t;
};

struct Middle {
  static constexpr int kVertices = kMostGaussVertices;
  static constexpr int kFacets = kMostGaussFacets;
  static constexpr int kEdges = 3 * kVertices;  ///< Euler: 3 V - 6
  static constexpr int kKept = 64;
  static constexpr int kMostCrossings = 1024;
  using Word = std::uint64_t;
};

template <class Size>
inline constexpr bool kIsSmall = Size::kKept <= 32;

/// The planes of a body's facets. Entries beyond the last facet, up to whole blocks, repeat the first.
template <class Size>
struct Planes {
  alignas(32) double nx[Size::kFacets], ny[Size::kFacets], nz[Size::kFacets];
  alignas(32) double own[Size::kFacets];      ///< height of the plane of P but for the other body
  alignas(32) double squared[Size::kFacets];  ///< squared length of the normal
  alignas(32) double rough[Size::kFacets];    ///< height of the plane of P, by single precision
  alignas(32) float top[Size::kFacets];       ///< of the other body along it
  int used;                                   ///< of kFloats; an even number

  [[nodiscard]] PD_INLINE VertexArrays normals() const { return {nx, ny, nz, Size::kFacets}; }
  [[nodiscard]] PD_INLINE int blocks() const { return kIsSmall<Size> ? Size::kFacets / kFloats : used; }
};

/// Edges of a body.
template <class Size>
struct KeptEdges {
  int count;
  GaussEdge edge[Size::kEdges + 1];
};

/// Pairs of edges whose arcs cross.
template <class Size>
struct Crossings {
  int count = 0;
  std::uint8_t a[Size::kMostCrossings + Size::kKept + kLanes], b[Size::kMostCrossings + Size::kKept + kLanes];
  double sign[Size::kMostCrossings + Size::kKept + kLanes];  ///< of b x a, to point outwards; 0: either way
};

struct LaneVectors {
  Lanes x, y, z;
};

PD_INLINE void gather(LaneVectors& to, const VertexArrays& v, int i, int j, int k, int l) {
  to.x = Lanes{v.x[i], v.x[j], v.x[k], v.x[l]};
  to.y = Lanes{v.y[i], v.y[j], v.y[k], v.y[l]};
  to.z = Lanes{v.z[i], v.z[j], v.z[k], v.z[l]};
}

PD_INLINE void dot(Lanes& out, const LaneVectors& u, const LaneVectors& v) { out = u.x * v.x + u.y * v.y + u.z * v.z; }

/// sign * square of distance, where height = distance * length of the normal; the lowest where there is no normal.
PD_INLINE void key_of(Lanes& key, const Lanes& height, const Lanes& squared) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes size = height < zero ? -height : height;
  key = squared > zero ? height * size / squared : zero - std::numeric_limits<double>::max();
}
PD_INLINE double key_of(double height, double squared) {
  return squared > 0 ? height * (height < 0 ? -height : height) / squared : -std::numeric_limits<double>::max();
}

/// What the kernel knows by the time that sides are told.
template <class Size>
struct KernelState {
  Planes<Size> planes_a, planes_b;
  KeptEdges<Size> kept_a, kept_b;
};

/// The turned vertices of -A or B, and the turned normals of its facets.
struct SliverBody {
  VertexArrays posed, normals;
};

/// Slivers lie above their lowest corner along any vector: bounds them by the one along which that is highest, of the
/// normals beside their edges, the middles between those, and their own. Drops those that are `level` or farther.
/// Returns the least bound of those that were dropped.
double bound_thin_pairs(const SliverBody& a, const SliverBody& b, const double (&offset)[3], double level,
                        ThinPairs& thin);

}  // namespace pd::detail::gauss_sat
