/// @file
/// Answers the questions of the core's `FlatGround` for a child of one of Bullet's bodies.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <memory>
#include <span>

#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/union_contact/flat_ground.hpp"
#include "shapes/met_triangle.hpp"
#include "union/sheet_sides.hpp"
#include "union/union_algorithm.hpp"

namespace pd::detail {

/// A child of a body, over triangles that may be flat ground. Lives for one question; its references must outlive it.
class ChildOnGround final : public StandingBody {
 public:
  struct Asked {
    const UnionQuestion& question;
    const btCollisionObjectWrapper& wrapper;  ///< of the child
    int child;                                ///< its number
    std::span<const MetTriangle> triangles;
    SheetSides* sides;  ///< null: the mesh has fronts of its own
  };
  ChildOnGround(const Asked& asked, std::shared_ptr<CachedShape>& known) : asked_(asked), known_(known) {}

  bool stand_on(const Halfspace3& ground, HalfspaceContact& contact) override {
    const GroundQuestion asked{.body = static_cast<const btConvexShape&>(*asked_.wrapper.getCollisionShape()),
                               .pose = asked_.wrapper.getWorldTransform(),
                               .ground = ground,
                               .stamp = asked_.question.stamp,
                               .shape = known_,
                               .threshold = static_cast<double>(asked_.question.threshold),
                               .sharp_box = is_part(asked_.wrapper)};
    return asked_.question.core.stand_on(asked, asked_.question.buffers, contact) == SolverCore::Outcome::answered;
  }
  [[nodiscard]] PosedShape posed() const override {
    const bool sharp = is_part(asked_.wrapper) && known_->sharp;
    return {(sharp ? known_->sharp : known_->body).get(), to_pd(asked_.wrapper.getWorldTransform())};
  }
  void drop_covered(ContactManifold& points) override {
    if (!is_piece(asked_.wrapper)) return;
    const PosedShape body = posed();
    AskedPieces pieces = asked_.question.of_pieces(asked_.wrapper, asked_.question.b);
    count_covered(pd::drop_covered(pieces.as(body, body), points), asked_.question.buffers);
  }
  [[nodiscard]] bool remembers_sides() const override { return asked_.sides != nullptr; }
  [[nodiscard]] Vec3 side_of(std::size_t triangle, const Vec3& normal) const override {
    return asked_.sides->front_of(number_of_pieces(asked_.child, asked_.triangles[triangle]), normal);
  }
  [[nodiscard]] Vec3 middle_before() const override { return asked_.sides->middle_before(); }
  void keep_side(std::size_t triangle, const Vec3& side) override {
    const MetTriangle& met = asked_.triangles[triangle];
    asked_.sides->keep(number_of_pieces(asked_.child, met), side, to_pd(met.corners[0]));
  }

 private:
  Asked asked_;
  std::shared_ptr<CachedShape>& known_;
};

}  // namespace pd::detail
