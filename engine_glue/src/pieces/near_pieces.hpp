/// @file
/// The pieces of a union that come near a contact of one of them.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "pd/union_contact/piece_surroundings.hpp"
#include "pieces/compound_facts.hpp"
#include "pieces/piece_wrapper.hpp"
#include "shapes/triangles_around.hpp"

class btConvexShape;

namespace pd::detail {

struct PieceInFrame {
  const btCollisionObjectWrapper& wrapper;
  const UnionFrame& frame;
};

/// Finds the pieces of a union near one of them.
class NearPieces {
 public:
  /// To be called for each pair in each step.
  /// @param stamp  of this step, 0: unknown, so that what is known of compounds is compared again
  void begin_pair(std::uint64_t stamp);
  /// The triangles of a mesh that were read for the pair at hand: those near are taken from them where they are enough.
  void know(const TrianglesAround& around, const btCollisionObjectWrapper& mesh);

  /// Where the union of a piece is looked at. Valid until the next pair.
  /// @param kept  set to the piece in its frame where it is a child that is kept there, else to nullptr
  [[nodiscard]] const UnionFrame& frame_of(const btCollisionObjectWrapper& piece, BulletShapeCache& cache,
                                           const UnionPiece*& kept);

  /// The other pieces of the union that come within reach of a point of this one, and within the slack of the piece
  /// itself, which is not looked at closely; all in the piece's frame. Compounds in compounds and meshes in compounds
  /// included; curved parts are left out, since contacts inside of them do not arise from seams.
  /// @param beyond  null, or: pieces whose surface does not come beyond it are left out
  /// @param found  valid until `forget_made` or the next pair
  void find(const PieceInFrame& piece, const NearPoint& near, const Beyond* beyond, const StepShapes& shapes,
            std::vector<const UnionPiece*>& found);
  [[nodiscard]] CompoundFacts& facts() { return facts_; }

  /// Makes room: what was found may go.
  void forget_made() { num_made_ = 0; }

  /// A triangle that is known, as a piece; nullptr: the piece is none.
  [[nodiscard]] const UnionPiece* known_triangle_of(const btCollisionObjectWrapper& piece);

 private:
  struct Search;
  /// That of a body of the pair at hand.
  struct BodyFrame {
    const btCollisionObject* body = nullptr;
    UnionFrame frame;
  };

  /// Those of the triangles that are known. Requires: they cover what is searched.
  void collect_known(const btCollisionObjectWrapper& except, Search& search, const btVector3& lower,
                     const btVector3& upper);
  /// The piece of one of them, which is made when it is first asked for.
  UnionPiece& known_triangle(std::size_t i);
  /// @param except  a piece of this shape, or null
  void collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
               Search& search);
  void collect_children(const btCompoundShape& compound, const btTransform& pose, int except, Search& search);
  /// The children of a whole body's compound, in its frame.
  void collect_in_frame(const ChildOf& except, const NearPoint& near, Search& search);
  /// Whether a box comes within reach.
  static bool within(const btVector3& lower, const btVector3& upper, const Search& search);
  /// Not taken before `num_made_` grows.
  UnionPiece& next_made();

  CompoundFacts facts_;
  std::vector<int> near_;        ///< numbers of children
  std::deque<UnionPiece> made_;  ///< for pieces that are no children of a whole body
  std::size_t num_made_ = 0;
  std::array<BodyFrame, 2> frames_;
  UnionFrame world_;
  const TrianglesAround* around_ = nullptr;
  Pose around_pose_;
  double around_margin_ = 0;
  std::deque<UnionPiece> known_;  ///< the triangles around the pair at hand
  std::vector<bool> known_made_;
};

/// One piece by its wrapper.
class PieceOfBody final : public PieceSurroundings {
 public:
  PieceOfBody(const btCollisionObjectWrapper& wrapper, const StepShapes& shapes, NearPieces& near)
      : wrapper_(wrapper), shapes_(shapes), near_(near) {}

  const UnionFrame& frame() override {
    frame_ = &near_.frame_of(wrapper_, shapes_.cache, kept_);
    return *frame_;
  }
  const UnionPiece* own() override { return kept_ != nullptr ? kept_ : near_.known_triangle_of(wrapper_); }
  void find(const NearPoint& near, const Beyond* beyond, std::vector<const UnionPiece*>& found) override {
    near_.forget_made();
    near_.find({wrapper_, *frame_}, near, beyond, shapes_, found);
  }
  bool may_hold(const NearPoint& near) override {
    return frame_->is_world || near_.facts().may_hold(child(), near, shapes_.cache);
  }
  FacetCover cover_of(std::size_t facet, double slack) override {
    return frame_->is_world ? FacetCover::some : near_.facts().cover_of(child(), facet, slack, shapes_.cache);
  }

 private:
  /// Requires: the frame is a compound's.
  [[nodiscard]] ChildOf child() const {
    return {static_cast<const btCompoundShape&>(*wrapper_.m_parent->getCollisionShape()), wrapper_.m_index};
  }

  const btCollisionObjectWrapper& wrapper_;
  StepShapes shapes_;
  NearPieces& near_;
  const UnionPiece* kept_ = nullptr;
  const UnionFrame* frame_ = nullptr;
};

}  // namespace pd::detail
