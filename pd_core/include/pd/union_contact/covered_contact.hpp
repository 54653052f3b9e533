/// @file
/// Contacts inside of a union: a pair of pieces is answered as if they were alone, and this decides what of the answer
/// holds for the whole.
///
/// A contact pushes off from a facet, an edge or a vertex of its piece. The contact is dropped only if the part of that
/// feature within the body's reach of motion lies wholly in other pieces that lead on against the normal
/// (union_piece.hpp). A facet that is covered only where the contact stands, as walls of a valley or a corner cover
/// each other, keeps it. Where a contact is dropped, the nearest facet of the same piece that is not covered answers,
/// if it lies within reach. Triangles have two facets, their sides, which nothing covers.
///
/// Decided by tolerances of the poses' rounding, since the pieces of a decomposition meet up to rounding only.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/union_contact/piece_surroundings.hpp"

namespace pd {

/// Memory of `keep_uncovered`, one a thread.
struct CoverBuffers {
  UnionPiece made;                       ///< of a piece that the host does not keep
  const UnionPiece* own = &made;         ///< the piece at hand
  std::vector<const UnionPiece*> found;  ///< near the contact
  std::vector<const PiecePlane*> active;
  std::vector<Vec3> feature;
  std::vector<Vec3> spare;
  std::vector<std::pair<double, int>> facets;
};

/// The answer's points are handed to `keep_uncovered`, or made on first use: contacts that are turned or dropped for
/// what lies around them need none.
enum class AnswerPoints : std::uint8_t { made, to_be_made };

/// Two bodies in one step, at least one of them a piece of a union.
struct PiecePair {
  const PosedShape& a;
  const PosedShape& b;
  PieceSurroundings* around_a;  ///< nullptr: A is whole
  PieceSurroundings* around_b;
  double threshold;      ///< up to which gap a pair of points is a contact
  double way;            ///< how far the bodies may move against each other before contacts are found again
  double pose_rounding;  ///< as of `seam_slack`
  CoverBuffers& cover;
  ManifoldScratch& manifold;
  Vec3 front = Vec3::Zero();  ///< zero, or: b is a triangle that has this side only (unit, in the world)
};

/// Changes `points`, the manifold of `answer`, to what holds for the unions that a and b are pieces of.
/// @param given  to_be_made: whatever `points` are, they become those of the answer (as lifted), or what holds
/// @return how many of the two sides changed it
/// Time: a query of the mesh's or compound's tree where a contact is suspect, and O(k f) in the k pieces near it and
/// their f facets.
int keep_uncovered(const PiecePair& pair, const PenetrationDepth& answer, AnswerPoints given, ContactManifold& points);

/// Drops the points of piece A's contact with a plane of B that lie inside of other pieces of A's union which lead on
/// into the plane: those are deeper in it.
/// @return how many
int drop_covered(const PiecePair& pair, ContactManifold& points);

/// Points of a contact along a triangle's front. If A has none over the triangle, `any` takes A's deepest point and its
/// foot in the triangle's plane.
enum class FrontPoints : std::uint8_t { over_triangle, any };

/// The contact of a body A that stands through or behind triangle B and is to leave by B's front: points over
/// the triangle, each as deep as A lies behind its plane.
[[nodiscard]] ContactManifold along_front(const PiecePair& pair, FrontPoints which = FrontPoints::over_triangle);

}  // namespace pd
