/// @file
/// Every type of shape that Bullet has, as a body that is let go and as a ground, for worlds in which each body meets
/// each ground.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine_glue/bullet_world.hpp"

namespace pd::test {

/// A body that rests on a flat face, at its own origin.
struct MatrixBody {
  std::string name;
  btCollisionShape* shape;
  btTransform pose = btTransform::getIdentity();  ///< its turn; the height is found from its bounding box
};

/// A ground whose upper face is the plane y = 0, some 30 m wide.
struct MatrixGround {
  std::string name;
  btCollisionShape* shape;
  btVector3 origin = btVector3(0, 0, 0);
};

/// Shapes with what they point to.
class ShapeMatrix {
 public:
  ShapeMatrix();
  ~ShapeMatrix();
  ShapeMatrix(const ShapeMatrix&) = delete;
  ShapeMatrix& operator=(const ShapeMatrix&) = delete;

  [[nodiscard]] const std::vector<MatrixBody>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<MatrixGround>& grounds() const { return grounds_; }

 private:
  template <class Shape, class... Arguments>
  Shape* make(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* raw = made.get();
    shapes_.push_back(std::move(made));
    return raw;
  }
  template <class... Children>
  btCompoundShape* compound_of(const Children&... children);
  btTriangleMesh& mesh_of_floor(double half_width, int cells);
  btTriangleMesh& mesh_of_cube(double half);
  void make_convex_bodies();
  void make_compound_bodies();
  void make_grounds();

  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<btScalar> heights_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<MatrixBody> bodies_;
  std::vector<MatrixGround> grounds_;
};

}  // namespace pd::test
