/// @file
/// The second half of the kernel for Gauss maps: on which side of facets' normals the kept edges run, and the pairs of
/// edges whose arcs cross, or may.
///
/// An edge's sides for all edges of the other body are bits of one word, so that crossings are found many at a time.
/// Sides that single precision leaves open count as both, and double precision tells them pair by pair, once few pairs
/// are left. Where many edges are kept, a parallelogram's distance in single precision leaves most pairs out.
///
/// Everything here becomes a part of the function that uses it (numeric/lanes.hpp).
#pragma once

#include "depth/facets/gauss_sat_planes.hpp"

namespace pd::detail::gauss_sat {

/// Words that hold a set of a body's kept edges.
template <class Size>
inline constexpr int kWords = kIsSmall<Size> ? 1 : 2;
inline constexpr int kWordBits = 32;

/// Sets of the other body's kept edges, by facet of one body: those that may fall along it, and those that may rise.
template <class Size>
struct Sides {
  alignas(32) std::uint32_t falling[kWords<Size>][Size::kFacets], rising[kWords<Size>][Size::kFacets];
};

/// An edge that rises or falls by no more than `error` may do either.
/// @param heights  of the edges' vertices along the facets
template <class Size>
PD_INLINE void tell_sides(Sides<Size>& out, const KeptEdges<Size>& kept, const Heights<Size>& heights, int blocks,
                          float error, bool backwards) {
  const Floats most = Floats{} + error, least = -most;
  for (int word = 0; word < kWords<Size>; ++word) {
    const int first = word * kWordBits, end = kept.count < first + kWordBits ? kept.count : first + kWordBits;
    for (int k = 0; k < blocks; ++k) {
      Ids falling = {}, rising = {};
      // The last edge first, so that each ends at the bit of its number.
      for (int i = end - 1; i >= first; --i) {
        const GaussEdge& e = kept.edge[i];
        Floats high, low;
        load(high, heights.row[backwards ? e.from : e.to] + kFloats * k);
        load(low, heights.row[backwards ? e.to : e.from] + kFloats * k);
        const Floats rise = high - low;
        falling = falling + falling - (rise <= most);
        rising = rising + rising - (rise >= least);
      }
      __builtin_memcpy(out.falling[word] + kFloats * k, &falling, sizeof(falling));
      __builtin_memcpy(out.rising[word] + kFloats * k, &rising, sizeof(rising));
    }
  }
}

/// Sets of the other body's edges, by kept edge of one body: those that may fall along the facet to its left and rise
/// along the one to its right, those that may rise and fall, and those of which a side is open.
template <class Size>
struct ArcSides {
  static constexpr int kPadded = (Size::kKept + kFloats - 1) / kFloats * kFloats;
  using Words = std::uint32_t[kWords<Size>][kPadded];
  alignas(32) Words falling, rising, open;

