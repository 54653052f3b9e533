/// @file
/// Picks the nearest of many facets of P, offered one by one with bounds of their distances: the step that every engine
/// over facets ends with.
///
/// Whatever is certainly farther than the nearest plane so far is dropped at once. What is left at the end, nearly
/// always one facet or the few that tie, is compared in double-double, and what double-double cannot distinguish either
/// as exact fractions (or not at all where a certified bracket is enough: its width is some 1e-30 there). The winner
/// does not depend on the order of the offers: of equals the one with the least rank.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "depth/certificate/facet_plane.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// A facet of P (or a piece of one that lies in its plane) with bounds of its plane's distance from the origin.
struct FacetCandidate {
  OverlayPiece piece;
  double lower = 0;
  double upper = 0;
  DoubleDouble distance{};  ///< the second stage's
  double error = 0;
  Vec3 unit = Vec3::Zero();
};

/// Grown on first use.
using FacetCandidates = std::vector<FacetCandidate>;

class FacetSelection {
 public:
  /// Refers to all of them. `walk` answers which piece stands for a whole facet; it need not have run.
  /// @param upper  a bound on the depth from elsewhere, in the pair's scaled lengths: a facet certainly farther is not
  ///               wanted.
  FacetSelection(const OverlayWalk& walk, FacetCandidates& candidates,
                 double upper = std::numeric_limits<double>::infinity())
      : walk_(&walk), candidates_(&candidates), upper_(upper) {
    candidates.clear();
  }

  /// No facet whose distance is certainly greater need be offered. Falls as offers come in.
  [[nodiscard]] double upper() const { return upper_; }

  /// Offers a plane of a facet of P whose distance, >= 0, lies in [lower, upper] (infinity where nothing is known, as
  /// for pieces whose two edges may be parallel: those have no area and never win).
  void offer(const OverlayPiece& piece, double lower, double upper) {
    if (lower > upper_) return;
    if (upper < upper_) upper_ = upper;
    if (candidates_->size() >= limit_) compact();
    candidates_->push_back({piece, lower, upper, {}, 0, Vec3::Zero()});
  }

  /// The nearest facet; nothing when none was offered. Of facets at equal distances the first by (kind: facet of A,
  /// facet of B, edges; ids of A; ids of B).
  /// @param exactly  whether all facets that double-double cannot distinguish are compared as fractions; else only
  /// those that
  ///                 are nearly parallel, the others count as equal.
  [[nodiscard]] std::optional<OverlayPiece> winner(bool exactly);

  /// Distances compared as fractions.
  [[nodiscard]] std::int64_t exact_comparisons() const { return exact_comparisons_; }

 private:
  void compact();
  void compare_in_double_double();

  const OverlayWalk* walk_;
  FacetCandidates* candidates_;
  double upper_;
  std::size_t limit_ = 64;
  std::int64_t exact_comparisons_ = 0;
};

/// The order of pieces at equal distances: negative when x comes first.
[[nodiscard]] int compare_rank(const PosedPair& pair, const OverlayPiece& x, const OverlayPiece& y);

}  // namespace pd::detail
