/// @file
/// The pieces of a union that come near a contact of one of them.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "compound_facts.hpp"
#include "shared_edges.hpp"
#include "triangle_boxes.hpp"
#include "triangles_around.hpp"
#include "union_piece.hpp"

class btConvexShape;

namespace pd::detail {

class SolverCore;

/// The half-space of what covers against n: what does not reach into it has no way that leads on along n.
struct Beyond {
  Vec3 n;
  double level;
};

/// Finds pieces, and keeps the children of a step's compounds in place once they were looked at: its contacts ask for
/// the same few, again and again.
class NearPieces {
 public:
  /// To be called for each pair in each step: what belongs to another step is forgotten, and what has moved since.
  /// @param stamp  of this step, 0: unknown, so that nothing is kept
  void begin_pair(std::uint64_t stamp);
  /// The triangles of a mesh that were read for the pair at hand: those near are taken from them where they are enough.
  void know(const TrianglesAround& around, const btCollisionObjectWrapper& mesh);

  /// The other pieces of the union that come within `reach` of a point of this piece, in world coordinates, and within
  /// `slack` of the piece itself, which is not looked at closely. Compounds in compounds
  /// and meshes in compounds included; curved parts are left out, since contacts inside of them do not arise from
  /// seams.
  /// @param beyond  null, or: pieces whose surface does not come beyond it are left out
  /// @param found  valid until `forget_made` or the next pair
  void find(const btCollisionObjectWrapper& piece, const Vec3& point, double reach, double slack, const Beyond* beyond,
            std::uint64_t stamp, SolverCore& core, std::vector<const UnionPiece*>& found);
  /// Whether a triangle that shares an edge with this one, on which `foot` lies, leads on against n by a sine of `sine`
  /// and more: from there and, unless foot is a corner, from all of the edge. No search; false may be either.
  /// @param slack  up to which a point lies on an edge
  [[nodiscard]] bool neighbour_leads_on(const UnionPiece& triangle, const Vec3& foot, const Vec3& n, double sine,
                                        double slack);
  /// Of the triangles that are known.
  [[nodiscard]] SharedEdges& shared_edges() { return known_edges_; }
  [[nodiscard]] CompoundFacts& facts() { return facts_; }

  /// Makes room: what was found may go.
  void forget_made() { num_made_ = 0; }

  /// The piece itself, where it is kept: a child of a compound that is all of its body, or a triangle that is known;
  /// else nullptr.
  [[nodiscard]] UnionPiece* kept(const btCollisionObjectWrapper& piece, SolverCore& core);

 private:
  struct Search;
  class TrianglesOf;
  struct Child {
    std::uint64_t posed = 0;  ///< the compound's visit for which this was posed
    std::uint64_t made = 0;   ///< the visit for which `piece` was made
    btTransform pose;
    btVector3 lower;
    btVector3 upper;
    UnionPiece piece;
  };
  struct PosedCompound {
    const btCollisionObject* body = nullptr;
    const btCompoundShape* shape = nullptr;
    btTransform pose;
    std::uint64_t visit = 0;  ///< what is kept under another number is out of date
    std::vector<Child> children;
  };

  /// Those of the triangles that are known. Requires: they cover what is searched.
  void collect_known(const btCollisionObjectWrapper& except, Search& search, const btVector3& lower,
                     const btVector3& upper);
  /// The piece of one of them, which is made when it is first asked for.
  UnionPiece& known_triangle(std::size_t i);
  /// Adds it, unless it has no planes.
  void add_known(std::size_t i, std::vector<const UnionPiece*>& found);
  /// Of this triangle, or null.
  UnionPiece* known_piece(const btCollisionObjectWrapper& triangle);
  /// @param except  a piece of this shape, or null
  void collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
               Search& search);
  /// @param body   of which the compound is the whole, or null
  /// @param among  the children that are looked at; null: all that are near
  void collect_children(const btCompoundShape& compound, const btTransform& pose, int except,
                        const btCollisionObject* body, const std::vector<int>* among, Search& search);
  /// Whether a child's box comes within reach.
  static bool within(const Child& child, const Search& search);
  /// The body's, whose shape this is.
  PosedCompound& compound_of(const btCollisionObject& body, const btCompoundShape& shape, const btTransform& pose);
  static Child& posed_child(PosedCompound& compound, int i);
  static void make(const CachedShape* shape, std::uint64_t visit, Child& child);
  /// Not taken before `num_made_` grows.
  Child& next_made();

  CompoundFacts facts_;
  std::deque<Child> made_;  ///< for pieces that are no children of a whole body
  std::size_t num_made_ = 0;
  std::deque<PosedCompound> compounds_;
  std::size_t num_compounds_ = 0;
  std::array<PosedCompound*, 2> recent_{};  ///< those of the pair at hand
  const TrianglesAround* around_ = nullptr;
  Pose around_pose_;
  double around_margin_ = 0;
  std::deque<UnionPiece> known_;  ///< the triangles around the pair at hand
  std::vector<bool> known_made_;
  TriangleBoxes known_boxes_;
  SharedEdges known_edges_;
  int known_searches_ = 0;  ///< among these, of the pair at hand
  std::uint64_t stamp_ = 0;
  std::uint64_t visits_ = 0;
};

}  // namespace pd::detail