  PD_INLINE static typename Size::Word of(const Words& from, int edge) {
    typename Size::Word out = from[0][edge];
    if constexpr (!kIsSmall<Size>) out |= typename Size::Word{from[1][edge]} << kWordBits;
    return out;
  }
  /// Bit i of the result: bit `column` of edge i's word.
  PD_INLINE static typename Size::Word across(const Words& from, int edges, int column) {
    const std::uint32_t* const words = from[kIsSmall<Size> ? 0 : column / kWordBits];
    typename Size::Word out = 0;
    for (int i = 0; i < edges; i += kFloats) {
      Bits bits;
      __builtin_memcpy(&bits, words + i, sizeof(bits));
      bits <<= kWordBits - 1 - column % kWordBits;
      Ids flags;
      __builtin_memcpy(&flags, &bits, sizeof(flags));
      out |= typename Size::Word{mask_of_eight(flags)} << i;
    }
    return out;
  }
};

/// @param heights  of the other body's vertices along the facets beside `edges`, in so many blocks
/// @param error    of an edge of the other body; it runs backwards if it is one of -A
template <class Size>
PD_INLINE void take_arcs(ArcSides<Size>& out, const KeptEdges<Size>& edges, const Heights<Size>& heights,
                         const KeptEdges<Size>& others, int blocks, float error, bool backwards) {
  Sides<Size> sides;
  tell_sides(sides, others, heights, blocks, error, backwards);
  for (int word = 0; word < kWords<Size>; ++word) {
    const auto &falling = sides.falling[word], &rising = sides.rising[word];
    for (int i = 0; i < edges.count; ++i) {
      const int left = edges.edge[i].left, right = edges.edge[i].right;
      out.falling[word][i] = falling[left] & rising[right];
      out.rising[word][i] = rising[left] & falling[right];
      out.open[word][i] = (falling[left] & rising[left]) | (falling[right] & rising[right]);
    }
  }
}

/// Bit i becomes the flag of lane i.
PD_INLINE void spread(Ids& out, unsigned bits) {
  out = (Ids{} + static_cast<std::int32_t>(bits)) & Ids{1, 2, 4, 8, 16, 32, 64, 128};
}

/// Kept edges in single precision: unit vectors, and where they start in units of the reach.
template <class Size>
struct RoughEdges {
  alignas(32) float x[Size::kKept], y[Size::kKept], z[Size::kKept];
  alignas(32) float from_x[Size::kKept], from_y[Size::kKept], from_z[Size::kKept];
};

PD_INLINE void store_narrow(float* to, const Lanes& from) {
  const HalfFloats narrow = __builtin_convertvector(from, HalfFloats);
  __builtin_memcpy(to, &narrow, sizeof(narrow));
}

/// @param scale  of the starts, `sign` of the edges
template <class Size>
PD_INLINE void take_rough_edges(RoughEdges<Size>& out, const KeptEdges<Size>& kept, const VertexArrays& v,
                                const double (&offset)[3], double scale, double sign) {
  for (int k = 0; k < kept.count; k += kLanes) {
    const GaussEdge* e[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) e[lane] = kept.edge + (k + lane < kept.count ? k + lane : k);
    LaneVectors p, q;
    gather(p, v, e[0]->from, e[1]->from, e[2]->from, e[3]->from);
    gather(q, v, e[0]->to, e[1]->to, e[2]->to, e[3]->to);
    const LaneVectors along = {q.x - p.x, q.y - p.y, q.z - p.z};
    Lanes length;
    dot(length, along, along);
    take_roots(length);
    const Lanes unit = sign / length;
    store_narrow(out.x + k, along.x * unit);
    store_narrow(out.y + k, along.y * unit);
    store_narrow(out.z + k, along.z * unit);
    store_narrow(out.from_x + k, (p.x + offset[0]) * scale);
    store_narrow(out.from_y + k, (p.y + offset[1]) * scale);
    store_narrow(out.from_z + k, (p.z + offset[2]) * scale);
  }
}

/// Leaves out pairs of edges whose parallelogram lies farther than a level, by its lowest corner along the product of
/// its edges in single precision, in units of the reach.
///
/// Let u = 2^-24. The product of two unit edges errs by 3u, so that corners differ along it by 4u times the lengths of
/// both edges, which are no longer than twice the reach together. The corner errs by 3u, and its height by 3u more.
template <class Size>
struct RoughPairs {
  static constexpr float kError = 0x1p-19F;
  static constexpr int kFew = 128;  ///< pairs that are measured in double precision as soon
  /// A square's rounding, and that of a product whose edges have a sine of 1/8 or more.
  static constexpr float kAbove = 1 + 0x1p-16F, kBelow = 1 - 0x1p-20F, kBroad = 0x1p-6F;

  RoughEdges<Size> a, b;
  double unit;  ///< square of the reach
  float level;  ///< square of a distance
  bool lowers;  ///< a pair that surely is a facet of P lowers the level

  [[nodiscard]] PD_INLINE static bool pays(const KernelState<Size>& state) {
    return !kIsSmall<Size> && state.kept_a.count * state.kept_b.count > kFew;
  }
  PD_INLINE void begin(const KernelState<Size>& state, const VertexArrays& of_a, const VertexArrays& of_b,
                       const double (&offset)[3], double reach, double radius) {
    take_rough_edges(a, state.kept_a, of_a, {0, 0, 0}, 1 / reach, -1);
    take_rough_edges(b, state.kept_b, of_b, offset, 1 / reach, 1);
    unit = reach * reach;
    level = static_cast<float>(radius / reach * (radius / reach)) * kAbove;
  }
  /// Square of a distance: no pair that is left out is nearer.
  [[nodiscard]] PD_INLINE double beyond() const { return static_cast<double>(level * kBelow) * unit; }

