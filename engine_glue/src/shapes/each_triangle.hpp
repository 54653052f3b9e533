/// @file
/// The triangles of a concave shape that a box meets, handed to a function.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

namespace pd::detail {

/// Calls `visit(corners, part, index)` with three corners and Bullet's numbers of each triangle that the shape's tree
/// finds in a box. Trees of quantised boxes, and heightfields, offer more than what the box meets.
template <class Visit>
void for_each_triangle(const btConcaveShape& shape, const btVector3& lower, const btVector3& upper,
                       const Visit& visit) {
  struct Triangles : public btTriangleCallback {
    explicit Triangles(const Visit& function) : each(function) {}
    void processTriangle(btVector3* corners, int part, int index) override { each(corners, part, index); }
    const Visit& each;
  } triangles(visit);
  shape.processAllTriangles(&triangles, lower, upper);
}

}  // namespace pd::detail
