/// @file
/// The shortest way out of one union of polytopes for another one, in doubles: seams and slots that are narrower than a
/// slack are closed.
///
/// P is the union of the differences P_ij = B_j + (-A_i); the way leads to the point of P's boundary nearest to the
/// origin. Facets of the P_ij wait in the order of their distance. The first facet's nearest point is asked for a P_kl
/// that holds it and leads on. Such a P_kl is cut out of the facet, and the rest of the facet waits again. A P_ij is
/// built when the search has come as far as the pair is deep, or apart. [A] open problem (ii), as
/// pd/compound/compound_depth.hpp solves it with exact signs: there the narrowest slot is a way out.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
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
  struct Facet {
    Vec3 normal;  ///< unit, outward
    double offset;
  };
  /// One P_ij.
  struct Piece {
    std::size_t a;
    std::size_t b;
    Vec3 low;  ///< a box that holds it
    Vec3 high;
    double depth = 0;  ///< once it is measured: it holds the ball of this radius about the origin
    bool measured = false;
    bool built = false;
    std::size_t first = 0;  ///< of its facets
    std::size_t count = 0;
  };
  /// A piece (it has no corners) or a part of a facet that waits.
  struct Waiting {
    double key;  ///< nothing of it is nearer
    std::int64_t order;
    std::size_t piece;
    std::size_t facet = 0;    ///< of all facets
    std::size_t corner = 0;   ///< the first of the part's
    std::size_t count = 0;    ///< of its corners
    std::size_t clipped = 0;  ///< place of the set of pieces that were cut out of it
    Vec3 nearest = Vec3::Zero();
  };

  /// Puts polytopes in the place of smooth pieces. @return false if one is too large for a polytope
  bool stand_in(std::vector<PosedShape>& pieces);
  /// Lets all pieces wait. @return false if a smooth one is too large for a polytope
  bool begin(std::span<const PosedShape> a, std::span<const PosedShape> b, double pose_rounding, Scratch& scratch);
  /// How deep or far apart the pair is, and lets it wait again until it has to be built.
  void measure(std::size_t piece);
  /// @return false beyond the budget
  bool build(std::size_t piece);
  /// Lets a facet's polygon wait.
  void push_part(const std::vector<Vec3>& polygon, std::size_t piece, std::size_t facet, std::size_t clipped);
  /// Lets a piece wait that is so far away or deep.
  void push_piece(double distance, std::size_t piece);
  void push(Waiting waiting);
  Waiting pop();
  /// A piece that holds the part's nearest point, leads on from there and was not cut out; nothing: there is none.
  /// @return false beyond the budget
  bool find_cover(const Waiting& part, std::optional<std::size_t>& cover);
  /// Tells whether a piece holds a point of a facet and leads on along the facet's normal.
  [[nodiscard]] bool covered_by(const Piece& piece, const Vec3& x, const Vec3& n) const;
  /// Lets what a piece leaves of the part wait.
  void cut(const Waiting& part, std::size_t piece);

  std::vector<PosedShape> a_;
  std::vector<PosedShape> b_;
  std::deque<ConvexShape> inner_;  ///< in the place of smooth pieces
  Scratch* scratch_ = nullptr;
  std::int64_t facets_left_ = 0;
  double slack_ = 0;
  bool inside_one_ = false;  ///< the origin lies in a piece that was measured
  std::int64_t order_ = 0;
  std::size_t words_ = 0;  ///< of a set of pieces
  std::vector<Piece> pieces_;
  std::vector<std::size_t> built_;  ///< what covered last comes first
  std::vector<Facet> facets_;
  std::vector<Vec3> corners_;
  std::vector<std::uint64_t> sets_;
  std::vector<Waiting> queue_;  ///< a heap
  std::vector<Vec3> polygon_;
  std::vector<Vec3> outside_;
  std::vector<Vec3> inside_;
  std::vector<double> heights_;
};

}  // namespace pd
