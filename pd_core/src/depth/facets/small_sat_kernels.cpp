#include "depth/facets/small_sat_kernels.hpp"

#include <bit>
#include <cstdint>
#include <limits>

#include "numeric/lanes.hpp"

namespace pd::detail {

namespace {

typedef std::uint32_t Bits __attribute__((vector_size(32)));
typedef std::uint32_t HalfBits __attribute__((vector_size(16)));

constexpr int kFacets = SmallGaussMap::kMostFacets;
constexpr int kBlocks = kFacets / kLanes;
constexpr int kEdges = SmallGaussMap::kMostEdges;
constexpr std::uint32_t kSign = 0x80000000;
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

PD_INLINE void tops_along(const TurnedNormals& normals, const VertexArrays& other, Lanes (&top)[kBlocks],
                          HeightRows& rows) {
  for (int k = 0; k < kBlocks; ++k) top[k] = Lanes{0, 0, 0, 0} - std::numeric_limits<double>::max();
  for (int v = 0; v < other.count; ++v) {
    for (int k = 0; k < kBlocks; ++k) {
      const LaneVectors& n = normals.n[k];
      const Lanes height = n.x * other.x[v] + n.y * other.y[v] + n.z * other.z[v];
      top[k] = height > top[k] ? height : top[k];
      const HalfFloats rounded = __builtin_convertvector(height, HalfFloats);
      __builtin_memcpy(rows.row[v] + kLanes * k, &rounded, sizeof(rounded));
    }
  }
}

struct NearestLane {
  Lanes key, id;
};

PD_INLINE void take_nearest(NearestLane& best, const Lanes& key, const Lanes& id) {
  best.id = key < best.key ? id : best.id;
  best.key = key < best.key ? key : best.key;
}

/// sign * square of distance, where height = distance * length of the normal; the lowest where there is no normal.
PD_INLINE void key_of(Lanes& key, const Lanes& height, const Lanes& squared) {
  const Lanes zero = {0, 0, 0, 0};
  const Lanes size = height < zero ? -height : height;
  key = squared > zero ? height * size / squared : zero - std::numeric_limits<double>::max();
}

/// By facet of one body: where its plane lies but for the other body, and the square of its normal's length.
struct FacetPlanes {
  Lanes own[kBlocks], squared[kBlocks];
};

PD_INLINE void nearest_facets(NearestLane& best, FacetPlanes& planes, const TurnedNormals& normals,
                              const SmallSatBody& body, const Lanes (&top)[kBlocks], const double (&offset)[3],
                              double first_id) {
  Lanes id = Lanes{0, 1, 2, 3} + first_id;
  for (int k = 0; k < kBlocks; ++k) {
    const LaneVectors& n = normals.n[k];
    Lanes own;
    load(own, body.map.height + kLanes * k);
    planes.own[k] = own * body.growth + (n.x * offset[0] + n.y * offset[1] + n.z * offset[2]);
    planes.squared[k] = n.x * n.x + n.y * n.y + n.z * n.z;
    Lanes key;
    key_of(key, planes.own[k] + top[k], planes.squared[k]);
    take_nearest(best, key, id);
    id += kLanes;
  }
}

template <class Floating, class Flagged>
PD_INLINE void take_sign(Flagged& bits, const Floating& value) {
  Flagged as_bits;
  __builtin_memcpy(&as_bits, &value, sizeof(as_bits));
  bits = bits >> 1 | (as_bits & kSign);
}

template <class Floating, class Flagged>
PD_INLINE void put_sign(Flagged& bits, const Floating& value, int place) {
  Flagged as_bits;
  __builtin_memcpy(&as_bits, &value, sizeof(as_bits));
  bits |= as_bits >> 31 << place;
}

template <class Floating, class Flagged>
PD_INLINE void take_least_size(Floating& least, const Floating& value) {
  Flagged bits;
  __builtin_memcpy(&bits, &value, sizeof(bits));
  bits &= ~kSign;
  Floating size;
  __builtin_memcpy(&size, &bits, sizeof(size));
  least = size < least ? size : least;
}

/// Edges of a body by their numbers.
struct KeptEdges {
  int count;
  int edge[kEdges + 1];
};

/// Edges that may belong to a facet of P no farther than `radius`. A vertex of P, of facet f with vertex v of the other
/// body, may show f too far; where one v does so for both facets of an edge, it does for all directions of its arc
/// (arc_culling.hpp).
PD_INLINE void keep_near_edges(const SmallGaussMap& map, const FacetPlanes& planes, const HeightRows& other,
                               int other_count, double radius, double slack, KeptEdges& out) {
  const Lanes one = Lanes{} + 1.0;
  Floats level;
  HalfFloats level_high;
  HalfFloats part[kBlocks];
  for (int k = 0; k < kBlocks; ++k) {
    // No normal is longer than 1 or than its square.
    const Lanes length = planes.squared[k] > one ? planes.squared[k] : one;
    part[k] = __builtin_convertvector(length * radius - planes.own[k] + slack, HalfFloats);
  }
  __builtin_memcpy(&level, part, sizeof(level));
  __builtin_memcpy(&level_high, part + 2, sizeof(level_high));
  Bits low = {};
  HalfBits high = {};
  for (int v = 0; v < other_count; ++v) {
    Floats height;
    HalfFloats height_high;
    load(height, other.row[v]);
    __builtin_memcpy(&height_high, other.row[v] + kFloats, sizeof(height_high));
    take_sign(low, level - height);
    take_sign(high, level_high - height_high);
  }
  std::uint32_t far[kFacets];
  __builtin_memcpy(far, &low, sizeof(low));
  __builtin_memcpy(far + kFloats, &high, sizeof(high));
  int count = 0;
  for (int e = 0; e < map.edges; ++e) {
    // Written in any case and counted where it stays: no branch to guess.
    out.edge[count] = e;
    count += static_cast<int>((far[map.left[e]] & far[map.right[e]]) == 0);
  }
  out.count = count;
}

PD_INLINE float least_lane(const Floats& v) {
  float least = v[0];
  for (int i = 1; i < kFloats; ++i) least = v[i] < least ? v[i] : least;
  return least;
}

PD_INLINE float least_size(const Floats& low, const HalfFloats& high) {
  float least = least_lane(low);
  for (int i = 0; i < kLanes; ++i) least = high[i] < least ? high[i] : least;
  return least;
}

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

/// Bit i of sides[f]: edge i of -A, turned around, descends along facet f of B. None of edges that are not kept, whose
/// arcs so cross no plane.
PD_INLINE float edges_by_facet(const SmallGaussMap& map, const KeptEdges& kept, const HeightRows& heights,
                               std::uint32_t (&sides)[kFacets]) {
  Bits low = {};
  HalfBits high = {};
  Floats least_low = Floats{} + std::numeric_limits<float>::max();
  HalfFloats least_high = HalfFloats{} + std::numeric_limits<float>::max();
  for (int k = 0; k < kept.count; ++k) {
    const int i = kept.edge[k];
    Floats rise;
    HalfFloats rise_high;
    rise_between(rise, rise_high, heights.row[map.from[i]], heights.row[map.to[i]]);
    put_sign(low, rise, i);
    put_sign(high, rise_high, i);
    take_least_size<Floats, Bits>(least_low, rise);
    take_least_size<HalfFloats, HalfBits>(least_high, rise_high);
  }
  __builtin_memcpy(sides, &low, sizeof(low));
  __builtin_memcpy(sides + kFloats, &high, sizeof(high));
  return least_size(least_low, least_high);
}

/// A set of facets of A for each kept edge of B: those of -A along which it descends.
PD_INLINE float facets_by_edge(const SmallGaussMap& map, const KeptEdges& kept, const HeightRows& heights,
                               std::uint32_t (&facets)[kEdges]) {
  Floats least_low = Floats{} + std::numeric_limits<float>::max();
  HalfFloats least_high = HalfFloats{} + std::numeric_limits<float>::max();
  for (int k = 0; k < kept.count; ++k) {
    const int j = kept.edge[k];
    Floats rise;
    HalfFloats rise_high;
    rise_between(rise, rise_high, heights.row[map.to[j]], heights.row[map.from[j]]);
    take_least_size<Floats, Bits>(least_low, rise);
    take_least_size<HalfFloats, HalfBits>(least_high, rise_high);
    Ids signs;
    HalfIds signs_high;
    __builtin_memcpy(&signs, &rise, sizeof(signs));
    __builtin_memcpy(&signs_high, &rise_high, sizeof(signs_high));
    facets[k] = mask_of_eight(signs) | half_mask(signs_high) << kFloats;
  }
  return least_size(least_low, least_high);
}

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

/// Pairs of edges whose arcs cross.
struct Crossings {
  static constexpr int kRoom = kEdges * kEdges + kLanes;
  static constexpr int kStride = 32;
  int count = 0;
  std::uint32_t pair[kRoom];  ///< kStride * edge of B + edge of A
  double sign[kRoom];         ///< of b x a, to point outwards

