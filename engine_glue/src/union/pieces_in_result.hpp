/// @file
/// Pieces of unions in place of their bodies in Bullet's result, as Bullet's own algorithms put them there for the
/// host's callbacks.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include "pair/manifold_points.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/met_triangle.hpp"

namespace pd::detail {

/// Puts a wrapper with its numbers in place of its body's in the result, and back.
class PieceInResult {
 public:
  PieceInResult(btManifoldResult& result, const btCollisionObjectWrapper& piece)
      : PieceInResult(result, piece, piece.m_index) {}
  /// @param told_as  the piece's number for hosts
  PieceInResult(btManifoldResult& result, const btCollisionObjectWrapper& piece, int told_as)
      : result_(result),
        first_(result.getBody0Internal() == piece.getCollisionObject()),
        before_(first_ ? result.getBody0Wrap() : result.getBody1Wrap()) {
    put(piece);
    if (first_) {
      result.setShapeIdentifiersA(piece.m_partId, told_as);
    } else {
      result.setShapeIdentifiersB(piece.m_partId, told_as);
    }
  }
  ~PieceInResult() { put(*before_); }
  PieceInResult(const PieceInResult&) = delete;
  PieceInResult& operator=(const PieceInResult&) = delete;

 private:
  void put(const btCollisionObjectWrapper& wrapper) {
    if (first_) {
      result_.setBody0Wrap(&wrapper);
    } else {
      result_.setBody1Wrap(&wrapper);
    }
  }

  btManifoldResult& result_;
  bool first_;
  const btCollisionObjectWrapper* before_;
};

/// The numbers that a child, or the convex body itself, has in the result.
inline int part_of_child(const btCollisionObjectWrapper& body, const Child& child) {
  return child.index < 0 ? body.m_partId : -1;
}
inline int index_of_child(const btCollisionObjectWrapper& body, const Child& child) {
  return child.index < 0 ? body.m_index : child.told_as;
}

/// A child of a compound, or the convex body itself.
class ChildInResult {
 public:
  ChildInResult(btManifoldResult& result, const btCollisionObjectWrapper& body, const Child& child)
      : wrapper_(child.index < 0 ? body.m_parent : &body, child.shape, body.getCollisionObject(), child.pose,
                 part_of_child(body, child), child.index < 0 ? body.m_index : child.index),
        placed_(result, wrapper_, index_of_child(body, child)) {}
  [[nodiscard]] const btCollisionObjectWrapper& wrapper() const { return wrapper_; }

 private:
  btCollisionObjectWrapper wrapper_;
  PieceInResult placed_;
};

/// Two children in place of their bodies in the result.
class ChildrenInResult {
 public:
  ChildrenInResult(btManifoldResult& result, const btCollisionObjectWrapper& a, const Child& child_a,
                   const btCollisionObjectWrapper& b, const Child& child_b)
      : a_(result, a, child_a), b_(result, b, child_b) {}
  [[nodiscard]] const btCollisionObjectWrapper& a() const { return a_.wrapper(); }
  [[nodiscard]] const btCollisionObjectWrapper& b() const { return b_.wrapper(); }

 private:
  ChildInResult a_;
  ChildInResult b_;
};

/// A triangle of a mesh in place of it in the result.
class TriangleInResult {
 public:
  TriangleInResult(btManifoldResult& result, const btCollisionObjectWrapper& mesh, const MetTriangle& triangle)
      : shape_(triangle.corners[0], triangle.corners[1], triangle.corners[2]),
        wrapper_(&mesh, &shape_, mesh.getCollisionObject(), mesh.getWorldTransform(), triangle.part, triangle.index),
        placed_(result, wrapper_) {
    shape_.setMargin(mesh.getCollisionShape()->getMargin());
  }
  [[nodiscard]] const btTriangleShape& shape() const { return shape_; }
  [[nodiscard]] const btCollisionObjectWrapper& wrapper() const { return wrapper_; }

 private:
  btTriangleShape shape_;
  btCollisionObjectWrapper wrapper_;
  PieceInResult placed_;
};

}  // namespace pd::detail