  /// Returns those pairs of B's edge j that may be as near.
  /// @param inwards, outwards  edges of A, by the side to which the product may point; `open` where that is in doubt
  PD_INLINE std::uint64_t near(int j, std::uint64_t inwards, std::uint64_t outwards, std::uint64_t open) {
    const std::uint64_t all = inwards | outwards;
    const unsigned counts = lowers ? 0xFF : 0;
    std::uint64_t out = inwards & outwards;
    for (int i = 0; i < Size::kKept && all >> i != 0; i += kFloats) {
      const unsigned pairs = static_cast<unsigned>(all >> i) & 0xFF;
      if (pairs == 0) continue;
      Floats ex, ey, ez, px, py, pz;
      load(ex, a.x + i);
      load(ey, a.y + i);
      load(ez, a.z + i);
      load(px, a.from_x + i);
      load(py, a.from_y + i);
      load(pz, a.from_z + i);
      const Floats x = b.y[j] * ez - b.z[j] * ey, y = b.z[j] * ex - b.x[j] * ez, z = b.x[j] * ey - b.y[j] * ex;
      const Floats squared = x * x + y * y + z * z;
      Floats height = x * (px + b.from_x[j]) + y * (py + b.from_y[j]) + z * (pz + b.from_z[j]);
      Ids down;
      spread(down, static_cast<unsigned>(inwards >> i));
      height = down != 0 ? -height : height;
      const Floats low = height - kError, high = height + kError;
      const Floats key = (high > 0 ? high * high : Floats{}) / squared * kAbove;
      const unsigned lower =
          pairs & counts & ~static_cast<unsigned>(open >> i) & mask_of_eight((key < level) & (squared > kBroad));
      if (lower != 0) {
        for (int k = 0; k < kFloats; ++k) level = (lower >> k & 1) != 0 && key[k] < level ? key[k] : level;
      }
      const Ids far = (low > 0) & (low * low > level * squared);
      out |= std::uint64_t{pairs & ~mask_of_eight(far)} << i;
    }
    return out;
  }
};

/// Tells in double precision whether the product of two edges, b x a, may point inwards, and whether outwards.
template <class Size>
PD_INLINE void tell_pair(bool& inwards, bool& outwards, const GaussEdge& of_a, const GaussEdge& of_b,
                         const KernelState<Size>& state, const VertexArrays& a, const VertexArrays& b,
                         const GaussSatErrors& errors) {
  const Planes<Size>&along_b = state.planes_b, &along_a = state.planes_a;
  const auto rise = [&](const double* va, const double* vb, const double* nb, const double* na) {
    const double e = va[of_a.from] - va[of_a.to], f = vb[of_b.to] - vb[of_b.from];
    return Lanes{nb[of_b.left], nb[of_b.right], na[of_a.left], na[of_a.right]} * Lanes{e, e, f, f};
  };
  const Lanes rises = rise(a.x, b.x, along_b.nx, along_a.nx) + rise(a.y, b.y, along_b.ny, along_a.ny) +
                      rise(a.z, b.z, along_b.nz, along_a.nz);
  const Lanes most = {errors.fine_side_a, errors.fine_side_a, errors.fine_side_b, errors.fine_side_b};
  // The edge of A may fall and then rise along the facets beside that of B, which then rises and falls, or both vice
  // versa.
  constexpr unsigned kOuter = 0b1001, kInner = 0b0110;
  const unsigned falling = mask_of_four(rises <= most), rising = mask_of_four(rises >= -most);
  inwards = ((falling & kOuter) | (rising & kInner)) == (kOuter | kInner);
  outwards = ((rising & kOuter) | (falling & kInner)) == (kOuter | kInner);
}

/// Lists the pairs that cross or may. Two edges cross where one falls and then rises along the facets beside the other,
/// while the other rises and then falls along those beside it. False: there are too many.
/// @param rough  leaves out pairs that are farther; or nullptr
template <class Size>
PD_INLINE bool list_pairs(Crossings<Size>& out, const ArcSides<Size>& arcs_a, const ArcSides<Size>& arcs_b,
                          const KernelState<Size>& state, const VertexArrays& a, const VertexArrays& b,
                          const GaussSatErrors& errors, RoughPairs<Size>* rough) {
  using Arcs = ArcSides<Size>;
  using Word = typename Size::Word;
  constexpr double kSigns[4] = {0, -1, 1, 0};  // by whether it may point inwards, and outwards
  const int count_a = state.kept_a.count;
  int count = 0;
  for (int j = 0; j < state.kept_b.count; ++j) {
    Word inwards = Arcs::of(arcs_b.falling, j) & Arcs::across(arcs_a.rising, count_a, j);
    Word outwards = Arcs::of(arcs_b.rising, j) & Arcs::across(arcs_a.falling, count_a, j);
    Word pairs = inwards | outwards;
    const Word open = (Arcs::of(arcs_b.open, j) | Arcs::across(arcs_a.open, count_a, j)) & pairs;
    if (!kIsSmall<Size> && rough != nullptr) pairs = rough->near(j, inwards, outwards, open);
    for (Word bits = open & pairs; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      bool in, out_of;
      tell_pair(in, out_of, state.kept_a.edge[i], state.kept_b.edge[j], state, a, b, errors);
      inwards = (inwards & ~(Word{1} << i)) | Word{in} << i;
      outwards = (outwards & ~(Word{1} << i)) | Word{out_of} << i;
    }
    for (Word bits = pairs & (inwards | outwards); bits != 0; bits &= bits - 1) {
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

}  // namespace pd::detail::gauss_sat
