#include "depth/facets/facet_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/face_sum.hpp"

namespace pd::detail {

namespace {

std::array<std::int32_t, 5> rank(const PosedPair& pair, const OverlayPiece& piece) {
  const FacetOfDifference f = facet_of(pair, piece);
  return {static_cast<std::int32_t>(piece.kind), f.on_a.first, f.on_a.second, f.on_b.first, f.on_b.second};
}

bool known(const FacetCandidate& c) { return c.error < std::numeric_limits<double>::infinity(); }

}  // namespace

int compare_rank(const PosedPair& pair, const OverlayPiece& x, const OverlayPiece& y) {
  const auto order = rank(pair, x) <=> rank(pair, y);
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

void FacetSelection::compact() {
  std::erase_if(*candidates_, [&](const FacetCandidate& c) { return c.lower > upper_; });
  limit_ = std::max<std::size_t>(64, 2 * candidates_->size());
}

std::optional<OverlayPiece> FacetSelection::winner(bool exactly) {
  compact();
  if (candidates_->size() > 1) compare_in_double_double();
  if (candidates_->empty()) return std::nullopt;
  if (candidates_->size() == 1) return candidates_->front().piece;

  // Several planes at one distance, as far as double-double sees. Pieces that only cut another one's plane (or have no
  // area) step back: the piece that stands for their facet ties with them.
  std::erase_if(*candidates_, [&](const FacetCandidate& c) {
    return c.piece.kind != OverlayPiece::Kind::facet_of_a && !whole_facet(*walk_, c.piece);
  });
  const PosedPair& pair = walk_->pair();
  std::sort(candidates_->begin(), candidates_->end(),
            [&](const FacetCandidate& x, const FacetCandidate& y) { return compare_rank(pair, x.piece, y.piece) < 0; });
  if (candidates_->empty()) return std::nullopt;
  // Planes known to the full width of double-double that face clearly apart, and still tie, are equally good: the
  // projection of the origin on either lies in P up to rounding. Of nearly parallel ones only the nearest holds its
  // own.
  const double equal = 1024 * pair.vector_error_dd();
  const auto as_good = [&](const FacetCandidate& x, const FacetCandidate& y) {
    return x.error + y.error <= equal && (x.unit - y.unit).squaredNorm() > 0x1p-40;
  };
  const FacetCandidate* best = &candidates_->front();
  std::optional<SquaredFacetDistance> least;
  for (const FacetCandidate& c : *candidates_) {
    if (&c == best || (!exactly && as_good(c, *best))) continue;
    ++exact_comparisons_;
    if (!least) least = squared_distance(pair, facet_of(pair, best->piece));
    const SquaredFacetDistance squared = squared_distance(pair, facet_of(pair, c.piece));
    if (compare(squared, *least) < 0) {
      best = &c;
      least = squared;
    }
  }
  return best->piece;
}

void FacetSelection::compare_in_double_double() {
  const FacetCandidate* best = nullptr;
  for (FacetCandidate& c : *candidates_) {
    const FacetPlane plane = measure_facet(walk_->pair(), facet_of(walk_->pair(), c.piece));
    c.distance = plane.distance;
    c.error = plane.distance_error;
    c.unit = {plane.unit.x.hi, plane.unit.y.hi, plane.unit.z.hi};
    if (!known(c)) continue;
    if (best == nullptr || to_double(c.distance - best->distance) + (c.error - best->error) < 0) best = &c;
  }
  if (best == nullptr) return;
  const FacetCandidate nearest = *best;
  std::erase_if(*candidates_, [&](const FacetCandidate& c) {
    return known(c) && to_double(c.distance - nearest.distance) > (c.error + nearest.error) * (1 + 4 * kUnitRoundoff);
  });
}

}  // namespace pd::detail
