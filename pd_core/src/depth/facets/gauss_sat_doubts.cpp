#include <bit>

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

template <class Size>
PD_INLINE void store_words(Sides<Size>& out, int f, const WideBits& bits) {
  for (int lane = 0; lane < kLanes; ++lane) {
    out.low[f + lane] = static_cast<std::uint32_t>(bits[lane]);
    if constexpr (!kIsSmall<Size>) out.high[f + lane] = static_cast<std::uint32_t>(bits[lane] >> Sides<Size>::kHalf);
  }
}

/// @param open  the rises within `error`
template <class Size>
PD_INLINE void tell_precisely(Sides<Size>& out, Sides<Size>& open, const KeptEdges<Size>& kept,
                              const VertexArrays& posed, const Planes<Size>& along, double error, bool backwards) {
  EdgeVectors<Size> edges;
  take_vectors(edges, kept, posed, backwards);
  for (int f = 0; f < kFloats * along.blocks(); f += kLanes) {
    Lanes nx, ny, nz;
    load(nx, along.nx + f);
    load(ny, along.ny + f);
    load(nz, along.nz + f);
    WideBits signs = {}, small = {};
    for (int i = 0; i < kept.count; ++i) {
      const Lanes rise = nx * edges.x[i] + ny * edges.y[i] + nz * edges.z[i];
      WideBits bits, within;
      __builtin_memcpy(&bits, &rise, sizeof(bits));
      const Flags flags = (rise <= error) & (rise >= -error);
      __builtin_memcpy(&within, &flags, sizeof(within));
      signs |= bits >> 63 << i;
      small |= within >> 63 << i;
    }
    store_words(out, f, signs);
    store_words(open, f, small);
  }
}

/// As `list_crossings` of the kernel, but that a side which is open may be either: the pairs that may cross.
template <class Size>
PD_INLINE bool list_with_open_sides(Crossings<Size>& out, const KernelState<Size>& state, const Sides<Size>& open_a,
                                    const Sides<Size>& open_b) {
  using Word = typename Size::Word;
  const KeptEdges<Size>&kept_a = state.kept_a, &kept_b = state.kept_b;
  int count = 0;
  for (int j = 0; j < kept_b.count; ++j) {
    const int left = kept_b.edge[j].left, right = kept_b.edge[j].right;
    const Word left_b = state.sides_a.of(left), right_b = state.sides_a.of(right);
    const Word open_left = open_a.of(left), open_right = open_a.of(right);
    for (Word bits = (left_b ^ right_b) | open_left | open_right; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      const Word left_a = state.sides_b.of(kept_a.edge[i].left), right_a = state.sides_b.of(kept_a.edge[i].right);
      const auto bit = [](Word word, int place) { return static_cast<unsigned>(word >> place & 1); };
      // Of arcs that cross, these are all 1, or all 0.
      const unsigned sides = bit(left_b, i) | bit(~right_b, i) << 1 | bit(~left_a, j) << 2 | bit(right_a, j) << 3;
      const unsigned open = bit(open_left, i) | bit(open_right, i) << 1 | bit(open_b.of(kept_a.edge[i].left), j) << 2 |
                            bit(open_b.of(kept_a.edge[i].right), j) << 3;
      const bool ones = (sides | open) == 15, zeros = (sides & ~open) == 0;
      if (!ones && !zeros) continue;
      out.a[count] = static_cast<std::uint8_t>(i);
      out.b[count] = static_cast<std::uint8_t>(j);
      out.sign[count] = ones && zeros ? 0 : ones ? -1 : 1;
      ++count;
    }
    if (count > Size::kMostCrossings) return false;
  }
  out.count = count;
  return true;
}

template <class Size>
PD_INLINE bool list_precisely(const GaussSatBody& a, const GaussSatBody& b, const GaussSatErrors& errors,
                              KernelState<Size>& state, Crossings<Size>& out) {
  Sides<Size> open_a, open_b;
  tell_precisely(state.sides_a, open_a, state.kept_a, a.posed, state.planes_b, errors.fine_side_a, true);
  tell_precisely(state.sides_b, open_b, state.kept_b, b.posed, state.planes_a, errors.fine_side_b, false);
  return list_with_open_sides(out, state, open_a, open_b);
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
                                        KernelState<Small>& state, Crossings<Small>& out) {
  return list_precisely(a, b, errors, state, out);
}

PD_CLONES bool list_in_double_precision(const GaussSatBody& a, const GaussSatBody& b, const GaussSatErrors& errors,
                                        KernelState<Middle>& state, Crossings<Middle>& out) {
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
