#include <algorithm>
#include <compare>
#include <string>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "pd/structure/decomposition.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd {

namespace {

/// Calls `take(edge of A, edges of B, once for every pair of F that holds them)` edge by edge.
template <class Take>
void for_each_edge_of_a(const Decomposition& decomposition, const ConvexPolytope& a, Take&& take) {
  std::vector<std::int64_t> offsets(static_cast<std::size_t>(a.num_half_edges()) + 1, 0);
  for (int i = 0; i < decomposition.num_pairs(); ++i) {
    for (const std::int32_t e : decomposition.pair(i).edges_a) ++offsets[static_cast<std::size_t>(e) + 1];
  }
  for (std::size_t e = 1; e < offsets.size(); ++e) offsets[e] += offsets[e - 1];
  std::vector<std::int32_t> pairs(static_cast<std::size_t>(offsets.back()));
  std::vector<std::int64_t> next(offsets.begin(), offsets.end() - 1);
  for (int i = 0; i < decomposition.num_pairs(); ++i) {
    for (const std::int32_t e : decomposition.pair(i).edges_a) {
      pairs[static_cast<std::size_t>(next[static_cast<std::size_t>(e)]++)] = i;
    }
  }
  for (std::size_t e = 0; e + 1 < offsets.size(); ++e) {
    for (std::int64_t k = offsets[e]; k < offsets[e + 1]; ++k) {
      take(static_cast<std::int32_t>(e), decomposition.pair(pairs[static_cast<std::size_t>(k)]).edges_b);
    }
  }
}

struct EdgePair {
  std::int32_t a;
  std::int32_t b;
  friend auto operator<=>(const EdgePair&, const EdgePair&) = default;
};

}  // namespace

DecompositionCover cover_of(const Decomposition& decomposition, const ConvexPolytope& a, const ConvexPolytope& b) {
  DecompositionCover cover;
  struct Count {
    std::int32_t edge_a = -1;
    std::int32_t times = 0;
  };
  std::vector<Count> counts(static_cast<std::size_t>(b.num_half_edges()));
  for_each_edge_of_a(decomposition, a, [&](std::int32_t edge_a, std::span<const std::int32_t> edges_b) {
    for (const std::int32_t e : edges_b) {
      Count& count = counts[static_cast<std::size_t>(e)];
      if (count.edge_a != edge_a) {
        count = {edge_a, 0};
        ++cover.edge_edge;
      }
      cover.max_cover = std::max(cover.max_cover, ++count.times);
    }
  });
  return cover;
}

Expected<DecompositionCheck> check_decomposition(const Decomposition& decomposition, const ConvexPolytope& a,
                                                 const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                                                 std::int64_t limit) {
  const detail::FloatingPointGuard guard;
  const detail::PosedPair pair(a, pose_a, b, pose_b);
  detail::OverlayBuffers buffers;
  detail::OverlayWalk walk(pair, buffers);
  DecompositionCheck check;
  std::vector<EdgePair> facets;
  const auto edge_of = [](const ConvexPolytope& body, std::int32_t h) { return std::min(h, body.half_edge(h).twin); };
  const bool complete = walk.run([&](std::span<const detail::OverlayPiece> pieces) {
    for (const detail::OverlayPiece& piece : pieces) {
      if (piece.kind != detail::OverlayPiece::Kind::edges) continue;
      if (static_cast<std::int64_t>(facets.size()) >= limit) return false;
      facets.push_back({edge_of(a, piece.a), edge_of(b, piece.b)});
      const detail::FacetOfDifference facet = detail::facet_of(pair, piece);
      const int sign = pair.sign_determinant(facet.point(), facet.u, facet.v);
      if (sign > 0) {
        ++check.lines_above;
      } else if (sign < 0) {
        ++check.lines_below;
      } else if (!pair.parallel(facet.u, facet.v)) {
        ++check.lines_meeting;
      }
    }
    return true;
  });
  if (!complete) {
    return Error{ErrorCode::limit_exceeded,
                 "the check lists every edge-edge facet, and there are more than " + std::to_string(limit), ""};
  }
  std::sort(facets.begin(), facets.end());

  // Both lists run by edge of A; within one, the facets that F holds are ticked off.
  std::vector<std::int32_t> seen_for(static_cast<std::size_t>(b.num_half_edges()), -1);
  std::vector<char> held(facets.size(), 0);
  auto begin = facets.begin();
  auto end = begin;
  std::int32_t current = -1;
  for_each_edge_of_a(decomposition, a, [&](std::int32_t edge_a, std::span<const std::int32_t> edges_b) {
    if (edge_a != current) {
      current = edge_a;
      begin = std::lower_bound(end, facets.end(), EdgePair{edge_a, -1});
      end = std::lower_bound(begin, facets.end(), EdgePair{edge_a + 1, -1});
    }
    for (const std::int32_t edge_b : edges_b) {
      if (std::exchange(seen_for[static_cast<std::size_t>(edge_b)], edge_a) == edge_a) continue;
      const auto found = std::lower_bound(begin, end, EdgePair{edge_a, edge_b});
      if (found != end && *found == EdgePair{edge_a, edge_b}) {
        held[static_cast<std::size_t>(found - facets.begin())] = 1;
      } else {
        ++check.extra;
      }
    }
  });
  check.missing = std::count(held.begin(), held.end(), 0);
  return check;
}

}  // namespace pd
