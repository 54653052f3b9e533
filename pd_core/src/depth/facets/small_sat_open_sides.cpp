#include <bit>

#include "depth/facets/small_sat_lanes.hpp"

namespace pd::detail::small_sat {

namespace {

template <class Floating, class Flagged>
PD_INLINE void put_if_small(Flagged& bits, const Floating& value, float error, int place) {
  Flagged size, small;
  __builtin_memcpy(&size, &value, sizeof(size));
  size &= ~kSign;
  Floating magnitude;
  __builtin_memcpy(&magnitude, &size, sizeof(magnitude));
  const auto within = magnitude <= Floating{} + error;
  __builtin_memcpy(&small, &within, sizeof(small));
  bits |= small >> 31 << place;
}

/// Bit i of open[f]: the rise of kept edge i along facet f is within its error.
PD_INLINE void open_sides(const SmallGaussMap& map, const KeptEdges& kept, const HeightRows& heights, float error,
                          std::uint32_t (&open)[kFacets]) {
  Bits low = {};
  HalfBits high = {};
  for (int k = 0; k < kept.count; ++k) {
    const int i = kept.edge[k];
    Floats rise;
    HalfFloats rise_high;
    rise_between(rise, rise_high, heights.row[map.from[i]], heights.row[map.to[i]]);
    put_if_small(low, rise, error, i);
    put_if_small(high, rise_high, error, i);
  }
  __builtin_memcpy(open, &low, sizeof(low));
  __builtin_memcpy(open + kFloats, &high, sizeof(high));
}

/// Where some sides are open: the pairs that cross for certain, and those that may.
PD_INLINE void list_with_open_sides(const std::uint32_t (&sides_a)[kFacets], const std::uint32_t (&facets_b)[kEdges],
                                    const std::uint32_t (&open_a)[kFacets], const std::uint32_t (&open_b)[kFacets],
                                    const SmallGaussMap& map_a, const SmallGaussMap& map_b, const KeptEdges& kept_a,
                                    const KeptEdges& kept_b, Crossings& certain, Crossings& possible) {
  std::uint32_t kept = 0;
  for (int k = 0; k < kept_a.count; ++k) kept |= 1U << kept_a.edge[k];
  certain.count = possible.count = 0;
  for (int k = 0; k < kept_b.count; ++k) {
    const int j = kept_b.edge[k];
    std::uint32_t open_facets = 0;
    for (int f = 0; f < kFacets; ++f) open_facets |= (open_b[f] >> j & 1) << f;
    EdgeSet of_a, open;
    edges_around(of_a, map_a, facets_b[k]);
    edges_around(open, map_a, open_facets);
    const std::uint32_t left_b = sides_a[map_b.left[j]], right_b = sides_a[map_b.right[j]];
    const std::uint32_t open_left = open_a[map_b.left[j]], open_right = open_a[map_b.right[j]];
    const std::uint32_t any_open = open_left | open_right | open.left | open.right;
    // Of four signs two pairs differ and two agree.
    const std::uint32_t may =
        ((left_b ^ right_b) | open_left | open_right) & ((of_a.left ^ of_a.right) | open.left | open.right) &
        ((left_b ^ of_a.left) | open_left | open.left) & ((right_b ^ of_a.right) | open_right | open.right) &
        (~(left_b ^ of_a.right) | open_left | open.right) & (~(right_b ^ of_a.left) | open_right | open.left) & kept;
    for (std::uint32_t bits = may; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      Crossings& to = (any_open >> i & 1) != 0 ? possible : certain;
      to.pair[to.count] = static_cast<std::uint32_t>(Crossings::kStride * j + i);
      to.sign[to.count++] = (left_b >> i & 1) != 0 ? -1 : 1;
    }
  }
}

/// The least of the possible pieces' distances, as sign * square. Each lies above its lowest corner along any vector:
/// the one along which that is highest counts, of the four normals between which its own would lie. Where an arc ends
/// on the other, or lies along it, one of them is the piece's own normal.
PD_INLINE double least_possible(const SmallSatBody& a, const SmallSatBody& b, const TurnedNormals& normals_a,
                                const TurnedNormals& normals_b, Crossings& pairs, const double (&offset)[3]) {
  const Lanes zero = {0, 0, 0, 0};
  alignas(32) double n[2][3][kFacets];
  for (int k = 0; k < kBlocks; ++k) {
    store(n[0][0] + kLanes * k, normals_a.n[k].x);
    store(n[0][1] + kLanes * k, normals_a.n[k].y);
    store(n[0][2] + kLanes * k, normals_a.n[k].z);
    store(n[1][0] + kLanes * k, normals_b.n[k].x);
    store(n[1][1] + kLanes * k, normals_b.n[k].y);
    store(n[1][2] + kLanes * k, normals_b.n[k].z);
  }
  for (int k = pairs.count; k % kLanes != 0; ++k) pairs.pair[k] = pairs.pair[0];
  Lanes least_key = zero + std::numeric_limits<double>::infinity();
  for (int k = 0; k < pairs.count; k += kLanes) {
    int ends[4][kLanes], facets[4][kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const int i = pairs.edge_a(k + l), j = pairs.edge_b(k + l);
      ends[0][l] = a.map.from[i];
      ends[1][l] = a.map.to[i];
      ends[2][l] = b.map.from[j];
      ends[3][l] = b.map.to[j];
      facets[0][l] = a.map.left[i];
      facets[1][l] = a.map.right[i];
      facets[2][l] = b.map.left[j];
      facets[3][l] = b.map.right[j];
    }
    LaneVectors p, e, q, f;
    gather(p, a.posed, ends[0]);
    gather(e, a.posed, ends[1]);
    gather(q, b.posed, ends[2]);
    gather(f, b.posed, ends[3]);
    Lanes best = zero - std::numeric_limits<double>::max();
    for (int side = 0; side < 4; ++side) {
      const double(&from)[3][kFacets] = n[side / 2];
      LaneVectors w;
      gather(w, {from[0], from[1], from[2], kFacets}, facets[side]);
      const Lanes start_a = w.x * p.x + w.y * p.y + w.z * p.z;
      const Lanes end_a = w.x * e.x + w.y * e.y + w.z * e.z;
      const Lanes start_b = w.x * q.x + w.y * q.y + w.z * q.z;
      const Lanes end_b = w.x * f.x + w.y * f.y + w.z * f.z;
      const Lanes lowest = (start_a < end_a ? start_a : end_a) + (start_b < end_b ? start_b : end_b) +
                           (w.x * offset[0] + w.y * offset[1] + w.z * offset[2]);
      Lanes key;
      key_of(key, lowest, w.x * w.x + w.y * w.y + w.z * w.z);
      best = key > best ? key : best;
    }
    least_key = best < least_key ? best : least_key;
  }
  return least(least_key);
}

}  // namespace

PD_CLONES void try_open_sides(const Question& question, const Sides& known, Crossings& certain, SmallSatNearest& out) {
  const SmallSatBody& a = question.a;
  const SmallSatBody& b = question.b;
  std::uint32_t open_a[kFacets], open_b[kFacets];
  open_sides(a.map, known.kept_a, known.of_a, question.errors.side_a, open_a);
  open_sides(b.map, known.kept_b, known.of_b, question.errors.side_b, open_b);
  Crossings possible;
  list_with_open_sides(known.sides_a, known.facets_b, open_a, open_b, a.map, b.map, known.kept_a, known.kept_b, certain,
                       possible);
  out.possible = possible.count;
  if (possible.count == 0) return;
  TurnedNormals normals_a, normals_b;
  turn_normals(normals_a, a);
  turn_normals(normals_b, b);
  out.possible_key = least_possible(a, b, normals_a, normals_b, possible, question.offset);
}

}  // namespace pd::detail::small_sat
