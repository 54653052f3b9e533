#include "depth/facets/gauss_sat_lanes.hpp"

namespace pd::detail::gauss_sat {

namespace {

/// A pair's vectors, a pair a lane.
struct PairVectors {
  LaneVectors ends[4];     ///< of the edge of -A, of that of B
  LaneVectors normals[4];  ///< of the facets beside them
};

PD_INLINE void take_pairs(PairVectors& out, const ThinPairs& thin, int first, const SliverBody& a,
                          const SliverBody& b) {
  const ThinPair* of[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) of[lane] = thin.pairs + (first + lane < thin.count ? first + lane : first);
  for (int k = 0; k < 2; ++k) {
    gather(out.ends[k], a.posed, of[0]->piece.a[k], of[1]->piece.a[k], of[2]->piece.a[k], of[3]->piece.a[k]);
    gather(out.ends[2 + k], b.posed, of[0]->piece.b[k], of[1]->piece.b[k], of[2]->piece.b[k], of[3]->piece.b[k]);
    gather(out.normals[k], a.normals, of[0]->facets_a[k], of[1]->facets_a[k], of[2]->facets_a[k], of[3]->facets_a[k]);
    gather(out.normals[2 + k], b.normals, of[0]->facets_b[k], of[1]->facets_b[k], of[2]->facets_b[k],
           of[3]->facets_b[k]);
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

PD_CLONES double bound_thin_pairs(const SliverBody& a, const SliverBody& b, const double (&offset)[3], double level,
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
