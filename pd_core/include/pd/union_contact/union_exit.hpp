/// @file
/// The shortest way out of one union of polytopes for another one, in doubles: seams and slots that are narrower than a
/// slack are closed.
///
/// P is the union of the differences P_ij = B_j + (-A_i); the way leads to the point of P's boundary nearest to the
/// origin. The search is that of pd/compound/compound_depth.hpp ([A] open problem (ii)), which takes the narrowest slot
/// for a way out. A P_ij is built when the search has come as far as the pair is deep, or apart.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

class Scratch;

class UnionExit {
 public:
  struct Way {
    Vec3 by = Vec3::Zero();  ///< for A's cores
    std::size_t a = 0;       ///< the pieces that part last
    std::size_t b = 0;
  };
  enum class Outcome {
    found,
    apart,       ///< the cores do not overlap
    over_budget  ///< more facets than may be built, or a smooth piece that is too large for a polytope
  };
  struct Limits {
    std::int64_t max_facets;  ///< of the P_ij that may be built
    double pose_rounding;     ///< as of `seam_slack`
  };
  /// Margins are left aside. A smooth piece counts as the hull of 26 points of its surface: the way then has the
  /// direction of a short one, and is too short by what lies outside of the hull.
  /// Time: up to one query of depth a pair of pieces, and O(k f) for each cut in the k P_ij that hold its point and
  /// their f facets.
  Outcome find(std::span<const PosedShape> a, std::span<const PosedShape> b, const Limits& limits, Scratch& scratch,
               Way& way);

 private:
  /// Puts polytopes in the place of smooth pieces. @return false if one is too large for a polytope
  bool stand_in(std::span<const PosedShape> given, std::vector<PosedShape>& pieces);

  std::vector<PosedShape> a_;
  std::vector<PosedShape> b_;
  std::deque<ConvexShape> inner_;  ///< in the place of smooth pieces
};

}  // namespace pd
