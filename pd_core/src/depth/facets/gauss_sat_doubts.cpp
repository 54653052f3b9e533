#include "depth/facets/gauss_sat_lanes.hpp"

namespace pd::detail::gauss_sat {

namespace {

/// The kept edges of a body as vectors.
template <class Size>
struct EdgeVectors {
  double x[Size::kKept], y[Size::kKept], z[Size::kKept];
};

template <class Size>
PD_INLINE void take_vectors(EdgeVectors<Size>& out, const KeptEdges<Size>& kept, const VertexArrays& v,
                            bool backwards) {
  for (int i = 0; i < kept.count; ++i) {
    const int above = backwards ? kept.edge[i].from : kept.edge[i].to;
    const int below = backwards ? kept.edge[i].to : kept.edge[i].from;
    out.x[i] = v.x[above] - v.x[below];
    out.y[i] = v.y[above] - v.y[below];
    out.z[i] = v.z[above] - v.z[below];
  }
}

/// By facet of one body: the kept edges of the other that may fall along it, as bits, and those that may rise.
template <class Size>
struct FineSides {
  alignas(32) std::uint64_t falling[Size::kFacets];
  alignas(32) std::uint64_t rising[Size::kFacets];
};

/// Doubles each word and adds the flag as its last bit.
PD_INLINE void append(Flags& words, const Flags& flags) { words = words + words - flags; }

/// An edge that rises or falls by no more than `error` may do either.
/// @param facets  the planes of so many are looked at
template <class Size>
PD_INLINE void tell_precisely(FineSides<Size>& out, const KeptEdges<Size>& kept, const VertexArrays& posed,
                              const Planes<Size>& along, int facets, double error, bool backwards) {
  EdgeVectors<Size> edges;
  take_vectors(edges, kept, posed, backwards);
  const Lanes most = Lanes{} + error, least = -most;
  for (int f = 0; f < facets; f += kLanes) {
    Lanes nx, ny, nz;
    load(nx, along.nx + f);
    load(ny, along.ny + f);
    load(nz, along.nz + f);
    Flags falling = {}, rising = {};
    // The last edge first, so that each ends at the bit of its number.
    for (int i = kept.count - 1; i >= 0; --i) {
      const Lanes rise = nx * edges.x[i] + ny * edges.y[i] + nz * edges.z[i];
      append(falling, rise <= most);
      append(rising, rise >= least);
    }
    __builtin_memcpy(out.falling + f, &falling, sizeof(falling));
    __builtin_memcpy(out.rising + f, &rising, sizeof(rising));
  }
}

/// By kept edge of one body: the edges of the other that may fall along the facet to its left and rise along the one
/// to its right, as bits, and those that may rise and fall. Words of 32 bits, in halves.
template <class Size>
struct ArcSides {
  static constexpr int kHalf = 32, kHalves = kIsSmall<Size> ? 1 : 2;
  static constexpr int kPadded = (Size::kKept + kFloats - 1) / kFloats * kFloats;
  using Halves = std::uint32_t[kHalves][kPadded];
  alignas(32) Halves falling, rising;

