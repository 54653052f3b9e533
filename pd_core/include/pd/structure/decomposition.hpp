/// @file
/// The bipartite decomposition of the edge-edge facets of P = B + (-A): [A] section 2.2, "Computing F".
///
/// A pair of edges (e of B, e' of A) is a facet of P exactly when the arcs of e and e' cross in the overlay of the
/// normal diagrams of B and -A. F = {(A_1, B_1), ..., (A_u, B_u)} holds those pairs as few complete bipartite graphs:
///
/// - (C1) A_i (B_i) is a set of edges of A (of B).
/// - (C2) Every pair of A_i x B_i is a facet of P.
/// - (C3) Every edge-edge facet of P lies in some A_i x B_i.
/// - (C4) The lines of A_i and those of B_i are vertically separated (Lemma 2.3, when the origin lies in P).
/// - (C5) F = F_A + F_B. For every i, F_A has O((m / 2^i) log m) pairs with 2^i <= |A_j| < 2^(i+1), whose |B_j| sum to
///   O(n log n). F_B is the same with the roles exchanged.
///
/// So sum(|A_i| + |B_i|) = O((m + n) log^2 (m + n)), although sum |A_i| |B_i| may be as large as m n.
///
/// Departures: six charts on the faces of a cube take the place of two hemispheres, so that no arc is a ray. The
/// random rotation is an infinitesimal one of A (structure/overlay.hpp), so that degenerate bodies are decomposed, too.
/// A pair is found up to once with e in the role of the query and once with e', and again where it lies on a seam.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

class Decomposition {
 public:
  /// Which body's segment tree a pair stems from: its canonical subset is that body's side of the pair.
  enum class Family : std::uint8_t { a, b };

  /// Edges are named by the lower of their two half-edges. The canonical side is in the order in which any line across
  /// its strip meets the arcs, the opposite one in the order of their crossings with the middle canonical arc.
  struct Pair {
    std::span<const std::int32_t> edges_a;
    std::span<const std::int32_t> edges_b;
    Family family;
  };

  /// The pairs of one family whose canonical sets have 2^exponent to 2^(exponent + 1) - 1 edges.
  struct SizeClass {
    Family family;
    std::int32_t exponent;
    std::int64_t pairs;
    std::int64_t opposite_sum;  ///< of the sizes of the opposite sets
  };

  /// Builds F. Exact: (C2) and (C3) hold for the numbers as stored. Time O((m + n) log^2 (m + n) + output) for m and n
  /// edges, where arcs do not crowd within rounding of each other; crowded ones are tried one by one.
  static Decomposition of(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b);

  [[nodiscard]] int num_pairs() const { return static_cast<int>(pairs_.size()); }
  [[nodiscard]] Pair pair(int i) const;

  [[nodiscard]] std::int64_t sum_sizes() const;
  [[nodiscard]] std::int64_t sum_products() const;
  /// Sum of (|A_i| |B_i|)^(3/4): what Theorem 2.5 bounds by O(K^(1/2) (m n log m log n)^(1/4)).
  [[nodiscard]] double closest_lines_work() const;
  /// Those of F_A, then those of F_B, by exponent; empty classes are left out.
  [[nodiscard]] std::vector<SizeClass> size_classes() const;

  /// The place at which a pair's edges begin in one list of edges: A's, then B's.
  struct StoredPair {
    std::int64_t first;
    std::int32_t count_a;
    std::int32_t count_b;
    Family family;
  };

 private:
  std::vector<StoredPair> pairs_;
  std::vector<std::int32_t> edges_;
};

/// How often F holds each pair of edges.
struct DecompositionCover {
  std::int64_t edge_edge = 0;  ///< different pairs of edges in F: the edge-edge facets, K_EE
  std::int32_t max_cover = 0;  ///< the most often that one pair is held
};

/// Counts. Time O(sum |A_i| |B_i|), memory O(sum |A_i| + n).
[[nodiscard]] DecompositionCover cover_of(const Decomposition& decomposition, const ConvexPolytope& a,
                                          const ConvexPolytope& b);

/// F against the overlay, which shares no step with it beyond the sign that decides a crossing. Then the side on which
/// the lines of each edge-edge facet with an area lie, seen along the facet's outward normal (Lemma 2.3).
struct DecompositionCheck {
  std::int64_t missing = 0;        ///< edge-edge facets of the overlay that no pair of F holds (C3)
  std::int64_t extra = 0;          ///< different pairs of edges held by F that are no facets (C2)
  std::int64_t lines_above = 0;    ///< B's line above A's: all of them when the origin lies inside P (C4)
  std::int64_t lines_meeting = 0;  ///< possible where the bodies touch
  std::int64_t lines_below = 0;    ///< only where the bodies are apart
};

/// Checks (C2), (C3) and counts for (C4), exactly. Time O(K log K + sum |A_i| |B_i|), memory O(K + sum |A_i|).
/// @return ErrorCode::limit_exceeded when there are more than `limit` facets.
[[nodiscard]] Expected<DecompositionCheck> check_decomposition(const Decomposition& decomposition,
                                                               const ConvexPolytope& a, const Pose& pose_a,
                                                               const ConvexPolytope& b, const Pose& pose_b,
                                                               std::int64_t limit);

}  // namespace pd
