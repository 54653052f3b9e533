#include "depth/facets/gauss_sat_kernels.hpp"

#include <bit>
#include <limits>

#include "depth/facets/gauss_sat_crossings.hpp"

namespace pd::detail {

namespace gauss_sat {
namespace {

/// Parallelograms of an edge of -A from p to e and one of B from q to f.
struct Parallelograms {
  Lanes lowest, squared;  ///< height of the lowest corner along the normal, sign * b x a, and its squared length
  Lanes edges;            ///< product of the edges' squared lengths
};

/// Rounding moves corners off the plane, and the piece of P lies above the lowest.
PD_INLINE void measure(Parallelograms& out, const LaneVectors& p, LaneVectors& e, const LaneVectors& q, LaneVectors& f,
                       const Lanes& sign, const double (&offset)[3]) {
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
  Lanes along_e, along_f, of_e, of_f;
  dot(along_e, n, e);
  dot(along_f, n, f);
  dot(of_e, e, e);
  dot(of_f, f, f);
  out.lowest = height - (along_e > zero ? along_e : zero) + (along_f < zero ? along_f : zero);
  dot(out.squared, n, n);
  out.edges = of_e * of_f;
}

template <class Size>
PD_INLINE void piece_of_edges(GaussPiece& out, const KeptEdges<Size>& kept_a, const KeptEdges<Size>& kept_b, int i,
                              int j, bool turned) {
  out.facet_a = out.facet_b = -1;
  out.a[0] = static_cast<std::int8_t>(turned ? kept_a.edge[i].to : kept_a.edge[i].from);
  out.a[1] = static_cast<std::int8_t>(turned ? kept_a.edge[i].from : kept_a.edge[i].to);
  out.b[0] = static_cast<std::int8_t>(kept_b.edge[j].from);
  out.b[1] = static_cast<std::int8_t>(kept_b.edge[j].to);
}

/// What `nearest_crossing` finds besides.
struct Found {
  NearGaussPieces* near;  ///< or nullptr
  ThinPairs& thin;
  double facet_key;  ///< slivers that are farther are not listed
};

/// Slivers are no winners: their normals are badly known.
template <class Size>
PD_INLINE void nearest_crossing(Nearest& best, Crossings<Size>& pairs, const KernelState<Size>& state,
                                const VertexArrays& a, const VertexArrays& b, const double (&offset)[3],
                                const Found& found) {
  // Squared: the sine of the angle of two edges whose product turns by 2^9 u or more.
  constexpr double kThin = 0x1p-12;
  const KeptEdges<Size>&kept_a = state.kept_a, &kept_b = state.kept_b;
  const Lanes zero = {0, 0, 0, 0}, none = zero + kNone;
  for (int k = pairs.count; k % kLanes != 0; ++k) {
    pairs.a[k] = pairs.a[0];
    pairs.b[k] = pairs.b[0];
    pairs.sign[k] = pairs.sign[0];
  }
  Lanes id = {0, 1, 2, 3}, best_key = none, best_id = none, others = none;
  for (int k = 0; k < pairs.count; k += kLanes) {
    LaneVectors p, e, q, f;
    Lanes sign;
    const std::uint8_t* const i = pairs.a + k;
    const std::uint8_t* const j = pairs.b + k;
    gather(p, a, kept_a.edge[i[0]].from, kept_a.edge[i[1]].from, kept_a.edge[i[2]].from, kept_a.edge[i[3]].from);
    gather(e, a, kept_a.edge[i[0]].to, kept_a.edge[i[1]].to, kept_a.edge[i[2]].to, kept_a.edge[i[3]].to);
    gather(q, b, kept_b.edge[j[0]].from, kept_b.edge[j[1]].from, kept_b.edge[j[2]].from, kept_b.edge[j[3]].from);
    gather(f, b, kept_b.edge[j[0]].to, kept_b.edge[j[1]].to, kept_b.edge[j[2]].to, kept_b.edge[j[3]].to);
    load(sign, pairs.sign + k);
    Parallelograms of;
    measure(of, p, e, q, f, sign, offset);
    Lanes measured;
    key_of(measured, of.lowest, of.squared);
    const Flags is_pair = id < static_cast<double>(pairs.count), is_thin = of.squared <= kThin * of.edges;
    const Lanes key = is_pair & ~is_thin ? measured : none;
    const Lanes lost = key < best_key ? best_key : key;
    best_id = key < best_key ? id : best_id;
    best_key = key < best_key ? key : best_key;
    others = lost < others ? lost : others;
    id += kLanes;
    for (unsigned bits = mask_of_four(is_pair & is_thin); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      const double sliver = measured[lane];
      if (sliver >= found.facet_key) {
        others[lane] = sliver < others[lane] ? sliver : others[lane];
        continue;
      }
      ThinPair& to = found.thin.pairs[found.thin.count];
      found.thin.count += static_cast<int>(found.thin.count < ThinPairs::kMost);
      to.bound = sliver;
      to.oriented = sign[lane] != 0;
      piece_of_edges(to.piece, kept_a, kept_b, i[lane], j[lane], sign[lane] < 0);
      to.facets_a[0] = kept_a.edge[i[lane]].left;
      to.facets_a[1] = kept_a.edge[i[lane]].right;
      to.facets_b[0] = kept_b.edge[j[lane]].left;
      to.facets_b[1] = kept_b.edge[j[lane]].right;
    }
    if (found.near == nullptr) continue;
    NearGaussPieces& near = *found.near;
    const Flags is_near = (measured <= zero + near.radius * near.radius) & (sign != zero);
    for (unsigned bits = mask_of_four(is_pair & is_near); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      GaussPiece piece;
      piece_of_edges(piece, kept_a, kept_b, i[lane], j[lane], sign[lane] < 0);
      near.add(measured[lane], piece);
    }
  }
  // Of equal keys the lowest id.
  best.key = least(best_key);
  const Lanes ids = best_key == zero + best.key ? best_id : none;
  const double first = least(ids);
  const Lanes lost = best_id == zero + first ? others : best_key;
  best.others = least(lost);
  best.id = best.key < kNone ? static_cast<int>(first) : 0;
}

template <class Size>
PD_INLINE void nearest_of_all(NearestByGaussMaps& out, const GaussSatBody& a, const GaussSatBody& b,
                              const double (&offset)[3], const GaussSatErrors& errors, NearGaussPieces* near,
                              ThinPairs& thin) {
  KernelState<Size> state;
  Heights<Size> of_b, of_a;  // along the facets of the other body
  place_planes(state.planes_a, a, offset);
  place_planes(state.planes_b, b, offset);
  take_heights(of_b, state.planes_a, b.posed);
  take_heights(of_a, state.planes_b, a.posed);
  Lanes lowest = Lanes{} + kNone;
  rough_planes(lowest, state.planes_a);
  rough_planes(lowest, state.planes_b);
  const double level = least(lowest) + 4 * errors.height;
  Nearest facet{kNone, kNone, 0};
  VertexSets<Size> tops_a, tops_b;
  nearest_facet(facet, tops_a, state.planes_a, a.storage.num_facets, b.posed, level, errors.height, 0, out.pieces);
  nearest_facet(facet, tops_b, state.planes_b, b.storage.num_facets, a.posed, level, errors.height, Size::kFacets,
                out.pieces);
  out.key = facet.key;
  out.others_key = facet.others;
  if (facet.id < Size::kFacets) {
    out.piece.facet_a = static_cast<std::int8_t>(facet.id);
  } else {
    out.piece.facet_b = static_cast<std::int8_t>(facet.id - Size::kFacets);
  }
  if (!(out.key > 0)) {
    out.outcome = NearestByGaussMaps::Outcome::beyond;
    return;
  }
  // No facet beyond the upper bound is looked for.
  const double upper_key = key_of(errors.upper, 1);
  if (upper_key < out.others_key) out.others_key = upper_key;
  const double nearest = __builtin_sqrt(out.key), bound = errors.upper < nearest ? errors.upper : nearest;
  const double radius = bound + (near != nullptr ? near->band : 0);
  if (near != nullptr) tops_a = tops_b = {};
  if (!keep_near_edges(state.kept_a, a, state.planes_a, of_b, b.posed.count, tops_a, radius, errors.height)) return;
  if (!keep_near_edges(state.kept_b, b, state.planes_b, of_a, a.posed.count, tops_b, radius, errors.height)) return;
  if (near != nullptr) {
    near->radius = radius;
    list_near_facets(*near, true, a, state.planes_a, of_b, b.posed, errors.height);
    list_near_facets(*near, false, b, state.planes_b, of_a, a.posed, errors.height);
  }
  ArcSides<Size> arcs_a, arcs_b;
  take_arcs(arcs_a, state.kept_a, of_b, state.kept_b, state.planes_a.blocks(), errors.side_b, false);
  take_arcs(arcs_b, state.kept_b, of_a, state.kept_a, state.planes_b.blocks(), errors.side_a, true);
  Crossings<Size> pairs;
  RoughPairs<Size> rough;
  const bool many = RoughPairs<Size>::pays(state);
  if (many) {
    rough.begin(state, a.posed, b.posed, offset, errors.reach, radius);
    rough.lowers = near == nullptr;
  }
  if (!list_pairs(pairs, arcs_a, arcs_b, state, a.posed, b.posed, errors, many ? &rough : nullptr)) return;
  if (many) out.others_key = rough.beyond() < out.others_key ? rough.beyond() : out.others_key;
  out.outcome = NearestByGaussMaps::Outcome::found;
  out.pieces += pairs.count;
  if (pairs.count > 0) {
    Nearest crossing{kNone, kNone, 0};
    nearest_crossing(crossing, pairs, state, a.posed, b.posed, offset, {near, thin, facet.key});
    const bool wins = crossing.key < out.key;
    const double lost = wins ? out.key : crossing.key, others = wins ? crossing.others : out.others_key;
    out.others_key = lost < others ? lost : others;
    if (wins) {
      const int k = crossing.id;
      out.key = crossing.key;
      piece_of_edges(out.piece, state.kept_a, state.kept_b, pairs.a[k], pairs.b[k], pairs.sign[k] < 0);
    }
  }
  if (near != nullptr) near->complete = near->count < NearGaussPieces::kMost;
  if (thin.count == 0) return;
  if (thin.count == ThinPairs::kMost) {
    out.outcome = NearestByGaussMaps::Outcome::full;
    return;
  }
  const double dropped = bound_thin_pairs({a.posed, state.planes_a.normals()}, {b.posed, state.planes_b.normals()},
                                          offset, __builtin_sqrt(out.key) - errors.room, thin);
  if (near != nullptr && thin.unoriented < near->radius) near->radius = thin.unoriented;
  const double dropped_key = key_of(dropped, 1);
  out.others_key = dropped_key < out.others_key ? dropped_key : out.others_key;
}

PD_CLONES void nearest_of_small(NearestByGaussMaps& out, const GaussSatBody& a, const GaussSatBody& b,
                                const double (&offset)[3], const GaussSatErrors& errors, NearGaussPieces* near,
                                ThinPairs& thin) {
  nearest_of_all<Small>(out, a, b, offset, errors, near, thin);
}

PD_CLONES void nearest_of_middle(NearestByGaussMaps& out, const GaussSatBody& a, const GaussSatBody& b,
                                 const double (&offset)[3], const GaussSatErrors& errors, NearGaussPieces* near,
                                 ThinPairs& thin) {
  nearest_of_all<Middle>(out, a, b, offset, errors, near, thin);
}

bool is_small(const ConvexPolytope::Storage& s) { return has_small_gauss_map(s.affine_dimension, s.num_vertices); }

}  // namespace
}  // namespace gauss_sat

NearestByGaussMaps nearest_by_gauss_maps(const GaussSatBody& a, const GaussSatBody& b, const double (&offset)[3],
                                         const GaussSatErrors& errors, NearGaussPieces* near, ThinPairs& thin) {
  NearestByGaussMaps out;
  thin.count = 0;
  thin.unoriented = gauss_sat::kNone;
  if (gauss_sat::is_small(a.storage) && gauss_sat::is_small(b.storage)) {
    gauss_sat::nearest_of_small(out, a, b, offset, errors, near, thin);
  } else {
    gauss_sat::nearest_of_middle(out, a, b, offset, errors, near, thin);
  }
  return out;
}

}  // namespace pd::detail