  [[nodiscard]] int edge_a(int k) const { return static_cast<int>(pair[k] % kStride); }
  [[nodiscard]] int edge_b(int k) const { return static_cast<int>(pair[k] / kStride); }
};

/// Arc j of B crosses the plane of arc i of -A where its two facets lie on different sides of it, and the other way
/// round; of two arcs that do both, on the same half of the sphere where these sides are opposite.
PD_INLINE void list_crossings(const std::uint32_t (&sides_a)[kFacets], const std::uint32_t (&facets_b)[kEdges],
                              const SmallGaussMap& map_a, const SmallGaussMap& map_b, const KeptEdges& kept_b,
                              Crossings& out) {
  constexpr double kSigns[2] = {1, -1};
  int count = 0;
  for (int k = 0; k < kept_b.count; ++k) {
    const int j = kept_b.edge[k];
    const std::uint32_t set = facets_b[k];
    const std::uint64_t edges = map_a.edges_of_facets[0][set & 15] | map_a.edges_of_facets[1][set >> 4 & 15] |
                                map_a.edges_of_facets[2][set >> 8];
    const auto left_a = static_cast<std::uint32_t>(edges), right_a = static_cast<std::uint32_t>(edges >> 32);
    const std::uint32_t left_b = sides_a[map_b.left[j]], right_b = sides_a[map_b.right[j]];
    std::uint32_t crossing = (left_b ^ right_b) & (left_a ^ right_a) & (left_b ^ left_a);
    // One is written in any case, and counted where there is one: rows of two are rare.
    do {
      const int i = std::countr_zero(crossing | 1U << kEdges);
      out.pair[count] = static_cast<std::uint32_t>(Crossings::kStride * j + i);
      out.sign[count] = kSigns[left_b >> i & 1];
      count += static_cast<int>(crossing != 0);
      crossing &= crossing - 1;
    } while (crossing != 0);
  }
  out.count = count;
}

/// The edges of a body on whose left and right side the facets of a set lie.
struct EdgeSet {
  std::uint32_t left, right;
};

PD_INLINE void edges_around(EdgeSet& out, const SmallGaussMap& map, std::uint32_t facets) {
  const std::uint64_t edges = map.edges_of_facets[0][facets & 15] | map.edges_of_facets[1][facets >> 4 & 15] |
                              map.edges_of_facets[2][facets >> 8];
  out = {static_cast<std::uint32_t>(edges), static_cast<std::uint32_t>(edges >> 32)};
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

PD_INLINE void gather(LaneVectors& to, const VertexArrays& v, const int (&ids)[kLanes]) {
  to.x = Lanes{v.x[ids[0]], v.x[ids[1]], v.x[ids[2]], v.x[ids[3]]};
  to.y = Lanes{v.y[ids[0]], v.y[ids[1]], v.y[ids[2]], v.y[ids[3]]};
  to.z = Lanes{v.z[ids[0]], v.z[ids[1]], v.z[ids[2]], v.z[ids[3]]};
}

PD_INLINE void nearest_crossing(NearestLane& best, const SmallSatBody& a, const SmallSatBody& b, Crossings& pairs,
                                const double (&offset)[3]) {
  const Lanes zero = {0, 0, 0, 0};
  for (int k = pairs.count; k % kLanes != 0; ++k) {
    pairs.pair[k] = pairs.pair[0];
    pairs.sign[k] = pairs.sign[0];
  }
  Lanes id = {0, 1, 2, 3};
  for (int k = 0; k < pairs.count; k += kLanes) {
    int from_a[kLanes], to_a[kLanes], from_b[kLanes], to_b[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const int i = pairs.edge_a(k + l), j = pairs.edge_b(k + l);
      from_a[l] = a.map.from[i];
      to_a[l] = a.map.to[i];
      from_b[l] = b.map.from[j];
      to_b[l] = b.map.to[j];
    }
    LaneVectors p, e, q, f, n;
    Lanes sign;
    gather(p, a.posed, from_a);
    gather(e, a.posed, to_a);
    gather(q, b.posed, from_b);
    gather(f, b.posed, to_b);
    load(sign, pairs.sign + k);
    e.x = p.x - e.x;
    e.y = p.y - e.y;
    e.z = p.z - e.z;
    f.x = f.x - q.x;
    f.y = f.y - q.y;
    f.z = f.z - q.z;
    n.x = sign * (f.y * e.z - f.z * e.y);
    n.y = sign * (f.z * e.x - f.x * e.z);
    n.z = sign * (f.x * e.y - f.y * e.x);
    const Lanes height = n.x * (q.x + p.x + offset[0]) + n.y * (q.y + p.y + offset[1]) + n.z * (q.z + p.z + offset[2]);
    // The other corners, which rounding moves off the plane: the piece of P lies above its lowest corner.
    const Lanes along_e = n.x * e.x + n.y * e.y + n.z * e.z;
    const Lanes along_f = n.x * f.x + n.y * f.y + n.z * f.z;
    const Lanes lowest = height - (along_e > zero ? along_e : zero) + (along_f < zero ? along_f : zero);
    Lanes key;
    key_of(key, lowest, n.x * n.x + n.y * n.y + n.z * n.z);
    take_nearest(best, key, id);
    id += kLanes;
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

/// Greatest and least coordinates of a body of at most eight vertices.
struct Extent {
  Lanes most, least;  ///< x, y, z, x
};

PD_INLINE void extent(Extent& out, const VertexArrays& v) {
  Lanes most[4], least[4];
  const double* const by_axis[4] = {v.x, v.y, v.z, v.x};
  for (int i = 0; i < 4; ++i) {
    Lanes low, high;
    load(low, by_axis[i]);
    load(high, by_axis[i] + kLanes);
    most[i] = high > low ? high : low;
    least[i] = high < low ? high : low;
  }
  transpose(most[0], most[1], most[2], most[3]);
  transpose(least[0], least[1], least[2], least[3]);
  for (int i = 1; i < 4; ++i) {
    most[0] = most[i] > most[0] ? most[i] : most[0];
    least[0] = least[i] < least[0] ? least[i] : least[0];
  }
  out.most = most[0];
  out.least = least[0];
}

PD_INLINE double largest_coordinate(const VertexArrays& a, const VertexArrays& b, const double (&offset)[3]) {
  Extent of_a, of_b;
  extent(of_a, a);
  extent(of_b, b);
  const Lanes moved = {offset[0], offset[1], offset[2], offset[0]};
  const Lanes most = of_a.most + of_b.most + moved;
  const Lanes least = -(of_a.least + of_b.least + moved);
  return greatest(least > most ? least : most);
}

/// Of equal keys the lowest id. Without branches: nothing here could be guessed.
PD_INLINE int winner(const NearestLane& best, double& key) {
  const Lanes none = Lanes{} + std::numeric_limits<double>::infinity();
  key = least(best.key);
  const Lanes ids = best.key == Lanes{} + key ? best.id : none;
  return static_cast<int>(least(ids));
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

}  // namespace

/// Lists the pairs that cross for certain and measures those that may. Apart from the kernel, which most pairs of
/// bodies run alone.
PD_CLONES __attribute__((noinline)) void try_open_sides(const Question& question, const Sides& known,
                                                        Crossings& certain, SmallSatNearest& out) {
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

PD_CLONES SmallSatNearest nearest_of_small(const SmallSatBody& a, const SmallSatBody& b, const double (&offset)[3],
                                           const SmallSatErrors& errors) {
  const Lanes none = Lanes{0, 0, 0, 0} + std::numeric_limits<double>::infinity();
  SmallSatNearest out;
  out.possible_key = std::numeric_limits<double>::infinity();
  NearestLane facet{none, none}, crossing{none, none};
  TurnedNormals normals;
  FacetPlanes planes_a, planes_b;
  Lanes top[kBlocks];
  HeightRows of_b, of_a;  // along the facets of the other body
  turn_normals(normals, a);
  tops_along(normals, b.posed, top, of_b);
  nearest_facets(facet, planes_a, normals, a, top, offset, 0);
  turn_normals(normals, b);
  tops_along(normals, a.posed, top, of_a);
  nearest_facets(facet, planes_b, normals, b, top, offset, kFacets);
  const int nearest_facet = winner(facet, out.key);
  if (nearest_facet < kFacets) {
    out.facet_a = nearest_facet;
  } else {
    out.facet_b = nearest_facet - kFacets;
  }
  if (out.key < 0) return out;
  const double radius = __builtin_sqrt(out.key);
  KeptEdges kept_a, kept_b;
  keep_near_edges(a.map, planes_a, of_b, b.posed.count, radius, errors.height, kept_a);
  keep_near_edges(b.map, planes_b, of_a, a.posed.count, radius, errors.height, kept_b);
  std::uint32_t sides_a[kFacets], facets_b[kEdges];
  const float least_side_a = edges_by_facet(a.map, kept_a, of_a, sides_a);
  const float least_side_b = facets_by_edge(b.map, kept_b, of_b, facets_b);
  out.largest = largest_coordinate(a.posed, b.posed, offset);
  Crossings pairs;
  if (least_side_a > errors.side_a && least_side_b > errors.side_b) {
    list_crossings(sides_a, facets_b, a.map, b.map, kept_b, pairs);
  } else {
    try_open_sides({a, b, offset, errors}, {of_a, of_b, kept_a, kept_b, sides_a, facets_b}, pairs, out);
  }
  out.crossings = pairs.count;
  nearest_crossing(crossing, a, b, pairs, offset);
  double key = 0;
  const int nearest_pair = pairs.count > 0 ? winner(crossing, key) : 0;
  if (pairs.count > 0 && key < out.key) {
    out.key = key;
    out.facet_a = out.facet_b = -1;
    out.edge_a = pairs.edge_a(nearest_pair);
    out.edge_b = pairs.edge_b(nearest_pair);
    out.sign = pairs.sign[nearest_pair];
  }
  return out;
}

}  // namespace pd::detail