  PD_INLINE static void set(Halves& to, int edge, std::uint64_t word) {
    to[0][edge] = static_cast<std::uint32_t>(word);
    if constexpr (!kIsSmall<Size>) to[1][edge] = static_cast<std::uint32_t>(word >> kHalf);
  }
  PD_INLINE static std::uint64_t of(const Halves& from, int edge) {
    if constexpr (kIsSmall<Size>) return from[0][edge];
    return from[0][edge] | std::uint64_t{from[kHalves - 1][edge]} << kHalf;
  }
  /// Bit i of the result: bit `column` of edge i's word.
  PD_INLINE static std::uint64_t across(const Halves& from, int edges, int column) {
    const std::uint32_t* const words = from[kIsSmall<Size> ? 0 : column / kHalf];
    std::uint64_t out = 0;
    for (int i = 0; i < edges; i += kFloats) {
      Bits bits;
      __builtin_memcpy(&bits, words + i, sizeof(bits));
      bits <<= kHalf - 1 - column % kHalf;
      Ids flags;
      __builtin_memcpy(&flags, &bits, sizeof(flags));
      out |= std::uint64_t{mask_of_eight(flags)} << i;
    }
    return out;
  }
};

template <class Size>
PD_INLINE void take_arcs(ArcSides<Size>& out, const KeptEdges<Size>& kept, const FineSides<Size>& sides) {
  for (int i = 0; i < kept.count; ++i) {
    const int left = kept.edge[i].left, right = kept.edge[i].right;
    ArcSides<Size>::set(out.falling, i, sides.falling[left] & sides.rising[right]);
    ArcSides<Size>::set(out.rising, i, sides.rising[left] & sides.falling[right]);
  }
}

/// Lists the pairs that may cross, as `list_crossings` of the kernel does, many at a time. Two edges may cross where
/// one falls and then rises along the facets beside the other, while the other rises and then falls along those beside
/// it.
/// @param arcs_a  of edges of A by edges of B
template <class Size>
PD_INLINE bool list_pairs(Crossings<Size>& out, const ArcSides<Size>& arcs_a, int count_a, const ArcSides<Size>& arcs_b,
                          int count_b) {
  using Arcs = ArcSides<Size>;
  // By whether the product of the edges, b x a, may point inwards, and outwards.
  constexpr double kSigns[4] = {0, -1, 1, 0};
  const std::uint64_t all = count_a > 0 ? ~std::uint64_t{0} >> (64 - count_a) : 0;
  int count = 0;
  for (int j = 0; j < count_b; ++j) {
    const std::uint64_t inwards = Arcs::of(arcs_b.falling, j) & Arcs::across(arcs_a.rising, count_a, j) & all;
    const std::uint64_t outwards = Arcs::of(arcs_b.rising, j) & Arcs::across(arcs_a.falling, count_a, j) & all;
    for (std::uint64_t bits = inwards | outwards; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      out.a[count] = static_cast<std::uint8_t>(i);
      out.b[count] = static_cast<std::uint8_t>(j);
      out.sign[count] = kSigns[(inwards >> i & 1) | (outwards >> i & 1) << 1];
      ++count;
    }
    if (count > Size::kMostCrossings) return false;
  }
  out.count = count;
  return true;
}

template <class Size>
PD_INLINE bool list_precisely(const GaussSatBody& a, const GaussSatBody& b, const GaussSatErrors& errors,
                              const KernelState<Size>& state, Crossings<Size>& out) {
  FineSides<Size> along_a, along_b;
  tell_precisely(along_b, state.kept_a, a.posed, state.planes_b, b.storage.num_facets, errors.fine_side_a, true);
  tell_precisely(along_a, state.kept_b, b.posed, state.planes_a, a.storage.num_facets, errors.fine_side_b, false);
  ArcSides<Size> arcs_a, arcs_b;
  take_arcs(arcs_a, state.kept_a, along_a);
  take_arcs(arcs_b, state.kept_b, along_b);
  return list_pairs(out, arcs_a, state.kept_a.count, arcs_b, state.kept_b.count);
}

/// A pair's vectors, a pair a lane.
struct PairVectors {
  LaneVectors ends[4];     ///< of the edge of -A, of that of B
  LaneVectors normals[4];  ///< of the facets beside them
};

PD_INLINE void take_turned(LaneVectors& out, const GaussSatBody& body, const int (&facets)[kLanes]) {
  for (int lane = 0; lane < kLanes; ++lane) {
    const double* const n = body.storage.facet_normals[facets[lane]].data();
    out.x[lane] = n[0];
    out.y[lane] = n[1];
    out.z[lane] = n[2];
  }
  const LaneVectors v = out;
  const double(&m)[9] = body.turn;
  out.x = v.x * m[0] + v.y * m[1] + v.z * m[2];
  out.y = v.x * m[3] + v.y * m[4] + v.z * m[5];
  out.z = v.x * m[6] + v.y * m[7] + v.z * m[8];
}

PD_INLINE void take_pairs(PairVectors& out, const ThinPairs& thin, int first, const GaussSatBody& a,
                          const GaussSatBody& b) {
  const ThinPair* of[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) of[lane] = thin.pairs + (first + lane < thin.count ? first + lane : first);
  for (int k = 0; k < 2; ++k) {
    gather(out.ends[k], a.posed, of[0]->piece.a[k], of[1]->piece.a[k], of[2]->piece.a[k], of[3]->piece.a[k]);
    gather(out.ends[2 + k], b.posed, of[0]->piece.b[k], of[1]->piece.b[k], of[2]->piece.b[k], of[3]->piece.b[k]);
    take_turned(out.normals[k], a, {of[0]->facets_a[k], of[1]->facets_a[k], of[2]->facets_a[k], of[3]->facets_a[k]});
    take_turned(out.normals[2 + k], b,
                {of[0]->facets_b[k], of[1]->facets_b[k], of[2]->facets_b[k], of[3]->facets_b[k]});
  }
}

/// Raises the bounds to the height of the pairs' lowest corners along w.
PD_INLINE void raise(Lanes& key, const PairVectors& of, const LaneVectors& w, const double (&offset)[3]) {
  Lanes start_a, end_a, start_b, end_b, squared, found;
  dot(start_a, w, of.ends[0]);
  dot(end_a, w, of.ends[1]);
  dot(start_b, w, of.ends[2]);
  dot(end_b, w, of.ends[3]);
  dot(squared, w, w);
  const Lanes lowest = (start_a < end_a ? start_a : end_a) + (start_b < end_b ? start_b : end_b) +
                       (w.x * offset[0] + w.y * offset[1] + w.z * offset[2]);
  key_of(found, lowest, squared);
  key = found > key ? found : key;
}

PD_INLINE void raise_by_all(Lanes& key, const PairVectors& of, const double (&offset)[3]) {
  for (const LaneVectors& w : of.normals) raise(key, of, w, offset);
  for (int k = 0; k < 4; k += 2) {
    const LaneVectors &u = of.normals[k], &v = of.normals[k + 1];
    raise(key, of, {u.x + v.x, u.y + v.y, u.z + v.z}, offset);
  }
}

}  // namespace

PD_CLONES bool list_in_double_precision(const GaussSatBody& a, const GaussSatBody& b, const GaussSatErrors& errors,
                                        const KernelState<Small>& state, Crossings<Small>& out) {
  return list_precisely(a, b, errors, state, out);
}

PD_CLONES bool list_in_double_precision(const GaussSatBody& a, const GaussSatBody& b, const GaussSatErrors& errors,
                                        const KernelState<Middle>& state, Crossings<Middle>& out) {
  return list_precisely(a, b, errors, state, out);
}

PD_CLONES double bound_thin_pairs(const GaussSatBody& a, const GaussSatBody& b, const double (&offset)[3], double level,
                                  ThinPairs& thin) {
  double dropped = std::numeric_limits<double>::infinity();
  int count = 0;
  const int all = thin.count;
  for (int k = 0; k < all; k += kLanes) {
    PairVectors of;
    take_pairs(of, thin, k, a, b);
    // Their own normals have bounded them before.
    Lanes key = Lanes{} - std::numeric_limits<double>::max();
    raise_by_all(key, of, offset);
    for (int lane = 0; lane < kLanes && k + lane < all; ++lane) {
      ThinPair pair = thin.pairs[k + lane];
      const double best = key[lane] > pair.bound ? key[lane] : pair.bound;
      pair.bound = best < 0 ? -__builtin_sqrt(-best) : __builtin_sqrt(best);
      if (!pair.oriented && pair.bound < thin.unoriented) thin.unoriented = pair.bound;
      if (pair.bound >= level) {
        dropped = pair.bound < dropped ? pair.bound : dropped;
      } else {
        thin.pairs[count++] = pair;
      }
    }
  }
  thin.count = count;
  return dropped;
}

}  // namespace pd::detail::gauss_sat
