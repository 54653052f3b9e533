#include "depth/facets/all_facets_kernels.hpp"

#include <bit>
#include <cstdint>
#include <limits>

#include "depth/facets/small_sat_lanes.hpp"
#include "numeric/lanes.hpp"

namespace pd::detail {

namespace all_facets {
namespace {

typedef std::uint32_t Bits __attribute__((vector_size(32)));

constexpr int kFacetSlots = AllFacetsBody::kMostFacets;
constexpr int kHeightRows = AllFacetsBody::kMostVertices;
constexpr int kKept = 64;  ///< edges of a body, by bits of a word
constexpr int kHalf = kKept / 2;
constexpr int kRoom = 3 * kHeightRows;  ///< Euler: 3 V - 6 edges
static_assert(kHeightRows == 32);

/// The planes of a body's facets. Entries beyond the last facet, up to whole blocks, repeat the first.
struct Planes {
  alignas(32) double nx[kFacetSlots], ny[kFacetSlots], nz[kFacetSlots];
  alignas(32) double own[kFacetSlots];      ///< height of the plane of P but for the other body
  alignas(32) double squared[kFacetSlots];  ///< squared length of the normal
  alignas(32) double rough[kFacetSlots];    ///< height of the plane of P, by single precision
  alignas(32) float top[kFacetSlots];       ///< of the other body along it
  int blocks;                               ///< of kFloats; an even number
};

/// Where the vertices of one body lie along the facets' normals of the other, in single precision; rows beyond the last
/// vertex lie below all.
struct Heights {
  alignas(32) float row[kHeightRows][kFacetSlots];
};

PD_INLINE void place_planes(Planes& out, const AllFacetsBody& body, const double (&offset)[3]) {
  const ConvexPolytope::Storage& s = body.storage;
  out.blocks = (s.num_facets + 2 * kFloats - 1) / (2 * kFloats) * 2;
  const int end = kFloats * out.blocks;
  alignas(32) double x[kFacetSlots], y[kFacetSlots], z[kFacetSlots];
  for (int f = 0; f < end; ++f) {
    const int i = f < s.num_facets ? f : 0;
    const double* const n = s.facet_normals[i].data();
    out.nx[f] = n[0];
    out.ny[f] = n[1];
    out.nz[f] = n[2];
    const std::int32_t on = s.facet_vertices[s.facet_offsets[i]];
    x[f] = body.posed.x[on];
    y[f] = body.posed.y[on];
    z[f] = body.posed.z[on];
  }
  const double(&m)[9] = body.turn;
  for (int f = 0; f < end; f += kLanes) {
    Lanes nx, ny, nz, px, py, pz;
    load(nx, out.nx + f);
    load(ny, out.ny + f);
    load(nz, out.nz + f);
    load(px, x + f);
    load(py, y + f);
    load(pz, z + f);
    const Lanes tx = nx * m[0] + ny * m[1] + nz * m[2];
    const Lanes ty = nx * m[3] + ny * m[4] + nz * m[5];
    const Lanes tz = nx * m[6] + ny * m[7] + nz * m[8];
    store(out.nx + f, tx);
    store(out.ny + f, ty);
    store(out.nz + f, tz);
    store(out.own + f, tx * (px + offset[0]) + ty * (py + offset[1]) + tz * (pz + offset[2]));
    store(out.squared + f, tx * tx + ty * ty + tz * tz);
  }
}

PD_INLINE void narrow(Floats& out, const double* from) {
  Lanes low, high;
  load(low, from);
  load(high, from + kLanes);
  const HalfFloats halves[2] = {__builtin_convertvector(low, HalfFloats), __builtin_convertvector(high, HalfFloats)};
  __builtin_memcpy(&out, halves, sizeof(halves));
}

PD_INLINE void take_heights(Heights& heights, Planes& planes, const VertexArrays& other) {
  alignas(32) float x[kHeightRows], y[kHeightRows], z[kHeightRows];
  for (int v = 0; v < other.count; v += kFloats) {
    Floats of_x, of_y, of_z;
    narrow(of_x, other.x + v);
    narrow(of_y, other.y + v);
    narrow(of_z, other.z + v);
    __builtin_memcpy(x + v, &of_x, sizeof(of_x));
    __builtin_memcpy(y + v, &of_y, sizeof(of_y));
    __builtin_memcpy(z + v, &of_z, sizeof(of_z));
  }
  for (int f = 0; f < kFloats * planes.blocks; f += 2 * kFloats) {
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
    const Floats none = Floats{} - std::numeric_limits<float>::max();
    for (int v = other.count; v < kHeightRows; ++v) {
      for (int i = 0; i < 2; ++i) __builtin_memcpy(heights.row[v] + f + kFloats * i, &none, sizeof(none));
    }
  }
}

/// sign * square of distance, where height = distance * length of the normal.
PD_INLINE double key_of(double height, double squared) {
  return squared > 0 ? height * (height < 0 ? -height : height) / squared : -std::numeric_limits<double>::max();
}

struct NearestFacet {
  double key, others;
  int facet;
};

PD_INLINE void take(NearestFacet& best, double key, int facet) {
  const double lost = key < best.key ? best.key : key;
  best.others = lost < best.others ? lost : best.others;
  if (key < best.key) {
    best.key = key;
    best.facet = facet;
  }
}

/// Rough heights, and the least of them.
PD_INLINE void rough_planes(Lanes& least, Planes& planes) {
  for (int f = 0; f < kFloats * planes.blocks; f += kLanes) {
    Lanes own;
    HalfFloats top;
    load(own, planes.own + f);
    __builtin_memcpy(&top, planes.top + f, sizeof(top));
    const Lanes height = own + __builtin_convertvector(top, Lanes);
    store(planes.rough + f, height);
    least = height < least ? height : least;
  }
}

/// Facets that may be the nearest are measured, the others bounded.
PD_INLINE void nearest_facet(NearestFacet& best, const Planes& planes, const Heights& heights, int facets,
                             const VertexArrays& other, double level, double error, int first_id, int& measured) {
  Lanes least_other = Lanes{} + std::numeric_limits<double>::infinity();
  std::uint64_t near = 0;
  for (int f = 0; f < kFloats * planes.blocks; f += kLanes) {
    Lanes rough;
    load(rough, planes.rough + f);
    const Lanes far = rough > level ? rough : least_other;
    least_other = far < least_other ? far : least_other;
    near |= std::uint64_t{mask_of_four(rough <= level)} << f;
  }
  const double bound = key_of(least(least_other) - error, 1);
  best.others = bound < best.others ? bound : best.others;
  for (; near != 0; near &= near - 1) {
    const int f = std::countr_zero(near);
    if (f >= facets) break;
    ++measured;
    double top = -std::numeric_limits<double>::max();
    for (int v = 0; v < other.count; ++v) {
      if (static_cast<double>(heights.row[v][f]) < static_cast<double>(planes.top[f]) - error) continue;
      const double height = planes.nx[f] * other.x[v] + planes.ny[f] * other.y[v] + planes.nz[f] * other.z[v];
      top = height > top ? height : top;
    }
    take(best, key_of(planes.own[f] + top, planes.squared[f]), first_id + f);
  }
}

/// Edges of a body, counted with their vertices and facets.
struct KeptEdges {
  int count;
  std::uint8_t from[kRoom + 1], to[kRoom + 1], left[kRoom + 1], right[kRoom + 1];
};

/// How low the other body may lie along a facet whose plane is no farther than `radius`.
PD_INLINE void levels_of(Floats& out, const Planes& planes, int first, double radius, double slack) {
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

PD_INLINE void take_sign(Bits& bits, const Floats& value) {
  Bits sign;
  __builtin_memcpy(&sign, &value, sizeof(sign));
  bits = bits >> 1 | (sign & 0x80000000U);
}

/// By facet: the vertices of the other body, as bits, that show it too far.
PD_INLINE void mark_far_facets(std::uint32_t (&far)[kFacetSlots], const Planes& planes, const Heights& other,
                               double radius, double slack) {
  // Four chains of bits, as each waits for itself: two blocks of facets, and two halves of the vertices.
  constexpr int kTogether = 2, kHalfway = kHeightRows / 2;
  for (int f = 0; f < kFloats * planes.blocks; f += kTogether * kFloats) {
    Floats level[kTogether], height;
    Bits first[kTogether] = {}, second[kTogether] = {};
    for (int i = 0; i < kTogether; ++i) levels_of(level[i], planes, f + kFloats * i, radius, slack);
    for (int v = 0; v < kHalfway; ++v) {
      for (int i = 0; i < kTogether; ++i) {
        load(height, other.row[v] + f + kFloats * i);
        take_sign(first[i], level[i] - height);
        load(height, other.row[v + kHalfway] + f + kFloats * i);
        take_sign(second[i], level[i] - height);
      }
    }
    for (int i = 0; i < kTogether; ++i) {
      const Bits both = first[i] >> kHalfway | second[i];
      __builtin_memcpy(far + f + kFloats * i, &both, sizeof(both));
    }
  }
}

/// Edges that may belong to a facet of P no farther than `radius`: where one vertex of the other body shows both facets
/// of an edge too far, it does for all directions of its arc.
PD_INLINE void keep_near_edges(KeptEdges& out, const AllFacetsBody& body, const Planes& planes, const Heights& other,
                               double radius, double slack) {
  alignas(32) std::uint32_t far[kFacetSlots];
  mark_far_facets(far, planes, other, radius, slack);
  // Half-edges lie in order round their origins: to the right of each is what is to the left of the one before.
  const ConvexPolytope::Storage& s = body.storage;
  std::uint8_t kept[2 * kRoom + 1];
  int both_ways = 0;
  for (int v = 0; v < s.num_vertices; ++v) {
    const int end = s.neighbour_offsets[v + 1];
    std::uint32_t right = far[s.half_edges[end - 1].facet];
    for (int h = s.neighbour_offsets[v]; h < end; ++h) {
      const std::uint32_t left = far[s.half_edges[h].facet];
      // Written in any case and counted where it stays: no branch to guess.
      kept[both_ways] = static_cast<std::uint8_t>(h);
      both_ways += static_cast<int>((left & right) == 0);
      right = left;
    }
  }
  int count = 0;
  for (int k = 0; k < both_ways; ++k) {
    const HalfEdge& e = s.half_edges[kept[k]];
    if (e.twin < kept[k]) continue;
    const HalfEdge& back = s.half_edges[e.twin];
    out.from[count] = static_cast<std::uint8_t>(e.origin);
    out.to[count] = static_cast<std::uint8_t>(back.origin);
    out.left[count] = static_cast<std::uint8_t>(e.facet);
    out.right[count] = static_cast<std::uint8_t>(back.facet);
    ++count;
  }
  out.count = count;
}

/// By facet of one body: a set of kept edges of the other, which descend along it; two words of 32 each.
struct Sides {
  alignas(32) std::uint32_t low[kFacetSlots], high[kFacetSlots];

  [[nodiscard]] PD_INLINE std::uint64_t of(int facet) const { return low[facet] | std::uint64_t{high[facet]} << kHalf; }
};

PD_INLINE void tell_half(std::uint32_t (&out)[kFacetSlots], float& least, const KeptEdges& kept, int first,
                         const Heights& heights, int blocks, bool backwards) {
  const int end = kept.count < first + kHalf ? kept.count : first + kHalf;
  Floats least_size = Floats{} + std::numeric_limits<float>::max();
  const std::uint8_t* const above = backwards ? kept.from : kept.to;
  const std::uint8_t* const below = backwards ? kept.to : kept.from;
  for (int k = 0; k < blocks; ++k) {
    Bits bits = {};
    for (int i = first; i < end; ++i) {
      Floats high, low;
      load(high, heights.row[above[i]] + kFloats * k);
      load(low, heights.row[below[i]] + kFloats * k);
      const Floats rise = high - low;
      Bits as_bits;
      __builtin_memcpy(&as_bits, &rise, sizeof(as_bits));
      bits |= as_bits >> 31 << (i - first);
      as_bits &= 0x7fffffffU;
      Floats size;
      __builtin_memcpy(&size, &as_bits, sizeof(size));
      least_size = size < least_size ? size : least_size;
    }
    __builtin_memcpy(out + kFloats * k, &bits, sizeof(bits));
  }
  for (int i = 0; i < kFloats; ++i) least = least_size[i] < least ? least_size[i] : least;
}

/// Returns the least rise or descent.
PD_INLINE float tell_sides(Sides& out, const KeptEdges& kept, const Heights& heights, int blocks, bool backwards) {
  float least = std::numeric_limits<float>::max();
  tell_half(out.low, least, kept, 0, heights, blocks, backwards);
  if (kept.count > kHalf) {
    tell_half(out.high, least, kept, kHalf, heights, blocks, backwards);
  } else {
    for (int k = 0; k < kFloats * blocks; ++k) out.high[k] = 0;
  }
  return least;
}

/// Pairs of edges whose arcs cross.
struct Crossings {
  static constexpr int kMost = 1024;
  int count = 0;
  std::uint8_t a[kMost + kLanes], b[kMost + kLanes];
  double sign[kMost + kLanes];
};

/// Arc j of B crosses the plane of arc i of -A where its two facets lie on different sides of it, and the other way
/// round; of two arcs that do both, on the same half of the sphere where these sides are opposite. False: too many.
PD_INLINE bool list_crossings(Crossings& out, const Sides& edges_a, const Sides& edges_b, const KeptEdges& kept_a,
                              const KeptEdges& kept_b) {
  constexpr double kSigns[2] = {1, -1};
  std::uint64_t left_of[kKept], right_of[kKept];
  for (int i = 0; i < kept_a.count; ++i) {
    left_of[i] = edges_b.of(kept_a.left[i]);
    right_of[i] = left_of[i] ^ edges_b.of(kept_a.right[i]);
  }
  int count = 0;
  for (int j = 0; j < kept_b.count; ++j) {
    const std::uint64_t left = edges_a.of(kept_b.left[j]), across = left ^ edges_a.of(kept_b.right[j]);
    for (std::uint64_t bits = across; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      // Written in any case, and counted where they cross.
      out.a[count] = static_cast<std::uint8_t>(i);
      out.b[count] = static_cast<std::uint8_t>(j);
      out.sign[count] = kSigns[left >> i & 1];
      count += static_cast<int>((right_of[i] >> j) & ((left >> i) ^ (left_of[i] >> j)) & 1);
    }
    if (count > Crossings::kMost - kKept) return false;
  }
  out.count = count;
  return true;
}

using small_sat::LaneVectors;

PD_INLINE void gather(LaneVectors& to, const VertexArrays& v, const std::uint8_t* ids, const std::uint8_t* edges) {
  const int i = ids[edges[0]], j = ids[edges[1]], k = ids[edges[2]], l = ids[edges[3]];
  to.x = Lanes{v.x[i], v.x[j], v.x[k], v.x[l]};
  to.y = Lanes{v.y[i], v.y[j], v.y[k], v.y[l]};
  to.z = Lanes{v.z[i], v.z[j], v.z[k], v.z[l]};
}

PD_INLINE void nearest_crossing(NearestFacet& best, Crossings& pairs, const KeptEdges& kept_a, const KeptEdges& kept_b,
                                const VertexArrays& a, const VertexArrays& b, const double (&offset)[3]) {
  const Lanes zero = {0, 0, 0, 0}, none = zero + std::numeric_limits<double>::infinity();
  for (int k = pairs.count; k % kLanes != 0; ++k) {
    pairs.a[k] = pairs.a[0];
    pairs.b[k] = pairs.b[0];
    pairs.sign[k] = pairs.sign[0];
  }
  Lanes id = {0, 1, 2, 3}, best_key = none, best_id = none, others = none;
  for (int k = 0; k < pairs.count; k += kLanes) {
    LaneVectors p, e, q, f;
    Lanes sign;
    gather(p, a, kept_a.from, pairs.a + k);
    gather(e, a, kept_a.to, pairs.a + k);
    gather(q, b, kept_b.from, pairs.b + k);
    gather(f, b, kept_b.to, pairs.b + k);
    load(sign, pairs.sign + k);
    Lanes lowest, squared;
    small_sat::lowest_corners(lowest, squared, p, e, q, f, sign, offset);
    Lanes found;
    small_sat::key_of(found, lowest, squared);
    const Lanes key = id < static_cast<double>(pairs.count) ? found : none;
    const Lanes lost = key < best_key ? best_key : key;
    best_id = key < best_key ? id : best_id;
    best_key = key < best_key ? key : best_key;
    others = lost < others ? lost : others;
    id += kLanes;
  }
  // Of equal keys the lowest id.
  best.key = least(best_key);
  const Lanes ids = best_key == zero + best.key ? best_id : none;
  best.facet = static_cast<int>(least(ids));
  const Lanes lost = best_id == zero + static_cast<double>(best.facet) ? others : best_key;
  best.others = least(lost);
}

PD_INLINE double largest_coordinate(const VertexArrays& a, const VertexArrays& b, const double (&offset)[3]) {
  const double* const of_a[3] = {a.x, a.y, a.z};
  const double* const of_b[3] = {b.x, b.y, b.z};
  const Lanes low = Lanes{} - std::numeric_limits<double>::max();
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    Lanes most[2] = {low, low}, least_of[2] = {-low, -low};
    const double* const axes[2] = {of_a[i], of_b[i]};
    const int counts[2] = {a.count, b.count};
    for (int body = 0; body < 2; ++body) {
      for (int v = 0; v < counts[body]; v += kLanes) {
        Lanes x;
        load(x, axes[body] + v);
        most[body] = x > most[body] ? x : most[body];
        least_of[body] = x < least_of[body] ? x : least_of[body];
      }
    }
    const double up = greatest(most[0]) + greatest(most[1]) + offset[i];
    const double down = -(least(least_of[0]) + least(least_of[1]) + offset[i]);
    largest = up > largest ? up : largest;
    largest = down > largest ? down : largest;
  }
  return largest;
}

}  // namespace
}  // namespace all_facets

PD_CLONES NearestOfAllFacets nearest_of_all_facets(const AllFacetsBody& a, const AllFacetsBody& b,
                                                   const double (&offset)[3], const AllFacetsErrors& errors) {
  using namespace all_facets;
  NearestOfAllFacets out;
  Planes planes_a, planes_b;
  Heights of_b, of_a;  // along the facets of the other body
  place_planes(planes_a, a, offset);
  place_planes(planes_b, b, offset);
  take_heights(of_b, planes_a, b.posed);
  take_heights(of_a, planes_b, a.posed);
  Lanes lowest = Lanes{} + std::numeric_limits<double>::infinity();
  rough_planes(lowest, planes_a);
  rough_planes(lowest, planes_b);
  const double level = least(lowest) + 4 * errors.height;
  const double none = std::numeric_limits<double>::infinity();
  NearestFacet facet{none, none, 0};
  const int facets_a = a.storage.num_facets, facets_b = b.storage.num_facets;
  nearest_facet(facet, planes_a, of_b, facets_a, b.posed, level, errors.height, 0, out.pieces);
  nearest_facet(facet, planes_b, of_a, facets_b, a.posed, level, errors.height, kFacetSlots, out.pieces);
  out.key = facet.key;
  out.others_key = facet.others;
  if (facet.facet < kFacetSlots) {
    out.facet_a = facet.facet;
  } else {
    out.facet_b = facet.facet - kFacetSlots;
  }
  if (!(out.key > 0)) {
    out.outcome = NearestOfAllFacets::Outcome::beyond;
    return out;
  }
  const double radius = __builtin_sqrt(out.key);
  KeptEdges kept_a, kept_b;
  keep_near_edges(kept_a, a, planes_a, of_b, radius, errors.height);
  keep_near_edges(kept_b, b, planes_b, of_a, radius, errors.height);
  if (kept_a.count > kKept || kept_b.count > kKept) return out;
  Sides edges_a, edges_b;
  if (!(tell_sides(edges_a, kept_a, of_a, planes_b.blocks, true) > errors.side_a)) return out;
  if (!(tell_sides(edges_b, kept_b, of_b, planes_a.blocks, false) > errors.side_b)) return out;
  Crossings pairs;
  if (!list_crossings(pairs, edges_a, edges_b, kept_a, kept_b)) return out;
  out.largest = largest_coordinate(a.posed, b.posed, offset);
  out.outcome = NearestOfAllFacets::Outcome::found;
  out.pieces += pairs.count;
  if (pairs.count == 0) return out;
  NearestFacet crossing{none, none, 0};
  nearest_crossing(crossing, pairs, kept_a, kept_b, a.posed, b.posed, offset);
  const bool wins = crossing.key < out.key;
  const double lost = wins ? out.key : crossing.key, others = wins ? crossing.others : out.others_key;
  out.others_key = lost < others ? lost : others;
  if (!wins) return out;
  const int i = pairs.a[crossing.facet], j = pairs.b[crossing.facet];
  out.key = crossing.key;
  out.facet_a = out.facet_b = -1;
  out.edge_a[0] = kept_a.from[i];
  out.edge_a[1] = kept_a.to[i];
  out.edge_b[0] = kept_b.from[j];
  out.edge_b[1] = kept_b.to[j];
  out.sign = pairs.sign[crossing.facet];
  return out;
}

}  // namespace pd::detail
