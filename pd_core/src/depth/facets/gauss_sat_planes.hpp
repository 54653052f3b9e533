/// @file
/// The first half of the kernel for Gauss maps: the planes of both bodies' facets in P, the heights of vertices along
/// them, the nearest facet, and the edges that may belong to a facet of P as near.
///
/// Everything here becomes a part of the function that uses it (numeric/lanes.hpp).
#pragma once

#include <bit>
#include <limits>

#include "depth/facets/gauss_sat_lanes.hpp"

namespace pd::detail::gauss_sat {

inline constexpr double kNone = std::numeric_limits<double>::infinity();

/// Holds how far the vertices of one body lie along the facets' normals of the other, in single precision.
template <class Size>
struct Heights {
  alignas(32) float row[Size::kVertices][Size::kFacets];
};

PD_INLINE void turn(LaneVectors& n, const double (&m)[9]) {
  const LaneVectors v = n;
  n.x = v.x * m[0] + v.y * m[1] + v.z * m[2];
  n.y = v.x * m[3] + v.y * m[4] + v.z * m[5];
  n.z = v.x * m[6] + v.y * m[7] + v.z * m[8];
}

template <class Size>
PD_INLINE void store_planes(Planes<Size>& out, int f, const LaneVectors& n, const Lanes& own) {
  store(out.nx + f, n.x);
  store(out.ny + f, n.y);
  store(out.nz + f, n.z);
  store(out.own + f, own);
  store(out.squared + f, n.x * n.x + n.y * n.y + n.z * n.z);
}

PD_INLINE void place_planes(Planes<Small>& out, const GaussSatBody& body, const double (&offset)[3]) {
  const SmallGaussMap& map = static_cast<const SmallBodyStorage&>(body.storage).gauss_map;
  for (int f = 0; f < Small::kFacets; f += kLanes) {
    LaneVectors n;
    Lanes own;
    load(n.x, map.nx + f);
    load(n.y, map.ny + f);
    load(n.z, map.nz + f);
    load(own, map.height + f);
    turn(n, body.turn);
    store_planes(out, f, n, own * body.growth + (n.x * offset[0] + n.y * offset[1] + n.z * offset[2]));
  }
}

/// Lists of a body of at most 32 vertices and 64 facets: its indices take one byte each.
PD_INLINE const std::uint8_t* single_bytes(const std::byte* list) {
  return reinterpret_cast<const std::uint8_t*>(list);
}
static_assert(2 * Middle::kEdges <= 0xFF);

PD_INLINE void place_planes(Planes<Middle>& out, const GaussSatBody& body, const double (&offset)[3]) {
  const ConvexPolytope::Storage& s = body.storage;
  out.used = (s.num_facets + 2 * kFloats - 1) / (2 * kFloats) * 2;
  const std::uint8_t* const first = single_bytes(s.facet_offsets);
  const std::uint8_t* const corners = single_bytes(s.facet_vertices);
  const double* const normals = s.facet_normals->data();
  const int facets = s.num_facets, end = kFloats * out.used;
  for (int f = 0; f < end; f += kLanes) {
    const double* of[kLanes];
    int on[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const int i = f + k < facets ? f + k : 0;
      of[k] = normals + 3 * i;
      on[k] = corners[first[i]];
    }
    LaneVectors n = {{of[0][0], of[1][0], of[2][0], of[3][0]},
                     {of[0][1], of[1][1], of[2][1], of[3][1]},
                     {of[0][2], of[1][2], of[2][2], of[3][2]}};
    LaneVectors p;
    gather(p, body.posed, on[0], on[1], on[2], on[3]);
    turn(n, body.turn);
    store_planes(out, f, n, n.x * (p.x + offset[0]) + n.y * (p.y + offset[1]) + n.z * (p.z + offset[2]));
  }
}

PD_INLINE void narrow(Floats& out, const double* from) {
  Lanes low, high;
  load(low, from);
  load(high, from + kLanes);
  const HalfFloats halves[2] = {__builtin_convertvector(low, HalfFloats), __builtin_convertvector(high, HalfFloats)};
  __builtin_memcpy(&out, halves, sizeof(halves));
}

template <class Size>
PD_INLINE void take_heights(Heights<Size>& heights, Planes<Size>& planes, const VertexArrays& other) {
  alignas(32) float x[Size::kVertices], y[Size::kVertices], z[Size::kVertices];
  for (int v = 0; v < other.count; v += kFloats) {
    Floats of_x, of_y, of_z;
    narrow(of_x, other.x + v);
    narrow(of_y, other.y + v);
    narrow(of_z, other.z + v);
    __builtin_memcpy(x + v, &of_x, sizeof(of_x));
    __builtin_memcpy(y + v, &of_y, sizeof(of_y));
    __builtin_memcpy(z + v, &of_z, sizeof(of_z));
  }
  for (int f = 0; f < kFloats * planes.blocks(); f += 2 * kFloats) {
    Floats nx[2], ny[2], nz[2], top[2];
    for (int i = 0; i < 2; ++i) {
      narrow(nx[i], planes.nx + f + kFloats * i);
      narrow(ny[i], planes.ny + f + kFloats * i);
      narrow(nz[i], planes.nz + f + kFloats * i);
      top[i] = Floats{} - std::numeric_limits<float>::max();
    }
    for (int v = 0; v < other.count; ++v) {
      for (int i = 0; i < 2; ++i) {
        const Floats height = nx[i] * x[v] + ny[i] * y[v] + nz[i] * z[v];
        top[i] = height > top[i] ? height : top[i];
        __builtin_memcpy(heights.row[v] + f + kFloats * i, &height, sizeof(height));
      }
    }
    __builtin_memcpy(planes.top + f, &top, sizeof(top));
  }
}

struct Nearest {
  double key, others;
  int id;
};

/// Rough heights, and the least of them.
template <class Size>
PD_INLINE void rough_planes(Lanes& least, Planes<Size>& planes) {
  for (int f = 0; f < kFloats * planes.blocks(); f += kLanes) {
    Lanes own;
    HalfFloats top;
    load(own, planes.own + f);
    __builtin_memcpy(&top, planes.top + f, sizeof(top));
    const Lanes height = own + __builtin_convertvector(top, Lanes);
    store(planes.rough + f, height);
    least = height < least ? height : least;
  }
}

/// How far the other body reaches along facet f.
/// @param heights  filled in, four vertices at a time
template <class Size>
PD_INLINE double top_along(int f, const Planes<Size>& planes, const VertexArrays& other,
                           Lanes (&heights)[Size::kVertices / kLanes]) {
  Lanes top = Lanes{} - std::numeric_limits<double>::max();
  for (int v = 0; v < other.count; v += kLanes) {
    Lanes x, y, z;
    load(x, other.x + v);
    load(y, other.y + v);
    load(z, other.z + v);
    const Lanes height = x * planes.nx[f] + y * planes.ny[f] + z * planes.nz[f];
    heights[v / kLanes] = height;
    top = height > top ? height : top;
  }
  return greatest(top);
}

/// Sets of the other body's vertices as bits, by facet.
template <class Size>
struct VertexSets {
  alignas(32) std::uint32_t of[Size::kFacets];
};

/// Facets that may be the nearest, or near, are measured; the others are bounded.
/// @param first_id  of these facets; those of A come first
/// @param tops      of the measured ones the vertices that are farthest along them, of the others none
template <class Size>
PD_INLINE void nearest_facet(Nearest& best, VertexSets<Size>& tops, const Planes<Size>& planes, int facets,
                             const VertexArrays& other, double level, double error, int first_id, int& measured) {
  Lanes least_other = Lanes{} + kNone;
  std::uint64_t near = 0;
  for (int f = 0; f < kFloats * planes.blocks(); f += kLanes) {
    Lanes rough;
    load(rough, planes.rough + f);
    const Lanes far = rough > level ? rough : least_other;
    least_other = far < least_other ? far : least_other;
    near |= std::uint64_t{mask_of_four(rough <= level)} << f;
    const HalfIds none = {};
    __builtin_memcpy(tops.of + f, &none, sizeof(none));
  }
  const double bound = key_of(least(least_other) - error, 1);
  best.others = bound < best.others ? bound : best.others;
  for (; near != 0; near &= near - 1) {
    const int f = std::countr_zero(near);
    if (f >= facets) break;
    ++measured;
    Lanes heights[Size::kVertices / kLanes];
    const double top = top_along(f, planes, other, heights);
    const double key = key_of(planes.own[f] + top, planes.squared[f]);
    const double lost = key < best.key ? best.key : key;
    best.others = lost < best.others ? lost : best.others;
    if (key < best.key) {
      best.key = key;
      best.id = first_id + f;
    }
    const double as_far = __builtin_sqrt(best.key * planes.squared[f]) - planes.own[f];
    const double far = as_far < top ? as_far : top;
    std::uint32_t highest = 0;
    for (int v = 0; v < other.count; v += kLanes) highest |= mask_of_four(heights[v / kLanes] >= far) << v;
    tops.of[f] = highest;
  }
}

/// Lists the facets of one body that are near.
template <class Size>
PD_INLINE void list_near_facets(NearGaussPieces& near, bool of_a, const GaussSatBody& body, const Planes<Size>& planes,
                                const Heights<Size>& heights, const VertexArrays& other, double error) {
  for (int f = 0; f < body.storage.num_facets; ++f) {
    if (planes.rough[f] > (near.radius + error) * (planes.squared[f] > 1 ? planes.squared[f] : 1)) continue;
    Lanes all_heights[Size::kVertices / kLanes];
    const double key = key_of(planes.own[f] + top_along(f, planes, other, all_heights), planes.squared[f]);
    if (!(key <= near.radius * near.radius)) continue;
    int vertex = 0;
    for (int v = 1; v < other.count; ++v) vertex = heights.row[v][f] > heights.row[vertex][f] ? v : vertex;
    GaussPiece piece{-1, -1, {0, 0}, {0, 0}};
    (of_a ? piece.facet_a : piece.facet_b) = static_cast<std::int8_t>(f);
    (of_a ? piece.a : piece.b)[0] = static_cast<std::int8_t>(body.storage.first_corner(f));
    (of_a ? piece.b : piece.a)[0] = static_cast<std::int8_t>(vertex);
    near.add(key, piece);
  }
}

/// How low the other body may lie along a facet whose plane is no farther than `radius`.
template <class Size>
PD_INLINE void levels_of(Floats& out, const Planes<Size>& planes, int first, double radius, double slack) {
  const Lanes one = Lanes{} + 1.0;
  alignas(32) double level[kFloats];
  for (int i = 0; i < kFloats; i += kLanes) {
    Lanes squared, own;
    load(squared, planes.squared + first + i);
    load(own, planes.own + first + i);
    // No normal is longer than 1 or than its square.
    const Lanes length = squared > one ? squared : one;
    store(level + i, length * radius - own + slack);
  }
  narrow(out, level);
}

/// The vertices of the other body that show a facet too far.
/// @param tops  vertices that do so, too
template <class Size>
PD_INLINE void mark_far_facets(VertexSets<Size>& far, const Planes<Size>& planes, const Heights<Size>& other, int count,
                               const VertexSets<Size>& tops, double radius, double slack) {
  constexpr int kTogether = 2;  // blocks
  for (int f = 0; f < kFloats * planes.blocks(); f += kTogether * kFloats) {
    Floats level[kTogether], height;
    Bits sets[kTogether] = {}, bit = Bits{} + 1U;
    for (int i = 0; i < kTogether; ++i) levels_of(level[i], planes, f + kFloats * i, radius, slack);
    for (int v = 0; v < count; ++v) {
      for (int i = 0; i < kTogether; ++i) {
        load(height, other.row[v] + f + kFloats * i);
        sets[i] |= (Bits)(height > level[i]) & bit;
      }
      bit += bit;
    }
    for (int i = 0; i < kTogether; ++i) {
      Bits top;
      __builtin_memcpy(&top, tops.of + f + kFloats * i, sizeof(top));
      sets[i] |= top;
    }
    __builtin_memcpy(far.of + f, sets, sizeof(sets));
  }
}

/// Edges that may belong to a facet of P no farther than `radius`. A vertex of P, of facet f with vertex v of the other
/// body, may show f too far; where one v does so for both facets of an edge, it does for all directions of its arc
/// (arc_culling.hpp). The vertex that is farthest along a facet does for it what that facet's plane does: it is as far
/// as the plane, which is no nearer than the nearest facet. So flush faces, which single precision cannot tell apart,
/// keep few of their edges. False: there are more than there is room for.
/// @param tops  no vertices, or those that are farthest along facets, where facets farther than the nearest one are not
///              asked for
template <class Size>
PD_INLINE bool keep_near_edges(KeptEdges<Size>& out, const GaussSatBody& body, const Planes<Size>& planes,
                               const Heights<Size>& other, int others, const VertexSets<Size>& tops, double radius,
                               double slack) {
  VertexSets<Size> sets;
  mark_far_facets(sets, planes, other, others, tops, radius, slack);
  const auto& far = sets.of;
  int count = 0;
  if constexpr (kIsSmall<Size>) {
    const SmallGaussMap& map = static_cast<const SmallBodyStorage&>(body.storage).gauss_map;
    // The first byte of each word: eight vertices.
    typedef std::uint8_t WordBytes __attribute__((vector_size(32)));
    static_assert(Size::kFacets == kBytes && Size::kVertices == 8);
    WordBytes words[2];
    __builtin_memcpy(words, far, sizeof(words));
    constexpr int k = std::endian::native == std::endian::little ? 0 : 3;
    const Bytes by_facet =
        __builtin_shufflevector(words[0], words[1], k, k + 4, k + 8, k + 12, k + 16, k + 20, k + 24, k + 28, k + 32,
                                k + 36, k + 40, k + 44, k + 48, k + 52, k + 56, k + 60);
    std::uint32_t kept = 0;
    for (const int e : {0, Size::kEdges - kBytes}) {
      Bytes left, right;
      __builtin_memcpy(&left, map.left + e, sizeof(left));
      __builtin_memcpy(&right, map.right + e, sizeof(right));
      look_up(left, by_facet, left);
      look_up(right, by_facet, right);
      kept |= mask_of_zeros(left & right) << e;
    }
    for (kept &= (1U << map.edges) - 1; kept != 0; kept &= kept - 1)
      out.edge[count++] = map.edge[std::countr_zero(kept)];
  } else {
    const ConvexPolytope::Storage& s = body.storage;
    const std::uint8_t* const first = single_bytes(s.neighbour_offsets);
    const std::uint8_t* const left_facets = single_bytes(s.left_facets);
    const std::uint8_t* const twins = single_bytes(s.twins);
    const std::uint8_t* const targets = single_bytes(s.neighbours);
    alignas(32) std::uint32_t left[2 * Size::kEdges + kFloats], right[2 * Size::kEdges + kFloats];
    // Half-edges lie in order round their origins: to the right of each is what is to the left of the one before.
    const int vertices = s.num_vertices, both_ways = s.num_half_edges;
    for (int h = 0; h < both_ways; h += 2) {
      left[h] = right[h + 1] = far[left_facets[h]];
      left[h + 1] = right[h + 2] = far[left_facets[h + 1]];
    }
    for (int v = 0; v < vertices; ++v) right[first[v]] = left[first[v + 1] - 1];
    for (int from = 0; from < both_ways; from += kFloats) {
      Ids of_left, of_right;
      __builtin_memcpy(&of_left, left + from, sizeof(of_left));
      __builtin_memcpy(&of_right, right + from, sizeof(of_right));
      unsigned near = mask_of_eight((of_left & of_right) == 0);
      if (both_ways - from < kFloats) near &= (1U << (both_ways - from)) - 1;
      for (; near != 0; near &= near - 1) {
        const int h = from + std::countr_zero(near), twin = twins[h];
        if (twin > h) out.edge[count++] = {targets[twin], targets[h], left_facets[h], left_facets[twin]};
      }
    }
  }
  out.count = count;
  return count <= Size::kKept;
}

}  // namespace pd::detail::gauss_sat
