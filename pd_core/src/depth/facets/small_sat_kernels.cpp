#include "depth/facets/small_sat_kernels.hpp"

#include <bit>
#include <cstdint>
#include <limits>

#include "depth/facets/small_sat_lanes.hpp"

namespace pd::detail {

namespace small_sat {
namespace {

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
  Lanes others;  ///< the least of the keys that lost
};

/// Lanes from the id `end` on repeat another.
PD_INLINE void take_nearest(NearestLane& best, const Lanes& found, const Lanes& id, double end) {
  const Lanes none = Lanes{} + std::numeric_limits<double>::infinity();
  const Lanes key = id < end ? found : none;
  const Lanes lost = key < best.key ? best.key : key;
  best.id = key < best.key ? id : best.id;
  best.key = key < best.key ? key : best.key;
  best.others = lost < best.others ? lost : best.others;
}

/// By facet of one body: where its plane lies but for the other body, and the square of its normal's length.
struct FacetPlanes {
  Lanes own[kBlocks], squared[kBlocks], key[kBlocks];
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
    key_of(planes.key[k], planes.own[k] + top[k], planes.squared[k]);
    take_nearest(best, planes.key[k], id, first_id + body.map.facets);
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

/// Arc j of B crosses the plane of arc i of -A where its two facets lie on different sides of it, and the other way
/// round; of two arcs that do both, on the same half of the sphere where these sides are opposite.
PD_INLINE void list_crossings(const std::uint32_t (&sides_a)[kFacets], const std::uint32_t (&facets_b)[kEdges],
                              const SmallGaussMap& map_a, const SmallGaussMap& map_b, const KeptEdges& kept_b,
                              Crossings& out) {
  constexpr double kSigns[2] = {1, -1};
  int count = 0;
  for (int k = 0; k < kept_b.count; ++k) {
    const int j = kept_b.edge[k];
    EdgeSet of_a;
    edges_around(of_a, map_a, facets_b[k]);
    const std::uint32_t left_b = sides_a[map_b.left[j]], right_b = sides_a[map_b.right[j]];
    std::uint32_t crossing = (left_b ^ right_b) & (of_a.left ^ of_a.right) & (left_b ^ of_a.left);
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

/// Lists the facets of one body that are near, each with the vertex of the other that is farthest along it.
PD_INLINE void list_near_facets(SmallNearPieces& near, const FacetPlanes& planes, const SmallGaussMap& map, bool of_a,
                                const HeightRows& other, int other_count) {
  double keys[kFacets];
  __builtin_memcpy(keys, planes.key, sizeof(keys));
  for (int f = 0; f < map.facets; ++f) {
    if (!(keys[f] <= near.radius * near.radius)) continue;
    int top = 0;
    for (int v = 1; v < other_count; ++v) top = other.row[v][f] > other.row[top][f] ? v : top;
    const auto facet = static_cast<std::int8_t>(f), on = static_cast<std::int8_t>(map.on_facet[f]),
               far = static_cast<std::int8_t>(top);
    if (of_a) {
      near.add({keys[f], facet, -1, on, far, -1, -1, 1});
    } else {
      near.add({keys[f], -1, facet, far, on, -1, -1, 1});
    }
  }
}

PD_INLINE void nearest_crossing(NearestLane& best, const SmallSatBody& a, const SmallSatBody& b, Crossings& pairs,
                                const double (&offset)[3], SmallNearPieces* near) {
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
    LaneVectors p, e, q, f;
    Lanes sign;
    gather(p, a.posed, from_a);
    gather(e, a.posed, to_a);
    gather(q, b.posed, from_b);
    gather(f, b.posed, to_b);
    load(sign, pairs.sign + k);
    Lanes lowest, squared;
    lowest_corners(lowest, squared, p, e, q, f, sign, offset);
    Lanes key;
    key_of(key, lowest, squared);
    take_nearest(best, key, id, pairs.count);
    id += kLanes;
    if (near == nullptr) continue;
    const unsigned close = mask_of_four(key <= zero + near->radius * near->radius);
    for (unsigned bits = close; bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      if (k + lane >= pairs.count) break;
      near->add({key[lane], -1, -1, -1, -1, static_cast<std::int8_t>(pairs.edge_a(k + lane)),
                 static_cast<std::int8_t>(pairs.edge_b(k + lane)), static_cast<std::int8_t>(sign[lane])});
    }
  }
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
/// @param others  the least key but the winner's.
PD_INLINE int winner(const NearestLane& best, double& key, double& others) {
  const Lanes none = Lanes{} + std::numeric_limits<double>::infinity();
  key = least(best.key);
  const Lanes ids = best.key == Lanes{} + key ? best.id : none;
  const double id = least(ids);
  const Lanes lost = best.id == Lanes{} + id ? best.others : best.key;
  others = least(lost);
  return static_cast<int>(id);
}

}  // namespace
}  // namespace small_sat

PD_CLONES SmallSatNearest nearest_of_small(const SmallSatBody& a, const SmallSatBody& b, const double (&offset)[3],
                                           const SmallSatErrors& errors, SmallNearPieces* near) {
  using namespace small_sat;
  const Lanes none = Lanes{0, 0, 0, 0} + std::numeric_limits<double>::infinity();
  SmallSatNearest out;
  out.possible_key = std::numeric_limits<double>::infinity();
  NearestLane facet{none, none, none}, crossing{none, none, none};
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
  const int nearest_facet = winner(facet, out.key, out.others_key);
  if (nearest_facet < kFacets) {
    out.facet_a = nearest_facet;
  } else {
    out.facet_b = nearest_facet - kFacets;
  }
  if (out.key < 0) return out;
  const double radius = __builtin_sqrt(out.key) + (near != nullptr ? near->band : 0);
  KeptEdges kept_a, kept_b;
  keep_near_edges(a.map, planes_a, of_b, b.posed.count, radius, errors.height, kept_a);
  keep_near_edges(b.map, planes_b, of_a, a.posed.count, radius, errors.height, kept_b);
  std::uint32_t sides_a[kFacets], facets_b[kEdges];
  const float least_side_a = edges_by_facet(a.map, kept_a, of_a, sides_a);
  const float least_side_b = facets_by_edge(b.map, kept_b, of_b, facets_b);
  out.largest = largest_coordinate(a.posed, b.posed, offset);
  Crossings pairs;
  const bool certain = least_side_a > errors.side_a && least_side_b > errors.side_b;
  if (near != nullptr) {
    near->radius = radius;
    list_near_facets(*near, planes_a, a.map, true, of_b, b.posed.count);
    list_near_facets(*near, planes_b, b.map, false, of_a, a.posed.count);
  }
  if (certain) {
    list_crossings(sides_a, facets_b, a.map, b.map, kept_b, pairs);
  } else {
    try_open_sides({a, b, offset, errors}, {of_a, of_b, kept_a, kept_b, sides_a, facets_b}, pairs, out);
  }
  out.crossings = pairs.count;
  nearest_crossing(crossing, a, b, pairs, offset, near);
  if (near != nullptr) near->complete = certain && near->count < SmallNearPieces::kMost;
  if (pairs.count == 0) return out;
  double key = 0, others = 0;
  const int nearest_pair = winner(crossing, key, others);
  out.others_key =
      key < out.key ? (others < out.key ? others : out.key) : (key < out.others_key ? key : out.others_key);
  if (key < out.key) {
    out.key = key;
    out.facet_a = out.facet_b = -1;
    out.edge_a = pairs.edge_a(nearest_pair);
    out.edge_b = pairs.edge_b(nearest_pair);
    out.sign = pairs.sign[nearest_pair];
  }
  return out;
}

}  // namespace pd::detail
